"""Folds of `Wide` rules: of complete rows, and the interval in which a partial row's fold will lie.

`NO_VALUE` is the fold of nothing at all. As the upper end of an interval it says that the fold may be nothing,
or larger than 64 bits hold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import NO_VALUE, Bools, Fold, Gather, Ints, Rows, Wide
from dse.space.methods.mdd.diagram import DecisionDiagram

_LARGEST = 1 << 62

_NEUTRAL = {Gather.SUM: 0, Gather.MIN: NO_VALUE, Gather.MAX: np.iinfo(np.int64).min, Gather.PRODUCT: 1}


@dataclass(frozen=True, slots=True, eq=False)
class Rest:
    """What completions below the nodes of one layer contribute to a fold; arrays of shape (nodes,).

    *low* and *high* bound it with nothing counted as the neutral element; *some_low* and *some_high* bound the
    contributions that are not nothing, where *may_be_some*.
    """

    low: Ints
    high: Ints
    some_low: Ints
    some_high: Ints
    may_be_some: Bools
    may_be_nothing: Bools


def is_bounded(wide: Wide) -> bool:
    """Whether 64 bits hold every fold of the rule; if not, only its exact judge may be asked."""
    return all(_largest(fold) < _LARGEST for fold in wide.folds)


def rests(diagram: DecisionDiagram, fold: Fold) -> list[Rest]:
    """The rest of a fold for every layer of the diagram, the end included."""
    neutral = _NEUTRAL[fold.gather]
    start = np.full(1, neutral, np.int64)
    below = Rest(start, start, start, start, np.zeros(1, np.bool_), np.ones(1, np.bool_))
    found = [below]
    for depth in range(len(diagram.order) - 1, -1, -1):
        child = diagram.layers[depth]
        there = child >= 0
        values = contributions(fold, diagram.order[depth], child.shape[1])
        nothing = values == NO_VALUE if fold.gather is not Gather.SUM else np.zeros(len(values), np.bool_)
        filled = np.where(nothing, neutral, values)[None, :]
        low, high = _combined(fold.gather, filled, below.low[child], below.high[child])
        some_low = np.where(nothing, below.some_low[child], low)
        some_high = np.where(nothing, below.some_high[child], high)
        some = there & (~nothing | below.may_be_some[child])
        below = Rest(
            _least(low, there),
            _greatest(high, there),
            _least(some_low, some),
            _greatest(some_high, some),
            np.logical_or.reduce(some, axis=1),
            np.logical_or.reduce(there & nothing & below.may_be_nothing[child], axis=1),
        )
        found.append(below)
    return found[::-1]


def contributions(fold: Fold, variable: int, length: int) -> Ints:
    """What each value of a variable, `ABSENT` last, contributes; shape (length,)."""
    values = fold.values.get(variable)
    if values is None:
        return np.full(length, 0 if fold.gather is Gather.SUM else NO_VALUE, np.int64)
    return values


def added(gather: Gather, folded: Ints, contribution: Ints) -> Ints:
    """The fold after one more contribution, element by element."""
    if gather is Gather.SUM:
        return folded + contribution
    if gather is Gather.MIN:
        return np.minimum(folded, contribution)
    first, second = folded == NO_VALUE, contribution == NO_VALUE
    both = np.maximum(folded, contribution) if gather is Gather.MAX else folded * np.where(second, 1, contribution)
    result: Ints = np.where(first, contribution, np.where(second, folded, both))
    return result


def interval(gather: Gather, folded: Ints, rest: Rest, nodes: NDArray[np.integer[Any]]) -> tuple[Ints, Ints]:
    """Ends between which the fold of every completion lies, for what is folded so far at these nodes."""
    low, high = _combined(gather, folded, rest.low[nodes], rest.high[nodes])
    if gather is Gather.SUM or gather is Gather.MIN:
        return low, high
    empty = folded == NO_VALUE
    if not empty.any():
        return low, high
    some, nothing = rest.may_be_some[nodes], rest.may_be_nothing[nodes]
    low = np.where(empty, np.where(some, rest.some_low[nodes], NO_VALUE), low)
    high = np.where(empty, np.where(nothing, NO_VALUE, rest.some_high[nodes]), high)
    return low, high


def fold_rows(fold: Fold, rows: Rows) -> NDArray[Any]:
    """The fold of complete rows, shape (rows,); Python integers where 64 bits may not do."""
    exact: Any = np.int64 if _largest(fold) < _LARGEST else object
    folded = np.full(len(rows), fold.start, exact)
    for variable, values in fold.values.items():
        folded = added(fold.gather, folded, values.astype(exact)[rows[:, variable]])
    return folded


def judged(wide: Wide, folds: Sequence[NDArray[Any]]) -> Bools:
    """Whether the rule holds for complete rows of these folds, exactly; shape (rows,), or () if there are no folds."""
    if not folds:
        holds, fails = wide.judge.bounds((), ())
        return np.array(wide.judge.holds(()) if holds.all() and fails.all() else bool(holds.all()))
    if all(fold.dtype == np.int64 for fold in folds):
        holds, fails = wide.judge.bounds(folds, folds)
        doubtful = np.flatnonzero(holds & fails)
        answer: Bools = np.array(holds, np.bool_)
    else:
        answer = np.ones(len(folds[0]), np.bool_)
        doubtful = np.arange(len(answer))
    known: dict[tuple[int, ...], bool] = {}
    columns = [fold[doubtful].tolist() for fold in folds]
    for row, found in zip(doubtful.tolist(), zip(*columns, strict=True), strict=True):
        if found not in known:
            known[found] = wide.judge.holds(found)
        answer[row] = known[found]
    return answer


def _largest(fold: Fold) -> int:
    """A bound on the magnitude of the fold of anything."""
    parts = [values[values != NO_VALUE] for values in fold.values.values()]
    sizes = [max(abs(int(part.min())), abs(int(part.max()))) for part in parts if len(part)]
    if fold.start != NO_VALUE:
        sizes.append(abs(fold.start))
    if fold.gather is Gather.SUM:
        return sum(sizes)
    if fold.gather is Gather.PRODUCT:
        return prod(max(size, 1) for size in sizes)
    return max(sizes, default=0)


def _combined(gather: Gather, folded: Ints, low: Ints, high: Ints) -> tuple[Ints, Ints]:
    """Ends of the fold of *folded* and something in [low, high]; NOTHING in *folded* only where it is neutral."""
    if gather is Gather.SUM:
        return folded + low, folded + high
    if gather is Gather.MIN:
        return np.minimum(folded, low), np.minimum(folded, high)
    if gather is Gather.MAX:
        return np.maximum(folded, low), np.maximum(folded, high)
    one, other = folded * low, folded * high
    return np.minimum(one, other), np.maximum(one, other)


def _least(values: Ints, where: Bools) -> Ints:
    found: Ints = np.min(values, axis=1, where=where, initial=np.iinfo(np.int64).max)
    return found


def _greatest(values: Ints, where: Bools) -> Ints:
    found: Ints = np.max(values, axis=1, where=where, initial=np.iinfo(np.int64).min)
    return found
