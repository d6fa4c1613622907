"""What CP-SAT answers about a space: a row, the best rows, a minimal conflict; all of it proven."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from dse.space.flat import NO_OWNER, FlatSpace, Rows
from dse.space.methods.optimum.optimizer import RankedRows, SumWeights, combined, sums
from dse.space.methods.solver.model import Budget, SolverModel, Tell

_BLOCK = 256


def first(flat: FlatSpace) -> Rows | None:
    """A valid row, shape (variables,), always the same; None if there is none. Raises UnprovenError, DseError."""
    return SolverModel(flat).least()


def least(flat: FlatSpace, weights: SumWeights, number: int, tell: Tell | None = None) -> Rows:
    """The *number* rows of least sum of weights[variable][value], ascending; which of equal ones is always the same.

    Shape (rows, variables). Raises UnprovenError, DseError.
    """
    return _least(SolverModel(flat), weights, number, tell)


def blocks(flat: FlatSpace) -> Iterator[Rows]:
    """Every valid row, in blocks of shape (rows, variables), in an order that is always the same.

    Each block is found from the start again, and is as long as all before it. Raises UnprovenError, DseError.
    """
    model, seen, wanted = SolverModel(flat), 0, _BLOCK
    while True:
        rows, is_complete = model.rows(wanted)
        if len(rows) > seen:
            yield rows[seen:]
        if is_complete:
            return
        seen, wanted = len(rows), 2 * wanted


def conflict(flat: FlatSpace) -> tuple[int, ...] | None:
    """Owners of rules that cannot be met together, ascending; None if there is a row.

    Minimal: without any one of them, the rules of the others can be met. Empty if the structure alone has no row.
    Raises UnprovenError, DseError.
    """
    model, budget = SolverModel(flat, switched=True), Budget()
    blamed = model.blamed(sorted({rule.owner for rule in flat.rules} - {NO_OWNER}), budget)
    if blamed is None:
        return None
    needed: list[int] = []
    suspects = blamed
    while suspects:
        *suspects, tried = suspects
        without = model.blamed([*needed, *suspects], budget)
        if without is None:
            needed.append(tried)
        else:
            suspects = [owner for owner in suspects if owner in without]
    return tuple(sorted(needed))


class SolverOptimizer:
    """Finds rows for objectives put together of *objectives*, within bounds on these, as `Optimizer` does."""

    def __init__(self, flat: FlatSpace, objectives: Sequence[SumWeights]) -> None:
        self.objectives = objectives
        self._model = SolverModel(flat)
        self._budget = Budget()

    def ends(self, objective: int) -> tuple[int, int]:
        """What an objective is surely not below, and not above."""
        values = self.objectives[objective].values()
        return sum(int(each.min()) for each in values), sum(int(each.max()) for each in values)

    def best(self, factors: Sequence[int], number: int, highs: Sequence[int | None] | None = None) -> RankedRows:
        """The *number* rows of least *factors* times the objectives, each of which is at most its *highs*."""
        model = self._model.copy()
        for weights, high in zip(self.objectives, highs or (), strict=False):
            model.add_bounds(weights, None, high)
        total = combined(self.objectives, factors)
        rows = _least(model, total, number, None, self._budget)
        return RankedRows(rows, tuple(sums(total, rows).tolist()))


def _least(
    model: SolverModel, weights: SumWeights, number: int, tell: Tell | None, budget: Budget | None = None
) -> Rows:
    budget = budget or Budget()
    found = [np.zeros((0, len(model.flat.variables)), np.int16)]
    while len(found) <= number and (row := model.least(weights, budget, tell)) is not None:
        found.append(row[None, :])
        if len(found) <= number:
            # That no sum is less than this one is not added: with it, ten rows took a third longer.
            model.add_other(row)
    return np.concatenate(found)
