from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest
from definitions import metrics, stored_definition

from dse.domain.definition import DefinedAllocation, DefinedConfiguration, DefinedLoad
from dse.report import read_content, read_insight
from dse.report.content.data import ReportContent, label
from dse.report.page.payload import payload_of
from dse.report.verdicts import Mark, marks_of, overall_marks
from dse.storage import StudyFolder


def test_what_no_study_has_is_all_named_at_once(sliced: ReportContent) -> None:
    narrow = dataclasses.replace(sliced.variables[0], high=sliced.variables[0].low)
    boundless = dataclasses.replace(sliced.requirements[0], at_most=None, at_least=None)
    odd = {"variables": (narrow, *sliced.variables[1:]), "requirements": (boundless,), "slices": (("v",),)}
    with pytest.raises(ValueError, match="has an empty range") as caught:
        dataclasses.replace(sliced, **odd)
    assert "'R1' has no bound" in str(caught.value)
    assert "a slice names 'v', which is not a variable" in str(caught.value)


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


def test_an_allocation_is_stored_with_the_study_and_shown_by_the_page(tmp_path: Path) -> None:
    load = DefinedLoad("compute", "capacity", "TOPS", {"brake": 2.0, "acc": 1.0}, {"ecu_1": 4.0, "ecu_2": 8.0})
    on = {"brake": ("ecu_1", "ecu_2"), "acc": ("ecu_2",)}
    allocation = DefinedAllocation("placement", ("ecu_1", "ecu_2"), ("brake", "acc"), on, (load,))
    configurations = [DefinedConfiguration("c1", allocations=(allocation,)), DefinedConfiguration("c2")]
    with StudyFolder.create(tmp_path / "study", stored_definition(configurations, metrics=metrics("end"))):
        pass
    document = json.loads(payload_of(read_content(tmp_path / "study")).document)
    first, second = (entry["allocations"] for entry in document["configurations"])
    assert second == []
    assert first == [
        {
            "place": "placement",
            "hosts": ["ecu_1", "ecu_2"],
            "functions": ["brake", "acc"],
            "on": {"brake": ["ecu_1", "ecu_2"], "acc": ["ecu_2"]},
            "loads": [
                {
                    "load": "compute",
                    "capacity": "capacity",
                    "unit": "TOPS",
                    "loads": {"brake": 2.0, "acc": 1.0},
                    "capacities": {"ecu_1": 4.0, "ecu_2": 8.0},
                }
            ],
        }
    ]


def test_a_study_without_variables_can_be_read(tmp_path: Path) -> None:
    definition = stored_definition([DefinedConfiguration("c1"), DefinedConfiguration("c2")], metrics=metrics("end"))
    with StudyFolder.create(tmp_path / "study", definition):
        pass
    content = read_content(tmp_path / "study")
    assert content.variables == ()
    assert len(content.configurations) == 2
    assert read_insight(tmp_path / "study").asked.sentences[-1] == (
        "Each configuration was run once, at its nominal parameters."
    )
