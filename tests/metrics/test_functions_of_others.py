"""Metric functions of other packages: found by their entry point, checked like ours."""

from __future__ import annotations

import pickle
import subprocess
import sys

import numpy as np
import pytest
from installed_package import install

from dse.domain.bench import Metric
from dse.domain.component import Kind, Type
from dse.errors import DseError, Location
from dse.expression.parse import parse_expression
from dse.metrics.catalogue import OFFERED
from dse.metrics.program import compile_metrics
from dse.units import parse_unit

SOURCE = '''
import numpy as np
from dse.metrics.catalogue import FUNCTIONS, Argument, Wants, metric_function, same

def peak_to_peak(x, scale):
    """Largest less smallest value times *scale*, in x's unit."""
    return scale * float(np.max(x) - np.min(x))

def several(x):
    """More than one number."""
    return x

X = Argument("x", Wants.WAVEFORM, any_unit=True)
PEAK_TO_PEAK = metric_function(peak_to_peak, [X, Argument("scale", Wants.CONSTANT, "", 1.0)], same)
SEVERAL = metric_function(several, [X], same)
MAXIMUM = FUNCTIONS["minimum"]
NONSENSE = 3
'''
POINTS = {
    "peak_to_peak": "PEAK_TO_PEAK",
    "several": "SEVERAL",
    "maximum": "MAXIMUM",
    "nonsense": "NONSENSE",
    "lost": "LOST",
}
WAVE = np.array([3.0, -1.0, 2.0])


@pytest.fixture
def others(tmp_path, monkeypatch):
    """Has a package with functions installed."""
    monkeypatch.syspath_prepend(str(install(tmp_path, "other_metrics", SOURCE, {"dse.metrics": POINTS})))
    vars(OFFERED).pop("_offered", None)
    yield tmp_path
    vars(OFFERED).pop("_offered", None)


def compiled(text, unit="m"):
    types = {"a.x": Type(Kind.REAL, parse_unit("m")), "a.n": Type(Kind.REAL, parse_unit(""))}
    metric = Metric("m", parse_expression(text, Location("bench.yaml", 3, 5)), parse_unit(unit))
    return compile_metrics([metric], (), types, frozenset({"a.x"}))


def value(program):
    return program.evaluate(np.arange(3.0), {"a.x": WAVE}, dict.fromkeys(program.constants, 2.0))[0]["m"]


def test_it_is_used_like_one_of_ours(others):
    assert value(compiled("peak_to_peak(a.x)")) == 4.0
    assert value(compiled("peak_to_peak(a.x, scale = a.n) / 1 m", "")) == 8.0


@pytest.mark.parametrize(
    ("text", "unit", "words"),
    [
        ("peak_to_peak(a.x)", "s", "cannot be shown in s"),
        ("peak_to_peak(a.x, scale = 3 m)", "m", "'scale' of peak_to_peak must be"),
        ("peak_to_peak(a.n)", "m", "'x' of peak_to_peak must be a waveform; 'a.n' does not vary"),
        ("peak_to_peak(a.x, a.n, 3)", "m", "the form is peak_to_peak(x, scale = 1)"),
        ("peak_to_peek(a.x)", "m", "unknown function 'peak_to_peek'\n    hint: did you mean 'peak_to_peak'?"),
        ("maximun(a.x)", "m", "unknown function 'maximun'\n    hint: did you mean 'maximum'?"),
        ("nonsense(a.x)", "m", "the metric function 'nonsense' of other_metrics is of type int, not Function"),
        ("lost(a.x)", "m", "the metric function 'lost' of other_metrics cannot be loaded: AttributeError"),
    ],
)
def test_it_is_checked_like_one_of_ours(others, text, unit, words):
    with pytest.raises(DseError) as caught:
        compiled(text, unit)
    message = "\n".join(line for line in str(caught.value).splitlines() if "^" not in line)
    assert words in message.replace(f"\n    {text}", "")
    assert "bench.yaml:3" in message


def test_a_name_of_ours_cannot_be_taken(others):
    assert value(compiled("maximum(a.x)")) == 3.0


def test_what_gives_no_number_fails_the_run_in_words(others):
    with pytest.raises(DseError, match="a metric function did not give a number"):
        value(compiled("several(a.x)"))


def test_a_program_finds_it_again_in_another_process(others):
    program = pickle.dumps(compiled("peak_to_peak(a.x)"))
    code = (
        f"import sys, pickle, numpy as np; sys.path.insert(0, {str(others)!r})\n"
        f"program = pickle.loads({program!r})\n"
        "print(program.evaluate(np.arange(3.0), {'a.x': np.array([3.0, -1.0, 2.0])}, {})[0]['m'])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "4.0"


def test_no_package_is_looked_for_where_ours_are_enough(others):
    compiled("maximum(a.x) - mean(a.x) + abs(final(a.x))")
    assert "_offered" not in vars(OFFERED)
