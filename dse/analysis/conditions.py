"""Worst cases: how requirements fare at each value of one factor, and which designs pass at every one."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from dse.analysis.data import ALL, MET, StudyData, withheld
from dse.analysis.probability import Met, probability_met
from dse.domain.bench import VERDICTS, Verdict

MOST_LEVELS = 40


@dataclass(frozen=True, slots=True)
class Condition:
    """A value of a factor by its *place*; *met* is None if no run there met or failed the requirement."""

    place: float
    met: Met | None


@dataclass(frozen=True, slots=True)
class WorstCase:
    """What comes of a requirement over all conditions of *factor*.

    *complete* designs, all else being equal, have a run under each condition; *passing* of them meet it under every
    one, and *best* is the run of such a one whose least margin is largest: -1 without one, or where margins of several
    requirements cannot be compared. *incomplete* designs lack a condition, and are counted neither way.
    """

    factor: str
    conditions: tuple[Condition, ...]
    complete: int
    passing: int
    incomplete: int
    best: int

    @property
    def worst(self) -> Condition:
        """The condition with the smallest share of runs that meet the requirement."""
        return min(
            (each for each in self.conditions if each.met), key=lambda each: each.met.share.value if each.met else 1
        )


def worst_case(data: StudyData, over: str, requirement: str = ALL) -> WorstCase:
    """Over the values that the factor *over* has in the runs; runs without it are left out.

    DseError if there is no such factor or requirement, if it has more than 40 values, or none at which a run met or
    failed the requirement.
    """
    k = data.factor(over)
    there = data.part(~np.isnan(data.places[:, k]))
    places, which = np.unique(there.places[:, k], return_inverse=True)
    which = which.reshape(-1)
    if len(places) > MOST_LEVELS:
        raise withheld(over, f"it has {len(places)} values, one for hardly more than a run: these are no conditions")
    judged = there.codes(requirement)
    conditions = tuple(
        Condition(float(place), _met(there.part(which == number), requirement)) for number, place in enumerate(places)
    )
    if not any(condition.met for condition in conditions):
        raise withheld(requirement, "no run says whether it is met")
    margins = there.margins.get(requirement, np.full(len(there), np.nan))
    designs: dict[tuple[float, ...], dict[int, int]] = {}
    others = np.nan_to_num(np.delete(there.places, k, axis=1), nan=-1.0)
    for row, (point, condition) in enumerate(zip(map(tuple, others.tolist()), which.tolist(), strict=True)):
        designs.setdefault(point, {})[condition] = row
    complete = [list(rows.values()) for rows in designs.values() if len(rows) == len(places)]
    passing = [rows for rows in complete if (judged[rows] == MET).all()]
    worst = [float(margins[rows].min()) for rows in passing]
    best = -1
    if worst and not np.isnan(worst).all():
        rows = passing[int(np.nanargmax(worst))]
        best = int(there.numbers[rows[int(np.argmin(margins[rows]))]])
    return WorstCase(over, conditions, len(complete), len(passing), len(designs) - len(complete), best)


def _met(data: StudyData, requirement: str) -> Met | None:
    judged = np.isin(data.codes(requirement), [MET, VERDICTS.index(Verdict.FAIL)])
    return probability_met(data, requirement) if judged.any() else None
