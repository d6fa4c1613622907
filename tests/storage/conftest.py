"""A small study to store: two configurations, one variable, two metrics, two requirements."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

import pytest
from definitions import at_most_one, metrics, stored_definition

from dse.domain.bench import Judgement, Verdict
from dse.domain.component import Value
from dse.domain.definition import (
    DefinedBench,
    DefinedConfiguration,
    DefinedDesign,
    DefinedTotal,
    DefinedVariable,
    StudyDefinition,
)
from dse.domain.run import Outcome, Run, RunRequest
from dse.storage.folder import StudyFolder
from dse.storage.rows import Measures, block_of

METRICS = ("overshoot", "rise_time")
REQUIREMENTS = ("R1", "R2")


@pytest.fixture
def definition() -> StudyDefinition:
    return stored_definition(
        (
            DefinedConfiguration("c1", {"sensor": "radar"}, totals={"cost": DefinedTotal(45.0, "EUR")}),
            DefinedConfiguration("c2", {"sensor": "lidar <ä>"}),
        ),
        study="gains",
        title="Gains",
        bench=DefinedBench("following"),
        design=DefinedDesign("vehicle", "", ("sensor",)),
        variables=(DefinedVariable("controller.kp", "", "1/s", 0.0, 1.0, 3, 0.5),),
        metrics=metrics(*METRICS),
        requirements=at_most_one(METRICS[0], *REQUIREMENTS),
        fmus={"pd_acc": "0123"},
    )


def ask_for_six(folder: StudyFolder) -> StudyFolder:
    """*folder* with three runs of each configuration asked for."""
    points = [(name, kp) for name in ("c1", "c2") for kp in (0.1, 0.2, 0.3)]
    requests = [RunRequest(number, name, {"controller.kp": kp}) for number, (name, kp) in enumerate(points)]
    folder.ask(0, requests, 6)
    return folder


@pytest.fixture
def asked() -> Callable[[StudyFolder], StudyFolder]:
    return ask_for_six


def done(number: int, configuration: str, kp: Value, overshoot: float, rise_time: float, margin: float) -> Run:
    verdict = Verdict.PASS if margin >= 0 else Verdict.FAIL
    judgements = (Judgement("R1", verdict, margin), Judgement("R2", Verdict.NOT_EXERCISED, math.nan))
    metrics = {"overshoot": overshoot, "rise_time": rise_time}
    return Run(RunRequest(number, configuration, {"controller.kp": kp}), Outcome.DONE, metrics, judgements)


@pytest.fixture
def runs() -> list[Run]:
    return [
        done(0, "c1", 0.1, 0.1 + 0.2, math.nan, 0.25),
        done(1, "c1", 0.2, -5e-324, math.inf, -1.5),
        Run(RunRequest(2, "c1", {"controller.kp": 0.3}), Outcome.FAILED, problem='world: "t" < 3 s\x00 & more'),
        done(4, "c2", 0.2, 1.0, -math.inf, 0.0),
    ]


@pytest.fixture
def add() -> Callable[[StudyFolder, Run], None]:
    def add(folder: StudyFolder, run: Run) -> None:
        point = tuple(run.request.point.values())
        folder.add(run.request.configuration, [point], block_of((run,), Measures(METRICS, REQUIREMENTS), (0.5,)))

    return add


@pytest.fixture
def stored(
    tmp_path: Path, definition: StudyDefinition, runs: list[Run], add: Callable[[StudyFolder, Run], None]
) -> Path:
    """A folder with the runs, added in another order than that of their numbers."""
    with StudyFolder.create(tmp_path / "study", definition) as folder:
        ask_for_six(folder)
        for run in reversed(runs):
            add(folder, run)
    return tmp_path / "study"
