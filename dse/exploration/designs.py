"""Runs as designs: what a designer decided, and what came of it under all conditions it was tried at.

A design is a configuration with values for its design variables. Its runs differ in conditions and in what is
uncertain.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.domain.bench import Verdict
from dse.domain.sampler import DesignVariable, Objective, Outcomes, Role
from dse.storage import groups_of

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Designs:
    """n designs of k design variables, in the order of their first runs; r requirements, m objectives.

    *points*, (n, k), and *objectives*, (n, m), are in SI; an objective is the mean over what is uncertain, at the
    condition where that is worst, NaN where a run did not come to its end or the metric is undefined. Conditions at
    which all runs came to their end and none has a value, as on a bench without the metric, are left out. *margins*,
    (n, r), are the smallest of any run that exercised the requirement, NaN where none did. *failing*, (n, r), tells
    whether a run failed the requirement; *shown*, (n, r), whether one passed it. *failed*, (n,), counts runs that
    failed to run. *rows* are the positions of each design's runs among those it was made of.
    """

    configurations: tuple[str, ...]
    points: Array
    objectives: Array
    margins: Array
    failing: NDArray[np.bool_]
    shown: NDArray[np.bool_]
    failed: NDArray[np.int64]
    rows: tuple[NDArray[np.intp], ...]

    def __len__(self) -> int:
        return len(self.configurations)

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Which came to their end in all runs, met every requirement in one at least, and failed none, (n,).

        What no run exercised is not met.
        """
        return np.asarray((self.failed == 0) & ~self.failing.any(axis=1) & self.shown.all(axis=1))


def designs_of(
    outcomes: Outcomes, variables: Sequence[DesignVariable], objectives: Sequence[Objective] = ()
) -> Designs:
    """The designs of *outcomes*, of a study over *variables*, and what they come to."""
    decided = [variable.name for variable in variables if variable.role is Role.DESIGN]
    at = [variable.name for variable in variables if variable.role is Role.CONDITION]
    points, conditions = (_columns(outcomes, names) for names in (decided, at))
    names, codes = np.unique(np.array(outcomes.configurations, dtype=np.str_), return_inverse=True)
    groups = equal_rows(np.column_stack([codes.reshape(-1).astype(np.float64), points]))
    firsts = [int(rows[0]) for rows in groups]
    passed, failing = (
        np.array([[v is verdict for v in verdicts] for verdicts in outcomes.verdicts.values()], dtype=np.bool_)
        .reshape(len(outcomes.verdicts), len(outcomes))
        .T
        for verdict in (Verdict.PASS, Verdict.FAIL)
    )
    margins = np.column_stack([*outcomes.margins.values(), np.zeros((len(outcomes), 0))])
    judged = np.where(passed | failing, margins, np.inf)
    worst = np.array([judged[rows].min(axis=0) for rows in groups]).reshape(len(groups), judged.shape[1])
    values = np.column_stack([*(_values(outcomes, each) for each in objectives), np.zeros((len(outcomes), 0))])
    signs = np.array([-1.0 if each.maximize else 1.0 for each in objectives])
    signed = signs * values
    for rows in equal_rows(conditions):
        if outcomes.done[rows].all():
            signed[rows] = np.where(np.isnan(signed[rows]).all(axis=0), -np.inf, signed[rows])
    at_worst = np.array([_worst(signed[rows], conditions[rows]) for rows in groups]).reshape(
        len(groups), len(objectives)
    )
    return Designs(
        tuple(str(names[codes.reshape(-1)[first]]) for first in firsts),
        points[firsts].reshape(len(groups), len(decided)),
        signs * np.where(np.isneginf(at_worst), np.nan, at_worst),
        np.where(np.isinf(worst), np.nan, worst),
        np.array([failing[rows].any(axis=0) for rows in groups], dtype=np.bool_).reshape(worst.shape),
        np.array([passed[rows].any(axis=0) for rows in groups], dtype=np.bool_).reshape(worst.shape),
        np.array([(~outcomes.done[rows]).sum() for rows in groups], dtype=np.int64),
        tuple(groups),
    )


def violations(designs: Designs, scale: Array) -> Array:
    """By how much each design misses the requirements, (n,): 0 where it is feasible.

    A missed margin counts in units of *scale*, (r,), the margins' usual size; a requirement that no run exercised
    counts 1, and a run that failed to run 1 + the number of requirements.
    """
    missed = np.where(designs.failing, -np.nan_to_num(np.minimum(designs.margins, 0.0)) / scale, 0.0)
    open_ = ~designs.failing & ~designs.shown
    # A missed margin of nothing is missed all the same.
    missed = np.where(designs.failing, np.maximum(missed, np.finfo(np.float64).tiny), missed)
    return np.asarray(missed.sum(axis=1) + open_.sum(axis=1) + designs.failed * (1.0 + designs.margins.shape[1]))


def front_of(objectives: Array) -> NDArray[np.bool_]:
    """Which of *objectives*, (n, m), all to be small, no other is at least as good as in all and better in one, (n,).

    A point that is not a number is on no front. Equal points are on it together.
    """
    sound = np.flatnonzero(~np.isnan(objectives).any(axis=1))
    on_front = np.zeros(len(objectives), dtype=np.bool_)
    order = sound[np.lexsort(objectives[sound].T[::-1])] if len(sound) else sound
    kept: list[int] = []
    for row in order.tolist():
        front = objectives[kept]
        dominated = (front <= objectives[row]).all(axis=1) & (front < objectives[row]).any(axis=1)
        if not dominated.any():
            kept.append(row)
    on_front[kept] = True
    return on_front


def joined(told: Sequence[Outcomes]) -> Outcomes:
    """Several outcomes of a study as one, one after the other."""
    first = told[0]
    return Outcomes(
        tuple(name for each in told for name in each.configurations),
        {name: np.concatenate([each.points[name] for each in told]) for name in first.points},
        np.concatenate([each.done for each in told]),
        {name: np.concatenate([each.metrics[name] for each in told]) for name in first.metrics},
        {name: np.concatenate([each.margins[name] for each in told]) for name in first.margins},
        {name: tuple(one for each in told for one in each.verdicts[name]) for name in first.verdicts},
        {name: np.concatenate([each.totals[name] for each in told]) for name in first.totals},
    )


def equal_rows(keys: Array) -> list[NDArray[np.intp]]:
    """Positions of the rows of *keys*, (n, k), that are equal, in the order of the first of each."""
    if not len(keys):
        return []
    group = groups_of(keys)
    order, ends = np.argsort(group, kind="stable"), np.cumsum(np.bincount(group))
    return [np.asarray(part) for part in np.split(order, ends[:-1])]


def _columns(outcomes: Outcomes, names: Sequence[str]) -> Array:
    return np.array([outcomes.points[name] for name in names]).reshape(len(names), len(outcomes)).T


def _values(outcomes: Outcomes, objective: Objective) -> Array:
    return (outcomes.totals if objective.is_total else outcomes.metrics)[objective.name]


def _worst(values: Array, conditions: Array) -> Array:
    """The largest of the means at each condition, (m,), NaN where one is not a number."""
    return np.asarray(np.max([values[rows].mean(axis=0) for rows in equal_rows(conditions)], axis=0))
