"""Sums as axes of a grid: the Linear rules over a diagram in their least form, and the sums worth keeping.

A sum is moved and divided so that its steps start at 0 and have no common divisor, a bound from below alone is
turned round into one from above, rules over the same sum become one, and rules that every path meets disappear. Of
the partial sums at a level only those matter that can still end within the bounds.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import gcd
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Bools, Ints, Linear
from dse.space.methods.budget import TooMuchError
from dse.space.methods.mdd.diagram import DecisionDiagram

Layers = tuple[NDArray[np.int32], ...]

_FAR = 1 << 61
"""Farther than any sum; twice that still fits."""

_FARTHEST = 1 << 60

_Edges = tuple[NDArray[np.integer[Any]], NDArray[np.integer[Any]], Ints]
"""Source, target, weight."""


@dataclass(frozen=True, slots=True, eq=False)
class SumAxis:
    """low <= sum over layers of weights[layer][value] <= high; *low* None is no bound.

    Weights are whole, at least 0, and 0 where no path takes the value; shape (values + 1,) each.
    """

    weights: tuple[Ints, ...]
    low: int | None
    high: int


@dataclass(frozen=True, slots=True)
class SumSpan:
    """Partial sums low..high of an axis at a level; a smaller one counts as *low* if *gathered*, else not at all."""

    low: int
    high: int
    gathered: bool

    @property
    def length(self) -> int:
        """How many sums."""
        return self.high - self.low + 1


@dataclass(frozen=True, slots=True, eq=False)
class SumReach:
    """Least and most of a sum per level and node: over the paths from the root, and over those to the terminal."""

    least_before: tuple[Ints, ...]
    most_before: tuple[Ints, ...]
    least_after: tuple[Ints, ...]
    most_after: tuple[Ints, ...]


def axes(diagram: DecisionDiagram) -> tuple[SumAxis, ...] | None:
    """An axis for each sum that some path breaks, None if no path meets a rule. The diagram is not empty."""
    used = tuple(np.asarray((layer >= 0).any(axis=0)) for layer in diagram.layers)
    sums: dict[tuple[bytes, ...], _Sum] = {}
    for rule in diagram.flat.linears():
        found = _least_form(rule, diagram.order, used)
        key = tuple(weights.tobytes() for weights in found.weights)
        sums[key] = sums[key].met_with(found) if key in sums else found
    kept = []
    for found in sums.values():
        least, most = _range(diagram.layers, found.weights)
        low = None if found.low is None or found.low <= least else found.low
        high = None if found.high is None or found.high >= most else found.high
        if (low is not None and low > (most if high is None else high)) or (high is not None and high < least):
            return None
        if high is not None:
            kept.append(SumAxis(found.weights, low, high))
        elif low is not None:
            kept.append(_turned_round(found.weights, used, low))
    return tuple(kept)


def pruned(layers: Layers, sums: Sequence[SumAxis]) -> Layers:
    """Without the edges that no path within the bounds of one axis takes; nodes keep their numbers."""
    # The last pass takes away what leads nowhere, or comes from nowhere, since the others.
    anything = SumAxis(tuple(np.zeros(layer.shape[1], np.int64) for layer in layers), None, 0)
    for axis in (*sums, anything):
        reach = reached(layers, axis.weights)
        kept = []
        for level, (layer, weights) in enumerate(zip(layers, axis.weights, strict=True)):
            least = reach.least_before[level][:, None] + weights + reach.least_after[level + 1][layer]
            most = reach.most_before[level][:, None] + weights + reach.most_after[level + 1][layer]
            possible = (layer >= 0) & (least <= axis.high) & (most >= (-_FAR if axis.low is None else axis.low))
            kept.append(np.where(possible, layer, np.int32(-1)))
        layers = tuple(kept)
    return layers


def reached(layers: Layers, weights: Sequence[Ints]) -> SumReach:
    """Extremes of a sum at every node; on nodes without a complete path, least lies far above and most far below."""
    least_after, most_after = _after(layers, weights)
    least, most = np.zeros(1, np.int64), np.zeros(1, np.int64)
    least_before, most_before = [least], [most]
    for layer, weight, below in zip(layers, weights, least_after[1:], strict=True):
        source, value = np.nonzero(layer >= 0)
        child = layer[source, value]
        least_child, most_child = np.full(len(below), _FAR), np.full(len(below), -_FAR)
        np.minimum.at(least_child, child, least[source] + weight[value])
        np.maximum.at(most_child, child, most[source] + weight[value])
        least, most = np.minimum(least_child, _FAR), np.maximum(most_child, -_FAR)
        least_before.append(least)
        most_before.append(most)
    for before, after in ((least_before, least_after), (most_before, most_after)):
        for x, y in zip(before, after, strict=True):
            nowhere = (abs(x) >= _FARTHEST) | (abs(y) >= _FARTHEST)
            x[nowhere] = y[nowhere] = _FAR if before is least_before else -_FAR
    return SumReach(tuple(least_before), tuple(most_before), tuple(least_after), tuple(most_after))


def spans(layers: Layers, axis: SumAxis, reach: SumReach) -> tuple[list[SumSpan], list[SumSpan]] | None:
    """Per level, the sums of what lies before it, and of what lies after it, that can still end within the bounds.

    None if nothing can. Sums before are gathered if they fit whatever follows; sums after, if they fit whatever
    comes before, gathered or not: so two gathered sums fit each other.
    """
    edges: list[_Edges] = []
    for layer, weights in zip(layers, axis.weights, strict=True):
        parent, value = np.nonzero(layer >= 0)
        edges.append((parent, layer[parent, value], weights[value]))
    before, most_before = _spans(
        axis, edges, reach.least_before, reach.most_before, reach.least_after, reach.most_after
    )
    upward = [(child, parent, weights) for parent, child, weights in reversed(edges)]
    after, _ = _spans(
        axis, upward, reach.least_after[::-1], reach.most_after[::-1], reach.least_before[::-1], most_before[::-1]
    )
    return None if any(span.length <= 0 for span in (*before, *after)) else (before, after[::-1])


@dataclass(frozen=True, slots=True, eq=False)
class _Sum:
    weights: tuple[Ints, ...]
    low: int | None
    high: int | None

    def met_with(self, other: _Sum) -> _Sum:
        lows = [low for low in (self.low, other.low) if low is not None]
        highs = [high for high in (self.high, other.high) if high is not None]
        return _Sum(self.weights, max(lows, default=None), min(highs, default=None))


def _least_form(rule: Linear, order: Sequence[int], used: Sequence[Bools]) -> _Sum:
    start, divisor, moved = 0, 0, []
    for variable, mask in zip(order, used, strict=True):
        weights = rule.weights.get(variable)
        if weights is None:
            moved.append(np.zeros(len(mask), np.int64))
            continue
        least = int(weights[mask].min())
        start += least
        moved.append(np.where(mask, weights - least, 0))
        divisor = gcd(divisor, int(np.gcd.reduce(moved[-1])))
    divisor = divisor or 1
    low = None if rule.low is None else -((start - rule.low) // divisor)
    high = None if rule.high is None else (rule.high - start) // divisor
    weights_all = tuple(weights // divisor for weights in moved)
    if sum(int(weights.max()) for weights in weights_all) >= _FARTHEST:
        raise TooMuchError("a sum is too fine for a grid")
    return _Sum(weights_all, low, high)


def _turned_round(weights: Sequence[Ints], used: Sequence[Bools], low: int) -> SumAxis:
    """What is missing from the most each layer could give is bounded from above."""
    most = [int(weight.max()) for weight in weights]
    missing = tuple(np.where(mask, top - weight, 0) for weight, mask, top in zip(weights, used, most, strict=True))
    return SumAxis(missing, None, sum(most) - low)


def _after(layers: Layers, weights: Sequence[Ints]) -> tuple[list[Ints], list[Ints]]:
    least, most = np.zeros(1, np.int64), np.zeros(1, np.int64)
    least_after, most_after = [least], [most]
    for layer, weight in zip(reversed(layers), reversed(weights), strict=True):
        possible = layer >= 0
        least = np.minimum(np.where(possible, least[layer] + weight, _FAR).min(axis=1), _FAR)
        most = np.maximum(np.where(possible, most[layer] + weight, -_FAR).max(axis=1), -_FAR)
        least_after.append(least)
        most_after.append(most)
    return least_after[::-1], most_after[::-1]


def _range(layers: Layers, weights: Sequence[Ints]) -> tuple[int, int]:
    least, most = _after(layers, weights)
    return int(least[0][0]), int(most[0][0])


def _spans(
    axis: SumAxis,
    edges: Sequence[_Edges],
    least: Sequence[Ints],
    most: Sequence[Ints],
    least_other: Sequence[Ints],
    most_other: Sequence[Ints],
) -> tuple[list[SumSpan], list[Ints]]:
    """Spans of one side, level by level from its end, and the most at each node once small sums are gathered."""
    found, raised = [], [most[0]]
    for level in range(len(least)):
        own, complete = raised[level], most[level] > -_FARTHEST
        furthest = int(most_other[level].max())
        low = (axis.high if axis.low is None else axis.low) - furthest
        start = max(int(least[level].min()), low)
        if axis.low is None:
            own = np.where(complete, np.maximum(own, start), own)
        end = min(int(own.max()), axis.high - int(least_other[level].min()))
        found.append(SumSpan(start, end, axis.low is None and low > int(least[level].min())))
        raised[level] = own
        if level < len(edges):
            source, target, weights = edges[level]
            following = np.full(len(most[level + 1]), -_FAR)
            # A gathered sum may be greater than any that was there before.
            np.maximum.at(following, target, own[source] + weights)
            raised.append(following)
    return found, raised
