"""The score board of a bench: who drove best, and how the design does with nobody at the wheel."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from pathlib import Path

from dse.api.drives.drive_study import CONTROLLER
from dse.api.studies.replay import NOBODY, drive_name, kept_drives
from dse.domain.bench import Judgement, Verdict
from dse.domain.definition import DefinedRequirement, StudyDefinition
from dse.domain.run import Outcome, Run
from dse.storage import StudyFolder

SCORING = (
    "Drives are ranked by the number of requirements met, then by the worst margin as a share of its bound. A "
    "requirement whose bound is 0 has no share, and one that was not exercised is not met. Drives that ended before "
    "the bench are not ranked."
)
"""How a board is ordered, for a person."""


@dataclass(frozen=True, slots=True)
class Score:
    """One run of a board. *place* is 0 for one that has none: *note* says why. *worst* is a share of a bound, NaN
    where nothing has one. *run* is its number in the study."""

    place: int
    drive: str
    driver: str
    configuration: str
    run: int
    met: int
    of: int
    worst: float
    worst_requirement: str
    seconds: float
    overruns: int
    steps: int
    judgements: tuple[Judgement, ...]
    note: str = ""

    @property
    def is_controller(self) -> bool:
        """Whether nobody sat at the wheel."""
        return self.drive == NOBODY


@dataclass(frozen=True, slots=True)
class Board:
    """The scores on *bench*, best first, those without a place last; all of them are runs of the study *folder*."""

    bench: str
    title: str
    folder: Path
    scores: tuple[Score, ...]

    def data(self) -> dict[str, object]:
        """The same for a program; what is undefined is null. *against* is a report's address, to see a drive over the
        run that nobody drove: ``#run=3&pins=0``."""
        controllers = {score.configuration: score.run for score in self.scores if score.is_controller}
        scores = [
            _data(score) | {"against": f"#run={score.run}&pins={controllers[score.configuration]}"}
            if score.configuration in controllers and not score.is_controller
            else _data(score)
            for score in self.scores
        ]
        return {"bench": self.bench, "title": self.title, "scoring": SCORING, "scores": scores}


def board_of(folder: Path) -> Board:
    """The board of the study in *folder*. Raises DseError if it is damaged."""
    with StudyFolder.open(folder) as store:
        definition = store.header.definition
        scores = [_score(run, definition) for run in store.table().runs()]
    ranked = sorted(scores, key=_rank)
    placed, places = [], 0
    for number, score in enumerate(ranked, 1):
        if not score.note:
            # Equal ones share a place.
            last = ranked[number - 2] if number > 1 else None
            places = places if last and _merit(last) == _merit(score) else number
            placed.append(replace(score, place=places))
        else:
            placed.append(score)
    return Board(definition.bench.name, definition.title, folder, tuple(placed))


def _merit(score: Score) -> tuple[int, float]:
    return -score.met, math.inf if math.isnan(score.worst) else -score.worst


def _rank(score: Score) -> tuple[bool, int, float, int]:
    return bool(score.note), *_merit(score), score.run


def _score(run: Run, definition: StudyDefinition) -> Score:
    name = drive_name(definition, run.request.point)
    kept = kept_drives(definition).get(name)
    stop = definition.simulation.stop
    seconds = kept.seconds if kept else stop
    bounds = {each.name: each for each in definition.requirements}
    shares = [(_share(each, bounds[each.requirement]), each.requirement) for each in run.judgements]
    known = sorted((share, requirement) for share, requirement in shares if not math.isnan(share))
    worst, requirement = known[0] if known else (math.nan, "")
    note = ""
    if run.outcome is Outcome.FAILED:
        note = f"failed: {run.problem}"
    elif seconds < stop - definition.simulation.step / 2:
        note = f"ended at {seconds:g} s of {stop:g} s"
    return Score(
        0,
        name,
        kept.driver if kept else CONTROLLER,
        run.request.configuration,
        run.request.number,
        sum(each.verdict is Verdict.PASS for each in run.judgements),
        len(run.judgements),
        worst,
        requirement,
        seconds,
        kept.overruns if kept else 0,
        kept.steps if kept else 0,
        run.judgements,
        note,
    )


def _share(judgement: Judgement, requirement: DefinedRequirement) -> float:
    """The margin as a share of the bound it is a margin to; NaN without one."""
    if judgement.verdict not in (Verdict.PASS, Verdict.FAIL):
        return math.nan
    bounds = [bound for bound in (requirement.at_most, requirement.at_least) if bound]
    # Of two bounds the margin is to the nearer one; the larger is the scale of both.
    return judgement.margin / max(map(abs, bounds)) if bounds else math.nan


def _data(score: Score) -> dict[str, object]:
    return {
        "place": score.place or None,
        "driver": score.driver,
        "drive": None if score.is_controller else score.drive,
        "is_controller": score.is_controller,
        "configuration": score.configuration,
        "run": score.run,
        "met": score.met,
        "of": score.of,
        "worst": {"share": _number(score.worst), "requirement": score.worst_requirement or None},
        "seconds": score.seconds,
        "steps": score.steps,
        "overruns": score.overruns,
        "verdicts": [
            {"requirement": each.requirement, "verdict": str(each.verdict), "margin": _number(each.margin)}
            for each in score.judgements
        ],
        "note": score.note,
    }


def _number(value: float) -> float | None:
    return value if math.isfinite(value) else None
