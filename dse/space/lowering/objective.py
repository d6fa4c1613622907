"""Values to be made least or greatest, over the variables of a flat space: ``sum(cost)``, ``sum(cost) / max(mass)``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from dse.domain.design import DesignSpace
from dse.domain.expression import Expression
from dse.expression import require_number
from dse.space.flat import Floats, Fold, Ints
from dse.space.language.interpret import interpret
from dse.space.language.intervals import NumberBounds
from dse.space.language.places import Places
from dse.space.language.terms import Term
from dse.space.lowering.affine import affine, whole_sums
from dse.space.lowering.folds import Folds
from dse.space.lowering.formulas import TooLargeError, is_constant
from dse.space.lowering.judge import Calculator
from dse.space.lowering.shape import SpaceShape, shape_of
from dse.units import Dimension


@dataclass(frozen=True, slots=True, eq=False)
class LinearObjective:
    """constant + scale * (sum over variables of weights[variable][value]), in SI; *scale* is positive.

    Weights are as in `Linear`: shape (values + 1,), the last entry 0, partial sums below 2^62.
    """

    weights: Mapping[int, Ints]
    constant: Fraction
    scale: Fraction
    dimension: Dimension

    def value(self, total: int) -> Fraction:
        """The value where the weights sum up to *total*."""
        return self.constant + self.scale * total


@dataclass(frozen=True, slots=True, eq=False)
class FoldedObjective:
    """A value worked out from *folds*."""

    folds: tuple[Fold, ...]
    calculator: Calculator
    dimension: Dimension

    def value(self, folds: Sequence[int]) -> Fraction | None:
        """The value in SI, exact but for roots; None where it is undefined. Raises DseError where it does not exist."""
        found = self.calculator.value(folds)
        return None if found is None or isinstance(found, str) else Fraction(found)

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Floats, Floats]:
        """Ends between which the value lies, where it is defined, for folds in [low, high]; arrays of one shape.

        Never wrong, may be vague: infinite where a value may not exist, or surely is undefined.
        """
        found = self.calculator.bounds(low, high)
        if not isinstance(found, NumberBounds):
            raise TypeError("an objective is a number")
        known = found.defined & ~found.fails
        return np.where(known, found.low, -np.inf), np.where(known, found.high, np.inf)


LoweredObjective = LinearObjective | FoldedObjective


def objective(space: DesignSpace, expression: Expression) -> LoweredObjective:
    """*expression*, a number, over the variables of `flatten(space)`.

    Raises DseError, located, if it makes no sense or is a condition.
    """
    sort, term = interpret(expression, Places(space))
    require_number(expression, expression.root, sort)
    shape = shape_of(space)
    linear = _linear(shape, term, sort.dimension)
    if linear:
        return linear
    folds = Folds(shape)
    calculator = Calculator(expression, term, folds)
    return FoldedObjective(tuple(folds.found), calculator, sort.dimension)


def _linear(shape: SpaceShape, term: Term, dimension: Dimension) -> LinearObjective | None:
    try:
        number = affine(shape, term)
    except TooLargeError:
        return None
    if number.others or not all(is_constant(formula, True) for formula in number.there):
        return None
    sums = whole_sums(shape, number)
    if sums is None:
        return None
    weights, unit, constant = sums
    return LinearObjective(weights, constant, unit, dimension)
