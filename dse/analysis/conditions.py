"""Designs at the worst of their conditions: the rows that every finding on designs is computed from.

The points of a study are designs at conditions. A designer chooses the design, the environment the condition, so the
verdict on a design is the worst of the verdicts on its runs.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from dse.analysis.data import ALL, MET, Rows, StudyData, withheld
from dse.analysis.measure import modelled_share
from dse.analysis.memoize import memoized
from dse.analysis.probability import LEAST_EVEN, Basis, Met, met_by_runs, probability_met
from dse.analysis.slack import FAILING, slack
from dse.analysis.study_reader import weighted
from dse.errors import DseError
from dse.exploration import equal_rows
from dse.metrics import worst_codes

MOST_LEVELS = 40


@dataclass(frozen=True, slots=True)
class Condition:
    """A value of a factor by its *place*; *met* is None if no run there met or failed the requirement."""

    place: float
    met: Met | None


@dataclass(frozen=True, slots=True)
class WorstCase:
    """What comes of a requirement over all conditions of *factor*.

    *complete* designs were run at all conditions; *passing* of them meet it, and *best* is the run of such a one whose
    least margin is largest: -1 without one, or where margins of several requirements cannot be compared. *incomplete*
    designs lack a condition, and are counted neither way.
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


@memoized
def worst_designs(data: StudyData) -> StudyData:
    """The designs of *data* as its rows, each with the worst of its verdicts and margins and the number of the run that
    decides; without metrics. *data* itself where no condition differs.

    A design that was not run at all conditions is left out, unless it failed at one. DseError if none was run at all.
    """
    at = np.array([factor.is_condition for factor in data.factors], dtype=np.bool_)
    if not at.any() or not len(data):
        return data
    designs, whole = _designs(data, at)
    if not whole.any():
        count = len(equal_rows(data.places[:, at]))
        raise withheld(ALL, f"no design was run at all {count} conditions", "a study with another sampler runs it so")
    failing = np.any([codes == FAILING for codes in designs.verdicts.values()], axis=0) if designs.verdicts else ~whole
    known = whole | failing | ~designs.done
    return weighted(replace(designs.part(known), incomplete=int((~known).sum())), data.on_grid)


def share_met(data: StudyData, requirement: str = ALL) -> Met:
    """How often designs meet *requirement* at the worst of their conditions: by the runs if these were drawn evenly,
    else by a model of the verdicts, with which those that were have to agree.

    DseError as `probability_met` and `modelled_share` have it, or if these two do not agree.
    """
    if data.even.all():
        return probability_met(worst_designs(data), requirement)
    met, known = met_by_runs(data, requirement), None
    with suppress(DseError):
        known = met_by_runs(worst_designs(data.evenly(requirement, 1)), requirement)
        known = replace(known, basis=Basis.EVEN_RUNS)
    try:
        share, conditions = modelled_share(data, requirement)
    except DseError:
        if known is None or known.judged < LEAST_EVEN:
            raise
        return known
    if known and (share.low > known.share.high or known.share.low > share.high):
        if known.judged >= LEAST_EVEN:
            return known
        what = f"a model of the verdicts gives {share.value:.0%} of the space, {known.judged} evenly drawn {data.rows}"
        raise withheld(requirement, f"{what} give {known.share.value:.0%}", "next: a study with 'sobol'")
    return replace(met, share=share, conditions=conditions, basis=Basis.MODEL)


def worst_case(data: StudyData, over: str, requirement: str = ALL) -> WorstCase:
    """Over the values that the factor *over* has in the runs; runs without it are left out.

    DseError if there is no such factor or requirement, if it has more than 40 values, or none at which a run met or
    failed the requirement; or if runs were not drawn evenly.
    """
    data = data.evenly(requirement, LEAST_EVEN)
    k = data.factor(over)
    there = data.part(~np.isnan(data.places[:, k]))
    places, which = np.unique(there.places[:, k], return_inverse=True)
    which = which.reshape(-1)
    if len(places) > MOST_LEVELS:
        raise withheld(over, f"it has {len(places)} values, one for hardly more than a run: these are no conditions")
    conditions = tuple(
        Condition(float(place), _met(there.part(which == number), requirement)) for number, place in enumerate(places)
    )
    if not any(condition.met for condition in conditions):
        raise withheld(requirement, "no run shows whether it is met")
    at = np.array([n == k or factor.is_condition for n, factor in enumerate(data.factors)], dtype=np.bool_)
    designs, whole = _designs(there, at)
    passing = np.flatnonzero(whole & designs.met(requirement))
    margins = designs.margins.get(requirement, np.full(len(designs), np.nan))[passing]
    best = -1 if np.isnan(margins).all() else int(designs.numbers[passing[int(np.nanargmax(margins))]])
    return WorstCase(over, conditions, int(whole.sum()), len(passing), int((~whole).sum()), best)


def _designs(data: StudyData, at: Rows) -> tuple[StudyData, Rows]:
    """A row for each design, runs of which differ in the factors *at* only; and which were run at all conditions."""
    _, codes = np.unique(data.configurations, return_inverse=True)
    designs = equal_rows(np.column_stack([codes.reshape(-1), np.nan_to_num(data.places[:, ~at], nan=-1.0)]))
    conditions = np.empty(len(data), dtype=np.intp)
    groups = equal_rows(np.nan_to_num(data.places[:, at], nan=-1.0))
    for number, rows in enumerate(groups):
        conditions[rows] = number
    order, starts = np.concatenate(designs), np.cumsum([0, *map(len, designs[:-1])])
    margins = {}
    for name, found in data.verdicts.items():
        judged = np.where(np.isin(found, [MET, FAILING]), data.margins[name], np.inf)
        least = np.minimum.reduceat(judged[order], starts)
        margins[name] = np.where(np.isinf(least), np.nan, least)
    verdicts = {name: worst_codes(found, designs) for name, found in data.verdicts.items()}
    severity = np.zeros(len(data))
    if verdicts:
        severity = slack(data.definition.requirements, data.margins, data.verdicts, data.metrics)
    severity = np.where(data.done, severity, -np.inf)
    deciding = np.array([rows[int(np.argmin(severity[rows]))] for rows in designs], dtype=np.intp)
    tried = np.array([len(np.unique(conditions[rows])) for rows in designs])
    joined = replace(
        data.part(deciding),
        done=np.logical_and.reduceat(data.done[order], starts),
        verdicts=verdicts,
        margins=margins,
        metrics={},
    )
    joined = replace(
        joined,
        factors=tuple(factor for factor, is_at in zip(data.factors, at, strict=True) if not is_at),
        places=joined.places[:, ~at],
        conditions=len(groups),
    )
    return joined, np.asarray(tried == len(groups))


def _met(data: StudyData, requirement: str) -> Met | None:
    judged = np.isin(data.codes(requirement), [MET, FAILING])
    return probability_met(data, requirement) if judged.any() else None
