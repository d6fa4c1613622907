"""The best configurations under an objective in the user's words, and the Pareto set of several."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

import numpy as np

from dse.domain.design import DesignSpace
from dse.domain.expression import Binary, Expression, Number
from dse.errors import Location, fail
from dse.expression import descend, parse_expression
from dse.space.configurations.ids import IdentifiedChoices
from dse.space.decisions import sites
from dse.space.flat import Ints, Rows
from dse.space.lowering.objective import FoldedObjective, LinearObjective, LoweredObjective, objective
from dse.space.methods.budget import TooMuchError
from dse.space.methods.engine import Engine
from dse.space.methods.mdd.diagram import extremes
from dse.space.methods.optimum.optimizer import RankedRows, sums
from dse.space.methods.optimum.regions import best_valued
from dse.space.methods.solver.model import SolverProgress, UnprovenError
from dse.units import DIMENSIONLESS, Dimension, OwnUnits, Unit, UnitError, describe, own_units, parse_unit

_ROUNDS = 1_500
"""Pieces of work, some milliseconds each, after which the best under a nonlinear objective is not looked for."""


@dataclass(frozen=True, slots=True)
class Aim:
    """An objective, to be made least, or greatest if *largest*."""

    expression: Expression
    largest: bool = False

    def __str__(self) -> str:
        return " ".join(self.expression.text.split())


@dataclass(frozen=True, slots=True)
class Ranked(IdentifiedChoices):
    """A configuration's choices and the exact value of each aim, in SI."""

    values: tuple[Fraction, ...]


def read_aims(minimize: Iterable[str], maximize: Iterable[str], units: OwnUnits | None = None) -> tuple[Aim, ...]:
    """The objectives written in texts, which may use *units* too; those to be minimised first. Raises DseError."""
    with own_units(units or {}):
        return (
            *(Aim(parse_expression(text, Location("--minimize", 1, 1))) for text in minimize),
            *(Aim(parse_expression(text, Location("--maximize", 1, 1)), largest=True) for text in maximize),
        )


def best_configurations(
    space: DesignSpace, engine: Engine, aim: Aim, number: int, tell: Callable[[str], None] | None = None
) -> tuple[Ranked, ...]:
    """The *number* best valid configurations, best first; of equal ones those that are listed first.

    Complete and exact: proven optimal. Of equal ones that the solver found, it is always the same. A configuration for
    which the value is undefined is not ranked. *tell* hears how far the solver is. Raises DseError if the objective
    makes no sense, or if what is best cannot be proven.
    """
    lowered = objective(space, aim.expression)
    if isinstance(lowered, FoldedObjective) and not lowered.folds:
        constant = lowered.value(())
        if constant is None:
            return ()
        lowered = LinearObjective({}, constant, Fraction(1), lowered.dimension)
    if isinstance(lowered, LinearObjective):
        ranking = _linear(space, engine, aim, lowered, number, tell)
    else:
        ranking = _nonlinear(space, engine, aim, lowered, number)
    values = [Fraction(value) for value in ranking.values]
    return tuple(Ranked(engine.flat.choices(row), (value,)) for row, value in zip(ranking.rows, values, strict=True))


def pareto_set(space: DesignSpace, engine: Engine, wanted: Sequence[Aim]) -> tuple[Ranked, ...]:
    """Configurations, one for each point of the complete Pareto set of *wanted*, ascending by the first aim.

    Raises DseError if an objective is no sum of properties, or there are too many points.
    """
    lowered = [_sum(objective(space, aim.expression), aim) for aim in wanted]
    try:
        front = engine.pareto([aim.weights for aim in lowered], [aim.largest for aim in wanted])
    except TooMuchError as error:
        hint = "fewer objectives, coarser properties or tighter constraints need less"
        raise fail(f"the Pareto set of '{engine.flat.name}' takes too long", None, hint) from error
    return tuple(
        Ranked(engine.flat.choices(row), tuple(aim.value(total) for aim, total in zip(lowered, point, strict=True)))
        for row, point in zip(front.rows, front.values, strict=True)
    )


def display_unit(space: DesignSpace, aim: Aim) -> Unit:
    """The unit to show the values of *aim* in: that of its own numbers, else of the properties it is made of.

    A quotient or product of these has a unit of theirs, ``W/kg`` or ``W.h``; what is left is in SI.
    """
    dimension = objective(space, aim.expression).dimension
    written = [node.unit for node in descend(aim.expression.root) if isinstance(node, Number)]
    stated = {
        quantity.unit: None
        for site in sites(space)
        for quantity in (site.component.properties.values() if site.component else ())
        if not quantity.unit.offset
    }
    parts = [unit.symbol for unit in dict.fromkeys((*written, *stated)) if unit.symbol]
    made = (f"{one}{sign}{other}" for other in parts for one in parts for sign in "/.")
    candidates = (*written, *stated, DIMENSIONLESS)
    simple = next((unit for unit in candidates if unit.dimension == dimension), None)
    return simple or next((unit for unit in _read(made) if unit.dimension == dimension), _si(dimension))


def _read(symbols: Iterable[str]) -> Iterator[Unit]:
    """Those of *symbols* that are units: not all that can stand alone can be part of another."""
    for symbol in symbols:
        with suppress(UnitError):
            yield parse_unit(symbol)


def _si(dimension: Dimension) -> Unit:
    return Unit(f"SI base units ({describe(dimension)})", Fraction(1), Fraction(0), dimension)


def _linear(
    space: DesignSpace,
    engine: Engine,
    aim: Aim,
    lowered: LinearObjective,
    number: int,
    tell: Callable[[str], None] | None,
) -> RankedRows:
    def text(progress: SolverProgress) -> str:
        return _progress_text(display_unit(space, aim), lowered, progress, largest=aim.largest)

    sign = -1 if aim.largest else 1
    listener = None if tell is None else lambda progress: tell(text(progress))
    try:
        rows = engine.least({v: sign * w for v, w in lowered.weights.items()}, number, listener)
    except TooMuchError as error:
        progress = error.progress if isinstance(error, UnprovenError) else None
        what = f"the best of '{engine.flat.name}' under '{aim}' cannot be proven"
        hint = "fix some choices, or add a constraint"
        raise fail(f"{what}: {text(progress)}" if progress else what, None, hint) from error
    return RankedRows(rows, tuple(lowered.value(total) for total in sums(lowered.weights, rows).tolist()))


def _progress_text(unit: Unit, lowered: LinearObjective, progress: SolverProgress, *, largest: bool) -> str:
    """``found 120 EUR, none is below 100 EUR (gap 16.7 %)``."""
    sign = -1 if largest else 1

    def shown(total: int) -> str:
        return f"{float((lowered.value(sign * total) - unit.offset) / unit.factor):.6g} {unit}".strip()

    bound = f"none is {'above' if largest else 'below'} {shown(progress.bound)}"
    if progress.found is None:
        return f"nothing found, {bound}"
    value = lowered.value(sign * progress.found)
    if not value:
        return f"found {shown(progress.found)}, {bound}"
    gap = 100 * abs(float((progress.found - progress.bound) * lowered.scale / value))
    return f"found {shown(progress.found)}, {bound} (gap {gap:.1f} %)"


def _nonlinear(space: DesignSpace, engine: Engine, aim: Aim, lowered: FoldedObjective, number: int) -> RankedRows:
    what = f"the best of '{engine.flat.name}' under '{aim}' cannot be proven"
    hint = "fix some choices, add a constraint, or ask for a sum or a quotient of sums"
    sides = as_ratio(space, aim.expression)
    try:
        ranking = best_ratio(engine, *sides, number, largest=aim.largest) if sides else None
        if ranking is not None:
            return ranking
        if engine.diagram is not None:
            return best_valued(engine.diagram, lowered, number, largest=aim.largest, most_rounds=_ROUNDS)
    except TooMuchError as error:
        raise fail(what, None, hint) from error
    raise fail(f"{what}: the space is too large for a decision diagram", None, hint)


def _sum(lowered: LoweredObjective, aim: Aim) -> LinearObjective:
    if isinstance(lowered, LinearObjective):
        return lowered
    raise fail(f"'{aim}' is no sum of properties, as a Pareto set needs", None, "ask for the best under it instead")


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
    engine: Engine, above: LinearObjective, below: LinearObjective, number: int, *, largest: bool
) -> RankedRows | None:
    """The *number* rows of least (or largest) above / below; of equal ones those that are listed first.

    None if *below* may be 0 or negative, or the numbers become too long. Exact: with r the worst quotient of any
    *number* rows, that of the rows of least above - r * below is no worse, and only the right ones reproduce theirs
    (Dinkelbach, On nonlinear fractional programming, 1967, for several rows at once). Raises TooMuchError like
    `Engine.least`.
    """
    if not _is_positive(engine, below):
        return None
    sign = -1 if largest else 1
    rows = engine.least({variable: sign * values for variable, values in above.weights.items()}, number)
    while len(rows):
        worst = max(sign * ratio for ratio in _ratios(above, below, rows))
        slanted = _slanted(above, below, sign, worst)
        if slanted is None:
            return None
        rows = engine.least(slanted, number)
        found = _ratios(above, below, rows)
        if max(sign * ratio for ratio in found) == worst:
            break
    if not len(rows):
        return RankedRows(rows, ())
    listed = (rows if engine.diagram is None else rows[:, engine.diagram.order]).tolist()
    order = sorted(range(len(rows)), key=lambda place: (sign * found[place], listed[place]))
    return RankedRows(rows[order], tuple(found[place] for place in order))


def _is_positive(engine: Engine, below: LinearObjective) -> bool:
    if engine.diagram is not None:
        return not engine.diagram.empty and below.value(int(extremes(engine.diagram, below.weights)[0][0][0])) > 0
    rows = engine.least(below.weights, 1)
    return len(rows) == 0 or below.value(int(sums(below.weights, rows)[0])) > 0


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
