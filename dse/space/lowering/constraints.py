"""The constraints of a design space as rules over its variables."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from dse.domain.design import DesignSpace
from dse.domain.expression import Expression
from dse.errors import DseError, Problem, raise_if_any
from dse.space.flat import NO_OWNER, NO_VALUE, FlatSpace, Fold, Gather, Ints, Rule
from dse.space.language.interpret import interpret_condition
from dse.space.language.places import Places
from dse.space.language.terms import Constant, Every, Term, TermOperation, parts
from dse.space.lowering.affine import reach
from dse.space.lowering.cells import scope_of_term
from dse.space.lowering.conditions import ConditionLowering
from dse.space.lowering.folds import Folds
from dse.space.lowering.formulas import Atom, Formula, TooLargeError, negation
from dse.space.lowering.judge import Calculator
from dse.space.lowering.rules import rules_of
from dse.space.lowering.shape import SpaceShape, shape_of

MOST_TABLE_CELLS = 4096
"""Combinations of values up to which a rule becomes a table."""

MOST_DECISION_VALUES = 32_766
"""Values of one decision: with their absence they must fit into the 16 bits of `dse.space.flat.Rows`."""


def flatten(space: DesignSpace, most_cells: int = MOST_TABLE_CELLS) -> FlatSpace:
    """*space* with its constraints as rules that hold together iff no constraint's outcome is false.

    Rules over variables with up to *most_cells* combinations of values become tables. Raises DseError, with all
    problems, for constraints that make no sense, and for decisions of more than `MOST_DECISION_VALUES` values.
    """
    shape = shape_of(space)
    raise_if_any(_too_many_values(space, shape))
    places = Places(space)
    rules: list[Rule] = []
    problems: list[Problem] = []
    for number, constraint in enumerate(space.constraints):
        try:
            rules += lower(shape, places, constraint.rule, number, most_cells)
        except DseError as error:
            problems += error.problems
    if problems:
        raise DseError(*problems)
    return FlatSpace(space.name, shape.variables, space.constraints, tuple(rules))


def lower(
    shape: SpaceShape, places: Places, expression: Expression, owner: int, most_cells: int = MOST_TABLE_CELLS
) -> list[Rule]:
    """The rules that hold together iff the outcome of *expression* is not false. Raises DseError like `flatten`."""
    term = interpret_condition(expression, places)
    return rules_of(shape, expression, _parts(shape, expression, term), owner, most_cells)


def selecting(space: DesignSpace, expression: Expression, most_cells: int = MOST_TABLE_CELLS) -> list[Rule]:
    """The rules that hold together iff the outcome of *expression* is true: where it is undefined they do not.

    Nobody owns them. Raises DseError like `flatten`.
    """
    shape = shape_of(space)
    term = interpret_condition(expression, Places(space))
    formula: Formula = Atom(term, scope_of_term(term), outcome=True)
    if not may_fail(shape, expression, term):
        with suppress(TooLargeError):
            formula = ConditionLowering(shape).formula(term, True)
    return rules_of(shape, expression, [formula], NO_OWNER, most_cells)


def _too_many_values(space: DesignSpace, shape: SpaceShape) -> Iterator[Problem]:
    for variable in shape.variables:
        number = len(variable.values)
        if number > MOST_DECISION_VALUES:
            what = f"'{variable.path}' has {number:,} alternatives; one decision takes at most {MOST_DECISION_VALUES:,}"
            yield Problem(what, space.where, "group the alternatives: one decision between groups, one inside each")


def _parts(shape: SpaceShape, expression: Expression, term: Term) -> Iterator[Formula]:
    """Formulas that hold together iff *term* is not false."""
    if may_fail(shape, expression, term):
        if isinstance(term, Every):
            # Conditions before the failing one guard it, so it stays behind them; they hold by themselves, too.
            for condition in term.conditions:
                if may_fail(shape, expression, condition):
                    break
                yield from _parts(shape, expression, condition)
        yield _as_written(term)
        return
    try:
        yield negation(shape, ConditionLowering(shape).formula(term, False))
    except TooLargeError:
        yield _as_written(term)


def _as_written(term: Term) -> Formula:
    return Atom(term, scope_of_term(term), outcome=False, denied=True)


def may_fail(shape: SpaceShape, expression: Expression, term: Term) -> bool:
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
        if isinstance(term, TermOperation):
            if term.operator in ("^", "sqrt"):
                return True
            if term.operator == "/" and not (isinstance(term.operands[1], Constant) and term.operands[1].value):
                return True
        stack.extend(parts(term))
    return False


def _reach(shape: SpaceShape, fold: Fold) -> tuple[int, int]:
    """Ends of the fold, each variable for itself."""
    if fold.gather is not Gather.SUM:
        return _reach_of_some(fold)
    low, high = reach(shape, fold.values)
    return fold.start + low, fold.start + high


def _reach_of_some(fold: Fold) -> tuple[int, int]:
    """Of what may be nothing: from the least contribution, or what a product may become."""
    found: list[Ints] = [values[values != NO_VALUE] for values in fold.values.values()]
    numbers = [int(value) for values in found for value in (values.min(), values.max())]
    if fold.start != NO_VALUE:
        numbers.append(fold.start)
    if fold.gather is not Gather.PRODUCT:
        return min(numbers), NO_VALUE
    largest = max(1, abs(fold.start)) if fold.start != NO_VALUE else 1
    for values in found:
        largest *= max(1, int(np.abs(values).max()))
    return -largest if min(numbers) < 0 else min(1, *numbers), NO_VALUE
