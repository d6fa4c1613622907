"""Every metric function there is, put through the suite that other packages run over theirs."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dse.errors import DseError
from dse.metrics.catalogue import OFFERED, Argument, Wants, metric_function, same
from dse.testing.metrics import MetricSuite

for _name in OFFERED.names():
    _members = {"name": _name, "function": OFFERED.get(_name)}
    globals()[f"TestFunction_{_name}"] = type(f"TestFunction_{_name}", (MetricSuite,), _members)

X = Argument("x", Wants.WAVEFORM, any_unit=True)
LIMIT = Argument("limit", Wants.CONSTANT, "m", 2.0)


def peak_to_peak(x):
    return float(np.max(x) - np.min(x))


def first_time_above(time, x, limit):
    above = np.flatnonzero(x > limit)
    return float(time[above[0]]) if len(above) else math.nan


def sorted_in_place(x):
    x.sort()
    return float(x[0])


def number_of_rows(x):
    return float(len(x))


def inverse_of_span(time, x):
    return 1.0 / (float(time[-1]) - float(time[0]))


def share_above(x, share):
    return float(np.mean(x > share * np.max(x)))


def quantile(x, share):
    return float(np.quantile(x, share))


def weakest_of(gap, least):
    return float(np.min(gap) - least)


class TestAFirstArgumentWithAUnitThatOthersShare(MetricSuite):
    name = "weakest_of"
    function = metric_function(
        weakest_of, [Argument("gap", Wants.WAVEFORM, "s"), Argument("least", Wants.CONSTANT)], same
    )


class TestPeakToPeak(MetricSuite):
    name, function = "peak_to_peak", metric_function(peak_to_peak, [X], same)


class TestFirstTimeAbove(MetricSuite):
    name = "first_time_above"
    function = metric_function(first_time_above, [Argument("x", Wants.WAVEFORM, "m"), LIMIT], "s")
    shifts_with_time = True


def turned(x):
    """A complex number, of which a metric would keep the real part."""
    return np.complex128(complex(float(x[0]), 1.0))


def suite_of(function, name):
    suite = MetricSuite()
    suite.name, suite.function = name, metric_function(function, [X], same)
    return suite


@pytest.mark.parametrize(
    ("function", "test", "error"),
    [
        (sorted_in_place, lambda suite: suite.test_it_gives_a_number(), DseError),
        (turned, lambda suite: suite.test_it_gives_a_number(), (DseError, np.exceptions.ComplexWarning)),
        (number_of_rows, lambda suite: suite.test_what_is_undefined_stays_undefined(), AssertionError),
        (inverse_of_span, lambda suite: suite.test_a_few_rows_are_enough(1), DseError),
    ],
)
def test_the_suite_finds_the_mistakes_one_makes(function, test, error):
    with pytest.raises(error):
        test(suite_of(function, function.__name__))


@pytest.mark.parametrize(("function", "result"), [(share_above, ""), (quantile, same)])
def test_a_plain_number_that_is_declared_without_its_unit_is_found(function, result):
    """Without one, it would be a share in metres of a waveform in metres, and refuse ``quantile(a.x, 0.9)``."""
    suite = MetricSuite()
    suite.name = function.__name__
    suite.function = metric_function(function, [X, Argument("share", Wants.CONSTANT)], result)
    with pytest.raises((AssertionError, DseError)):
        suite.test_it_does_not_matter_in_which_unit_the_first_argument_is()
    suite.function = metric_function(function, [X, Argument("share", Wants.CONSTANT, "")], result)
    suite.test_it_does_not_matter_in_which_unit_the_first_argument_is()


def test_a_function_that_needs_the_clock_must_say_so():
    suite = TestFirstTimeAbove()
    suite.function = metric_function(first_time_above, [Argument("x", Wants.WAVEFORM, "m"), LIMIT], "s")
    suite.shifts_with_time = False
    with pytest.raises(AssertionError):
        suite.test_it_does_not_matter_when_the_run_began()


@pytest.mark.parametrize(
    ("function", "arguments", "words"),
    [
        (lambda x: x, [X], "not a function of a module"),
        (peak_to_peak, [X, LIMIT], "takes 1 arguments, 2 are declared"),
        (peak_to_peak, [], "takes 1 arguments, 0 are declared"),
        (first_time_above, [LIMIT, X], "those with a default last"),
    ],
)
def test_a_declaration_that_does_not_fit_is_refused(function, arguments, words):
    with pytest.raises(ValueError, match=words):
        metric_function(function, arguments, same)
