"""Whether working out a term may fail, as by a division by zero: then its conditions keep their order."""

from __future__ import annotations

import numpy as np

from dse.domain.expression import Expression
from dse.space.flat import NOTHING, Fold, Gather, Ints
from dse.space.language.terms import Constant, Operation, Term, parts
from dse.space.lowering.affine import reach
from dse.space.lowering.folds import Folds
from dse.space.lowering.judge import Calculator
from dse.space.lowering.shape import Shape


def may_fail(shape: Shape, expression: Expression, term: Term) -> bool:
    """Whether *term* may have no value for some choices; certain only if not."""
    if not _calculates(term):
        return False
    folds = Folds(shape)
    calculator = Calculator(expression, term, folds)
    ends = [_reach(shape, fold) for fold in folds.found]
    found = calculator.bounds([np.array([low]) for low, _ in ends], [np.array([high]) for _, high in ends])
    return bool(np.any(found.fails))


def _calculates(term: Term) -> bool:
    stack = [term]
    while stack:
        term = stack.pop()
        if isinstance(term, Operation):
            if term.operator in ("^", "sqrt"):
                return True
            if term.operator == "/" and not (isinstance(term.operands[1], Constant) and term.operands[1].value):
                return True
        stack.extend(parts(term))
    return False


def _reach(shape: Shape, fold: Fold) -> tuple[int, int]:
    """Ends of the fold, each variable for itself."""
    if fold.gather is not Gather.SUM:
        return _reach_of_some(fold)
    low, high = reach(shape, fold.values)
    return fold.start + low, fold.start + high


def _reach_of_some(fold: Fold) -> tuple[int, int]:
    """Of what may be nothing: from the least contribution, or what a product may become."""
    found: list[Ints] = [values[values != NOTHING] for values in fold.values.values()]
    numbers = [int(value) for values in found for value in (values.min(), values.max())]
    if fold.start != NOTHING:
        numbers.append(fold.start)
    if fold.gather is not Gather.PRODUCT:
        return min(numbers), NOTHING
    largest = max(1, abs(fold.start)) if fold.start != NOTHING else 1
    for values in found:
        largest *= max(1, int(np.abs(values).max()))
    return -largest if min(numbers) < 0 else min(1, *numbers), NOTHING
