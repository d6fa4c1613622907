"""Counted conditions as clauses and sums."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

import numpy as np

from dse.space.flat import Ints
from dse.space.lowering.affine import between
from dse.space.lowering.formulas import (
    FALSE_FORMULA,
    TRUE_FORMULA,
    Formula,
    Literal,
    conjoin,
    disjoin,
    is_constant,
    negation,
)
from dse.space.lowering.shape import SpaceShape


def counting(shape: SpaceShape, formulas: Iterable[Formula], low: int | None, high: int | None) -> Formula | None:
    """Between *low* and *high* of *formulas* hold; None if that is neither a clause nor a sum. Raises TooLargeError."""
    open_: list[Formula] = []
    certain = 0
    for formula in formulas:
        if is_constant(formula, True):
            certain += 1
        elif not is_constant(formula, False):
            open_.append(formula)
    least = 0 if low is None else max(0, low - certain)
    most = len(open_) if high is None else min(len(open_), high - certain)
    if least > most or most < 0:
        return FALSE_FORMULA
    ends = [_at_least(shape, open_, least)]
    # At most so many hold: at least the others do not.
    ends.append(_at_least(shape, [negation(shape, formula) for formula in open_], len(open_) - most))
    if all(ends):
        return conjoin(shape, [end for end in ends if end])
    if all(isinstance(formula, Literal) for formula in open_):
        return _tally(shape, [formula for formula in open_ if isinstance(formula, Literal)], least, most)
    return None


def _at_least(shape: SpaceShape, formulas: list[Formula], number: int) -> Formula | None:
    if number == 0:
        return TRUE_FORMULA
    if number == 1:
        return disjoin(shape, formulas)
    return conjoin(shape, formulas) if number == len(formulas) else None


def _tally(shape: SpaceShape, literals: list[Literal], low: int, high: int) -> Formula:
    weights, always = tally(shape, literals)
    return between(shape, weights, low - always, high - always, Fraction(1))


def tally(shape: SpaceShape, literals: Iterable[Literal]) -> tuple[dict[int, Ints], int]:
    """How many of *literals* hold, as weights that are 0 for what is absent, and a constant."""
    weights: dict[int, Ints] = {}
    always = 0
    for one in literals:
        # What holds for an absent variable counts always, and is taken off where the variable exists and it fails.
        absent = int(one.mask[-1])
        before = weights.setdefault(one.variable, np.zeros(shape.widths[one.variable], np.int64))
        before += one.mask.astype(np.int64) - absent
        always += absent
    return {variable: weight for variable, weight in weights.items() if weight.any()}, always
