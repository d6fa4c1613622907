"""The best rows under a quotient of two sums, as a power-to-mass ratio."""

from __future__ import annotations

from fractions import Fraction
from math import lcm

import numpy as np

from dse.domain.design import DesignSpace
from dse.domain.expression import Binary, Expression
from dse.space.flat import Ints, Rows
from dse.space.lowering.objective import LinearObjective, objective
from dse.space.methods.mdd.diagram import DecisionDiagram, extremes
from dse.space.methods.optimum.optimizer import RankedRows, best, sums

_SAFE = 1 << 60


def as_ratio(space: DesignSpace, expression: Expression) -> tuple[LinearObjective, LinearObjective] | None:
    """The two sides if *expression* is a quotient of sums, else None. Raises DseError like `objective`."""
    root = expression.root
    if not isinstance(root, Binary) or root.operator != "/":
        return None
    above, below = (
        objective(space, Expression(expression.text, side, expression.where, expression.pieces))
        for side in (root.left, root.right)
    )
    return (above, below) if isinstance(above, LinearObjective) and isinstance(below, LinearObjective) else None


def best_ratio(
    diagram: DecisionDiagram, above: LinearObjective, below: LinearObjective, number: int, *, largest: bool
) -> RankedRows | None:
    """The *number* rows of least (or largest) above / below; of equal ones those that are listed first.

    None if *below* may be 0 or negative, or the numbers become too long. Exact: with r the worst quotient of any
    *number* rows, that of the rows of least above - r * below is no worse, and only the right ones reproduce theirs
    (Dinkelbach, On nonlinear fractional programming, 1967, for several rows at once).
    """
    if diagram.empty or below.value(int(extremes(diagram, below.weights)[0][0][0])) <= 0:
        return None
    sign = -1 if largest else 1
    rows = best(diagram, above.weights, number, largest=largest).rows
    while len(rows):
        worst = max(sign * ratio for ratio in _ratios(above, below, rows))
        slanted = _slanted(above, below, sign, worst)
        if slanted is None:
            return None
        rows = best(diagram, slanted, number).rows
        found = _ratios(above, below, rows)
        if max(sign * ratio for ratio in found) == worst:
            break
    if not len(rows):
        return RankedRows(rows, ())
    listed = rows[:, diagram.order].tolist()
    order = sorted(range(len(rows)), key=lambda place: (sign * found[place], listed[place]))
    return RankedRows(rows[order], tuple(found[place] for place in order))


def _ratios(above: LinearObjective, below: LinearObjective, rows: Rows) -> list[Fraction]:
    pairs = zip(sums(above.weights, rows).tolist(), sums(below.weights, rows).tolist(), strict=True)
    return [above.value(one) / below.value(other) for one, other in pairs]


def _slanted(above: LinearObjective, below: LinearObjective, sign: int, ratio: Fraction) -> dict[int, Ints] | None:
    """Whole weights that rank rows as sign * above - ratio * below does; None if 64 bits do not hold their sums."""
    gain, loss = sign * above.scale, -ratio * below.scale
    common = lcm(gain.denominator, loss.denominator)
    sides = ((int(gain * common), above), (int(loss * common), below))
    if sum(abs(factor) * _reach(side) for factor, side in sides) >= _SAFE:
        return None
    weights: dict[int, Ints] = {}
    for factor, side in sides:
        for variable, values in side.weights.items():
            weights[variable] = weights.get(variable, np.zeros(1, np.int64)) + factor * values
    return weights


def _reach(side: LinearObjective) -> int:
    return sum(int(np.abs(values).max()) for values in side.weights.values())
