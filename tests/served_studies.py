"""Small stored studies, for what looks at several."""

from __future__ import annotations

import math
from pathlib import Path

from definitions import at_most_one, metrics, stored_definition

from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import DefinedBench, DefinedConfiguration, DefinedDesign, DefinedVariable
from dse.domain.run import Outcome, Run, RunRequest
from dse.storage import StudyFolder, block_of

TITLE = 'Gains <script>alert("1")</script>'


def run_of(number: int, kp: float, overshoot: float) -> Run:
    """A run whose overshoot must be at most 1; NaN is one that did not come to its end."""
    request = RunRequest(number, "c1", {"controller.kp": kp})
    if math.isnan(overshoot):
        return Run(request, Outcome.FAILED, problem="world: crashed")
    verdict = Verdict.PASS if overshoot <= 1 else Verdict.FAIL
    return Run(request, Outcome.DONE, {"overshoot": overshoot}, (Judgement("R1", verdict, 1 - overshoot),))


def store_study(path: Path, overshoots: list[float], title: str = TITLE) -> Path:
    """A study with runs of these overshoots, at kp = 0.1, 0.2, …; one more was asked for."""
    definition = stored_definition(
        (DefinedConfiguration("c1", {"sensor": "radar"}, constants={"controller.kp": 0.5}),),
        study="gains",
        title=title,
        bench=DefinedBench("following"),
        design=DefinedDesign("vehicle", "", ("sensor",)),
        variables=(DefinedVariable("controller.kp", "gain", "1/s", 0.0, 1.0, 0, 0.5),),
        metrics=metrics("overshoot"),
        requirements=at_most_one("overshoot", "R1"),
    )
    with StudyFolder.create(path, definition) as folder:
        points = [round(0.1 * (number + 1), 1) for number in range(len(overshoots) + 1)]
        folder.ask(0, [RunRequest(n, "c1", {"controller.kp": kp}) for n, kp in enumerate(points)], len(points))
        for number, overshoot in enumerate(overshoots):
            add_run(folder, number, overshoot)
    return path


def add_run(folder: StudyFolder, number: int, overshoot: float) -> None:
    kp = round(0.1 * (number + 1), 1)
    folder.add("c1", [(kp,)], block_of((run_of(number, kp, overshoot),), folder.header.measures, (0.1,)))
