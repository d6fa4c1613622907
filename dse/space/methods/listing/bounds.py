"""Cuts: sums that every valid row keeps below a bound, and what a partial row can still reach of them.

A cut is one side of a sum rule. A surrogate, a positive combination of cuts, follows from them and is no news
for a complete row, but it sees of a partial row that two bounds cannot both be met, where each alone still
could (Glover, Surrogate constraints, 1968). Its multipliers are those of the maximum-entropy distribution over
the choices whose mean sums keep the bounds. All is in whole numbers; multipliers are rounded before they are used.

Example: three places, each with cost 1 and mass 4 or with cost 4 and mass 1; cost <= 7 and mass <= 7. The least cost
is 3 and the least mass is 3, so neither cut refutes anything. Their sum is a surrogate: cost + mass <= 14. Every row
has 15, so the space is empty before any row is tried.

Cost: one pass over the diagram for each cut. Surrogates are made of all cuts that bind and of the pairs of the five
that bind most. Measured: docs/decisions/0007-design-space-engine.md.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import gcd

import numpy as np

from dse.space.flat import FlatSpace, Floats, Ints, Linear
from dse.space.methods.mdd.diagram import DecisionDiagram

_SAFE = 1 << 61
_FINE = 8
"""What the smallest multiplier of a surrogate comes to at least, so that rounding does not change much,"""
_SMALL = 1 << 15
"""and how large the sums of a surrogate are allowed to become for its sake."""
_PAIRS_OF = 5
_ITERATIONS = 30


@dataclass(frozen=True, slots=True, eq=False)
class Cut:
    """sum over variables of weights[variable][value] <= high; weights as in `Linear`.

    A surrogate was put together of others: *multipliers* of those it came from, by their position.
    """

    weights: Mapping[int, Ints]
    high: int
    multipliers: Mapping[int, int] | None = None


def cuts_of(linears: Sequence[Linear]) -> list[Cut]:
    """Every bound of the sums as a cut of its own."""
    found: list[Cut] = []
    for linear in linears:
        if linear.high is not None:
            found.append(Cut(linear.weights, linear.high))
        if linear.low is not None:
            found.append(Cut({variable: -weights for variable, weights in linear.weights.items()}, -linear.low))
    return found


def divisor(weights: Mapping[int, Ints]) -> int:
    """The greatest that divides all weights, at least 1."""
    return gcd(*(int(np.gcd.reduce(values)) for values in weights.values())) or 1


def tightest(cuts: Sequence[Cut]) -> list[Cut]:
    """The cuts in the least whole numbers, and of those of the same sum only the one of the least bound."""
    found: dict[tuple[tuple[int, bytes], ...], Cut] = {}
    for cut in map(_in_least_terms, cuts):
        key = tuple((variable, cut.weights[variable].tobytes()) for variable in sorted(cut.weights))
        if key not in found or cut.high < found[key].high:
            found[key] = cut
    return list(found.values())


def fits(linear: Linear) -> bool:
    """Whether the sum leaves room for the arithmetic of cuts."""
    bounds = [abs(bound) for bound in (linear.low, linear.high) if bound is not None]
    return _reach(linear.weights) + max(bounds, default=0) < _SAFE


def surrogates(flat: FlatSpace, cuts: Sequence[Cut]) -> list[Cut]:
    """Combinations of the cuts that bind: of all, and of every two among those that bind most.

    Of cuts that contradict each other whatever is chosen, only that.
    """
    if len(cuts) < 2 or not flat.variables:
        return []
    if plain := _contradiction(cuts):
        return plain
    matrix, there = _padded(flat, cuts)
    multipliers = _tilt(flat, matrix, there, cuts)
    binding = [int(n) for n in np.argsort(-multipliers * _spread(matrix, there), kind="stable") if multipliers[n] > 0]
    found = _of(cuts, sorted(binding), multipliers[sorted(binding)])
    if len(binding) > 2:
        for pair in combinations(sorted(binding[:_PAIRS_OF]), 2):
            members = list(pair)
            found += _of(cuts, members, _tilt(flat, matrix[members], there, [cuts[number] for number in members]))
    return found


def overall(flat: FlatSpace, cuts: Sequence[Cut]) -> list[Cut]:
    """The combination of all cuts that bind alone, if at least two do; or of two that contradict each other."""
    if len(cuts) < 2 or not flat.variables:
        return []
    return _contradiction(cuts) or _of(cuts, range(len(cuts)), _tilt(flat, *_padded(flat, cuts), cuts))


def combined(cuts: Sequence[Cut], multipliers: Mapping[int, float]) -> Cut | None:
    """The sum of cuts times positive *multipliers*, by position, these rounded; None if that leaves 62 bits."""
    reach = sum(float(m) * _reach(cuts[number].weights) for number, m in multipliers.items())
    # Few digits do: a multiplier that is rounded is as good, and short sums share a word.
    factor = max(_SMALL / reach, _FINE / min(multipliers.values())) if reach > 0 else 1.0
    whole = {number: round(m * factor) for number, m in multipliers.items()}
    if sum(m * max(_reach(cuts[number].weights), 1) for number, m in whole.items()) >= _SAFE:
        return None
    weights: dict[int, Ints] = {}
    for number, multiplier in whole.items():
        for variable, values in cuts[number].weights.items():
            scaled = values * multiplier
            weights[variable] = weights[variable] + scaled if variable in weights else scaled
    return Cut(weights, sum(m * cuts[number].high for number, m in whole.items()), whole)


def least(diagram: DecisionDiagram, weights: Sequence[Ints], sums: int) -> list[Ints]:
    """The least of each of *sums* sums over all completions: per layer, the end included, shape (sums, nodes).

    *weights* as `stacked` makes them.
    """
    reached = [np.zeros((sums, 1), np.int64)]
    for child, of_layer in zip(reversed(diagram.layers), reversed(weights), strict=True):
        through = reached[-1][:, child] + of_layer[:, None, :]
        through[:, child < 0] = np.iinfo(np.int64).max
        reached.append(through.min(axis=2))
    return reached[::-1]


def stacked(diagram: DecisionDiagram, sums: Sequence[Mapping[int, Ints]]) -> list[Ints]:
    """The weights of every sum by layer, shape (sums, values + 1)."""
    found = []
    for variable, layer in zip(diagram.order, diagram.layers, strict=True):
        nothing = np.zeros(layer.shape[1], np.int64)
        rows = [weights.get(variable, nothing) for weights in sums]
        found.append(np.array(rows, np.int64).reshape(len(sums), layer.shape[1]))
    return found


def opposite(one: Mapping[int, Ints], other: Mapping[int, Ints]) -> bool:
    """Whether one sum is always the other with its sign turned."""
    return all(
        not (one.get(variable, np.int64(0)) + other.get(variable, np.int64(0))).any() for variable in {*one, *other}
    )


def _in_least_terms(cut: Cut) -> Cut:
    # Only so it shows what is the same sum, or its negative; and a bound between multiples is one below.
    common = divisor(cut.weights)
    return Cut({variable: values // common for variable, values in cut.weights.items()}, cut.high // common)


def _contradiction(cuts: Sequence[Cut]) -> list[Cut]:
    for (first, one), (second, other) in combinations(enumerate(cuts), 2):
        if one.high + other.high < 0 and opposite(one.weights, other.weights):
            return [Cut({}, one.high + other.high, {first: 1, second: 1})]
    return []


def _of(cuts: Sequence[Cut], members: Sequence[int], multipliers: Floats) -> list[Cut]:
    positive = {number: float(m) for number, m in zip(members, multipliers, strict=True) if m > 0}
    made = combined(cuts, positive) if len(positive) > 1 else None
    return [] if made is None else [made]


def _reach(weights: Mapping[int, Ints]) -> int:
    return sum(int(np.abs(values).max()) for values in weights.values())


def _padded(flat: FlatSpace, cuts: Sequence[Cut]) -> tuple[Floats, Floats]:
    """Weights, shape (cuts, variables, values), and 1.0 where a variable has that many values."""
    width = max(1, *(len(variable.values) for variable in flat.variables))
    matrix = np.zeros((len(cuts), len(flat.variables), width))
    there = np.zeros((len(flat.variables), width))
    for number, variable in enumerate(flat.variables):
        there[number, : max(len(variable.values), 1)] = 1.0
        for row, cut in enumerate(cuts):
            if number in cut.weights:
                matrix[row, number, : len(variable.values)] = cut.weights[number][:-1]
    return matrix, there


def _spread(matrix: Floats, there: Floats) -> Floats:
    sizes = there.sum(axis=1)
    mean = (matrix * there).sum(axis=2) / sizes
    variance = ((matrix - mean[:, :, None]) ** 2 * there).sum(axis=2) / sizes
    spread = np.sqrt(variance.sum(axis=1))
    # A sum without choice still has a size.
    found: Floats = np.where(spread > 0, spread, np.maximum(np.abs(matrix).max(axis=(1, 2)), 1.0))
    return found


def _tilt(flat: FlatSpace, matrix: Floats, there: Floats, cuts: Sequence[Cut]) -> Floats:
    """Multipliers >= 0, shape (cuts,), of the exponential family over the hierarchy, rules aside.

    Projected Newton steps towards mean sum = bound. They need not be accurate: any give a valid surrogate.
    """
    scale = _spread(matrix, there)
    unit = matrix / scale[:, None, None]
    target = np.array([float(cut.high) for cut in cuts]) / scale
    multipliers = np.zeros(len(cuts))
    for _ in range(_ITERATIONS):
        energy = np.where(there > 0, -np.tensordot(multipliers, unit, axes=1), -np.inf)
        share = np.exp(energy - energy.max(axis=1, keepdims=True))
        share /= share.sum(axis=1, keepdims=True)
        share *= _presence(flat, share)[:, None]
        mean = unit * share
        expected = mean.sum(axis=2)
        present = np.maximum(share.sum(axis=1), 1e-12)
        covariance = np.tensordot(mean, unit, axes=((1, 2), (1, 2))) - (expected / present) @ expected.T
        excess = expected.sum(axis=1) - target
        free = (multipliers > 0) | (excess > 0)
        if not free.any():
            break
        inner = covariance[np.ix_(free, free)] + 1e-3 * np.eye(int(free.sum()))
        step = np.zeros(len(cuts))
        step[free] = np.clip(np.linalg.solve(inner, excess[free]), -1.0, 1.0)
        moved = np.maximum(multipliers + step, 0.0)
        if np.abs(moved - multipliers).max() < 1e-3:
            break
        multipliers = moved
    return np.where(multipliers > 1e-3, multipliers, 0.0) / scale


def _presence(flat: FlatSpace, share: Floats) -> Floats:
    """How probable it is that a variable exists, when values have the probabilities *share* where it does."""
    presence = np.ones(len(flat.variables))
    for number, variable in enumerate(flat.variables):
        if variable.parent is not None:
            parent, value = variable.parent
            presence[number] = presence[parent] * share[parent, value]
    return presence
