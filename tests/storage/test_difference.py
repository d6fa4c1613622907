from __future__ import annotations

import copy
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from dse.domain.bench import Judgement, Verdict
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.storage.database.definition import definition_from_json
from dse.storage.difference import changed_inputs, changed_results

RUN = Run(
    RunRequest(3, "c1", {"controller.kp": 1.0}),
    Outcome.DONE,
    {"overshoot": 0.5, "rise_time": math.nan},
    (Judgement("R1", Verdict.FAIL, -0.5), Judgement("R2", Verdict.NOT_EXERCISED, math.nan)),
    waveforms=Waveforms(np.array([0.0, 1.0]), {"world.gap": np.array([150.0, math.nan])}),
)
DEFINITION: dict[str, Any] = {
    "format": 2,
    "study": "gains",
    "title": "Gains",
    "bench": {"name": "following"},
    "design": {"name": "vehicle"},
    "variables": [],
    "sampler": {"kind": "full_factorial"},
    "seed": 1,
    "explored": ["c1"],
    "fmus": {"pd_acc": "01", "radar": "02"},
    "metrics": [{"name": "overshoot", "title": "", "unit": "%", "expression": "overshoot(world.gap)"}],
    "requirements": [
        {"name": "R1", "metric": "overshoot", "at_most": 0.0, "at_least": None, "exercised_when": None, "title": ""}
        | {"unit": "%"}
    ],
    "simulation": {"stop": 60.0, "step": 0.01, "record_every": 0.1},
    "configurations": [
        {
            "id": "c1",
            "components": {"controller": "pd_acc"},
            "wires": ["a.x -> b.y"],
            "constants": {"controller.kp": 1.0, "world.lead_speed": 13.0},
        }
    ],
}


def wave(gap: float) -> Waveforms:
    return Waveforms(np.array([0.0, 1.0]), {"world.gap": np.array([gap, math.nan])})


def test_a_run_is_the_same_as_itself_with_nan_and_all() -> None:
    assert changed_results(RUN, replace(RUN, waveforms=wave(150.0))) == []


@pytest.mark.parametrize(
    ("changed", "named"),
    [
        ({"metrics": {"overshoot": 0.5, "rise_time": 1.0}}, "rise_time"),
        ({"metrics": {"overshoot": 0.5}}, "rise_time"),
        ({"judgements": (Judgement("R1", Verdict.FAIL, -99.0), RUN.judgements[1])}, "margin of R1"),
        ({"judgements": (Judgement("R1", Verdict.PASS, -0.5), RUN.judgements[1])}, "R1 (fail became pass)"),
        ({"judgements": RUN.judgements[:1]}, "R2 (is gone)"),
        ({"judgements": (*RUN.judgements, Judgement("R3", Verdict.PASS, 0.0))}, "R3 (is new)"),
        ({"waveforms": wave(math.nextafter(150.0, 0.0))}, "waveform of world.gap"),
        ({"waveforms": replace(wave(150.0), time=np.array([0.0, 2.0]))}, "the times of its waveforms"),
        ({"waveforms": replace(wave(150.0), values={})}, "waveform of world.gap"),
        ({"waveforms": None}, "its waveforms, now there are none"),
        ({"outcome": Outcome.FAILED}, "done became failed"),
    ],
)
def test_every_difference_is_named(changed: dict[str, Any], named: str) -> None:
    assert changed_results(RUN, replace(RUN, **changed)) == [named]


def test_waveforms_that_were_not_kept_are_not_compared() -> None:
    assert changed_results(replace(RUN, waveforms=None), RUN) == []


def test_two_failures_for_different_reasons_are_different() -> None:
    one, other = (Run(RUN.request, Outcome.FAILED, problem=problem) for problem in ("radar: NaN", "world: NaN"))
    assert changed_results(one, one) == []
    assert changed_results(one, other) == ["its problem, now 'world: NaN'"]


def test_a_note_of_the_exploration_is_no_difference() -> None:
    assert changed_results(replace(RUN, problem="not reproducible: simulated again it gave another result"), RUN) == []


def set_fmu(definition: dict[str, Any]) -> None:
    definition["fmus"]["pd_acc"] = "99"


def set_bound(definition: dict[str, Any]) -> None:
    definition["requirements"][0]["at_most"] = -0.99


def drop_requirement(definition: dict[str, Any]) -> None:
    definition["requirements"].clear()


def set_expression(definition: dict[str, Any]) -> None:
    definition["metrics"][0]["expression"] = "maximum(world.gap)"


def set_step(definition: dict[str, Any]) -> None:
    definition["simulation"]["step"] = 0.02


def set_constant(definition: dict[str, Any]) -> None:
    definition["configurations"][0]["constants"]["world.lead_speed"] = 14.0


def set_wires(definition: dict[str, Any]) -> None:
    definition["configurations"][0]["wires"] = []


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (set_fmu, "FMU pd_acc"),
        (set_bound, "requirement R1"),
        (drop_requirement, "requirement R1"),
        (set_expression, "metric overshoot"),
        (set_step, "simulation step"),
        (set_constant, "world.lead_speed"),
        (set_wires, "wires of the configuration"),
    ],
)
def test_every_change_of_the_study_is_named(change: Callable[[dict[str, Any]], None], named: str) -> None:
    again = copy.deepcopy(DEFINITION)
    change(again)
    assert changed_inputs(definition_from_json(DEFINITION), definition_from_json(again), RUN) == [named]


def test_titles_units_other_configurations_and_the_runs_own_point_are_no_change() -> None:
    again = copy.deepcopy(DEFINITION)
    again["metrics"][0] |= {"title": "Overshoot", "unit": "m"}
    again["configurations"][0]["constants"]["controller.kp"] = 2.0
    del again["fmus"]["radar"]
    assert changed_inputs(definition_from_json(DEFINITION), definition_from_json(again), RUN) == []
