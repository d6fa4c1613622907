from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from dse.report.content import ReportContent, label
from dse.report.verdicts import Mark, marks_of, overall_marks


def test_parts_that_do_not_fit_are_all_named_at_once(sliced: ReportContent) -> None:
    short = dataclasses.replace(sliced.metrics[0], values=np.zeros(3))
    lost = dataclasses.replace(sliced.requirements[0], metric="nowhere", at_most=None)
    with pytest.raises(ValueError, match="has 3 values for 242 runs") as caught:
        dataclasses.replace(sliced, metrics=(short, *sliced.metrics[1:]), requirements=(lost,))
    assert "unknown metric 'nowhere'" in str(caught.value)
    assert "'R1' has no bound" in str(caught.value)


def test_a_waveform_of_the_wrong_length_is_refused(sliced: ReportContent) -> None:
    figure = dataclasses.replace(sliced.figures[0], current=sliced.figures[0].current[:, :-1])
    with pytest.raises(ValueError, match=r"figure 'gap': current is \(120, 600\), expected \(120, 601\)"):
        dataclasses.replace(sliced, figures=(figure,))


def test_runs_must_name_a_listed_configuration(sliced: ReportContent) -> None:
    runs = dataclasses.replace(sliced.runs, configurations=("elsewhere",) * len(sliced.runs))
    with pytest.raises(ValueError, match="not listed: elsewhere"):
        dataclasses.replace(sliced, runs=runs)


def test_a_plain_number_has_a_dash_for_its_unit() -> None:
    assert label("speed D gain", "") == "speed D gain [–]"
    assert label("gap", "m") == "gap [m]"


def test_a_run_that_was_not_exercised_never_passes(sliced: ReportContent) -> None:
    requirement = sliced.requirements[1]
    marks = marks_of(sliced, requirement)
    idle = ~requirement.exercised & sliced.runs.done
    assert idle.any()
    assert set(marks[idle].tolist()) == {Mark.NOT_EXERCISED}
    assert not np.any(overall_marks(sliced)[idle] == Mark.PASS)


def test_an_undefined_metric_fails_what_was_exercised(sliced: ReportContent) -> None:
    values = sliced.metrics[0].values.copy()
    values[5] = np.nan
    content = dataclasses.replace(
        sliced, metrics=(dataclasses.replace(sliced.metrics[0], values=values), *sliced.metrics[1:])
    )
    assert marks_of(content, content.requirements[0])[5] == Mark.FAIL


def test_a_value_exactly_at_its_bound_passes(sliced: ReportContent) -> None:
    bound = float(sliced.metrics[0].values[7])
    both = dataclasses.replace(sliced.requirements[0], at_most=bound, at_least=bound)
    assert marks_of(sliced, both)[7] == Mark.PASS


def test_a_failed_run_is_counted_as_failed_to_run(sliced: ReportContent) -> None:
    assert np.flatnonzero(overall_marks(sliced) == Mark.FAILED_TO_RUN).tolist() == [37, 150]
