"""Partial sums that behave alike: below a node, only the bounds between which of its completions lie matter.

Every node knows the sums its completions can reach. Two partial sums accept the same completions when the same
reachable sum is the last under the upper bound and the same is the last under the lower one; each is replaced by
the greatest of its kind (Abío, Nieuwenhuis, Oliveras, Rodríguez-Carbonell and Mayer-Eichberger 2012 merge the
nodes of a diagram by such intervals).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from dse.space.flat import Bools, Ints, Linear
from dse.space.methods.mdd.diagram import DecisionDiagram, extremes
from dse.space.methods.mdd.distinct import distinct

_SAFE = 1 << 61
_MOST_SUMS = 200_000
"""Reachable sums kept of one layer; further up only the least and the greatest are."""


@dataclass(frozen=True, slots=True, eq=False)
class Reachable:
    """Sums that the completions of the nodes of a layer reach: those of node v in sums[starts[v]:starts[v + 1]]."""

    starts: Ints
    sums: Ints


@dataclass(frozen=True, slots=True, eq=False)
class Bounded:
    """A sum rule on a diagram: what is left to add below each node of each layer, the terminal's included.

    Bounds that no row can break are None. *reachable* is None where the sums are too many, or too large to shift.
    """

    weights: Mapping[int, Ints]
    low: int | None
    high: int | None
    lows: list[Ints]
    highs: list[Ints]
    reachable: list[Reachable | None]


def bounded(diagram: DecisionDiagram, linear: Linear) -> Bounded:
    """The rule on a diagram that is not empty."""
    lows, highs = extremes(diagram, linear.weights)
    least, greatest = int(lows[0][0]), int(highs[0][0])
    # A bound out of reach on the wrong side fails at the root, whatever its size.
    low = None if linear.low is None or linear.low <= least else min(linear.low, greatest + 1)
    high = None if linear.high is None or linear.high >= greatest else max(linear.high, least - 1)
    largest = sum(int(np.abs(weights).max(initial=0)) for weights in linear.weights.values())
    reachable: list[Reachable | None] = [None] * len(lows)
    if 3 * largest < _SAFE and (low, high) != (None, None):
        reachable = _reachable(diagram, linear.weights)
    return Bounded(linear.weights, low, high, lows, highs, reachable)


def settled(rule: Bounded, depth: int, sums: Ints, nodes: Ints) -> tuple[Ints, Bools]:
    """The greatest sums that behave like *sums* at *nodes* of layer *depth*, and which can still meet the rule."""
    low_rest, high_rest = rule.lows[depth][nodes], rule.highs[depth][nodes]
    possible = np.ones(len(sums), np.bool_)
    satisfied = np.ones(len(sums), np.bool_)
    if rule.high is not None:
        possible &= sums <= rule.high - low_rest
        satisfied &= sums <= rule.high - high_rest
    if rule.low is not None:
        possible &= sums >= rule.low - high_rest
        satisfied &= sums >= rule.low - low_rest
    reachable = rule.reachable[depth]
    alike = sums
    if reachable is not None:
        alike = np.full(len(sums), np.iinfo(np.int64).max)
        if rule.high is not None:
            under, _ = _last_up_to(reachable, nodes, rule.high - sums)
            alike = rule.high - under
        if rule.low is not None:
            under, exists = _last_up_to(reachable, nodes, rule.low - 1 - sums)
            alike = np.where(exists, np.minimum(alike, rule.low - 1 - under), alike)
    if rule.high is not None:
        final = rule.high - high_rest
    else:
        final = np.int64(rule.low) - low_rest if rule.low is not None else np.zeros(len(sums), np.int64)
    return np.where(satisfied, final, alike), possible


def _last_up_to(reachable: Reachable, nodes: Ints, most: Ints) -> tuple[Ints, Bools]:
    """The greatest reachable sum <= *most* at each node, and whether there is one."""
    base = int(reachable.sums.min())
    span = int(reachable.sums.max()) - base + 2
    owners = np.repeat(np.arange(len(reachable.starts) - 1), np.diff(reachable.starts))
    keys = owners * span + (reachable.sums - base + 1)
    wanted = nodes * span + np.clip(most - base + 1, 0, span - 1)
    at = np.searchsorted(keys, wanted, side="right") - 1
    exists = at >= reachable.starts[nodes]
    return reachable.sums[np.maximum(at, 0)], exists


def _reachable(diagram: DecisionDiagram, weights: Mapping[int, Ints]) -> list[Reachable | None]:
    """From the end upwards, as far as there are few enough."""
    below = Reachable(np.array([0, 1]), np.zeros(1, np.int64))
    found: list[Reachable | None] = [None] * len(diagram.layers) + [below]
    for depth in range(len(diagram.layers) - 1, -1, -1):
        layer = diagram.layers[depth]
        weight = weights.get(diagram.order[depth], np.zeros(layer.shape[1], np.int64))
        source, value = np.nonzero(layer >= 0)
        child = layer[source, value]
        lengths = below.starts[child + 1] - below.starts[child]
        total = int(lengths.sum())
        if total > _MOST_SUMS:
            break
        ends = np.cumsum(lengths)
        inside = np.arange(total) - np.repeat(ends - lengths, lengths)
        sums = below.sums[np.repeat(below.starts[child], lengths) + inside] + np.repeat(weight[value], lengths)
        owners = np.repeat(source, lengths)
        if (int(sums.max()) - int(sums.min()) + 2) * len(layer) >= _SAFE:
            break
        first, _ = distinct([owners, sums], total)
        starts = np.searchsorted(owners[first], np.arange(len(layer) + 1))
        below = found[depth] = Reachable(starts, sums[first])
    return found
