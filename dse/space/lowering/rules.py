"""A formula as rules of the simplest kinds that are exact: tables, clauses and sums before rules with a judge."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from dse.domain.expression import Expression
from dse.errors import DseError
from dse.space.flat import Clause, Linear, Rule, Table, Wide
from dse.space.lowering.affine import reach
from dse.space.lowering.cells import holds_in
from dse.space.lowering.clauses import Disjunct, clauses
from dse.space.lowering.counts import tally
from dse.space.lowering.formulas import (
    BoundedSum,
    Formula,
    FormulaJunction,
    Literal,
    TooLargeError,
    disjoin,
    is_constant,
    scope_of,
)
from dse.space.lowering.judge import wide
from dse.space.lowering.shape import SpaceShape

_FEWEST_LITERALS = 3
"""Clauses of fewer are tables."""


def rules_of(
    shape: SpaceShape, expression: Expression, formulas: Iterable[Formula], owner: int, most_cells: int
) -> list[Rule]:
    """The rules that hold together iff all of *formulas*, made from *expression*, do.

    Tables have at most *most_cells* cells. Raises DseError where a formula has no value whatever is chosen.
    """
    rules: list[Rule] = []
    for formula in formulas:
        for part in _conjuncts(shape, formula, most_cells):
            rules += _rules(shape, expression, part, owner, most_cells)
    return _merged(rules)


def _conjuncts(shape: SpaceShape, formula: Formula, most_cells: int) -> Iterator[Formula]:
    """Formulas that hold together iff *formula* does; a condition before several is put before each."""
    if not isinstance(formula, FormulaJunction):
        yield formula
    elif formula.every:
        for part in formula.parts:
            yield from _conjuncts(shape, part, most_cells)
    else:
        several = [part for part in formula.parts if isinstance(part, FormulaJunction)]
        if len(several) != 1 or shape.cells(scope_of(formula), most_cells):
            yield formula
            return
        beside = [part for part in formula.parts if part is not several[0]]
        try:
            parts = [disjoin(shape, [*beside, part]) for part in several[0].parts]
        except TooLargeError:
            yield formula
            return
        for part in parts:
            yield from _conjuncts(shape, part, most_cells)


def _rules(shape: SpaceShape, expression: Expression, formula: Formula, owner: int, most_cells: int) -> Iterator[Rule]:
    if is_constant(formula, False):
        yield Table((), np.zeros((), bool), owner)
        return
    if isinstance(formula, FormulaJunction) and len(formula.parts) >= _FEWEST_LITERALS:
        literals = {part.variable: part.mask for part in formula.parts if isinstance(part, Literal)}
        if len(literals) == len(formula.parts):
            yield _clause(shape, literals, owner)
            return
    scope = scope_of(formula)
    if shape.cells(scope, most_cells):
        yield _table(shape, expression, formula, owner)
        return
    counted = formula if isinstance(formula, BoundedSum) else _compensated(shape, formula)
    if counted:
        yield Linear(counted.weights, counted.low, counted.high, owner, counted.scale)
        return
    try:
        found = clauses(shape, formula)
    except DseError:
        found = None
    if found is None:
        yield wide(shape, expression, formula, owner)
    else:
        yield from (_clause(shape, clause, owner) for clause in found)


def _table(shape: SpaceShape, expression: Expression, formula: Formula, owner: int) -> Table | Wide:
    scope = scope_of(formula)
    try:
        return Table(scope, holds_in(shape, formula, scope), owner)
    except DseError:
        # It fails for choices that other constraints may forbid: whoever meets them is told.
        rule = wide(shape, expression, formula, owner)
        if not scope:
            return Table((), np.array(rule.judge.holds([fold.start for fold in rule.folds])), owner)
        return rule


def _clause(shape: SpaceShape, clause: Disjunct, owner: int) -> Rule:
    literals = tuple((variable, mask) for variable, mask in sorted(clause.items()) if mask.any())
    if len(literals) >= _FEWEST_LITERALS:
        return Clause(literals, owner)
    formula = FormulaJunction(False, tuple(Literal(variable, mask) for variable, mask in literals), 1)
    scope = scope_of(formula)
    return Table(scope, holds_in(shape, formula, scope), owner)


def _compensated(shape: SpaceShape, formula: Formula) -> BoundedSum | None:
    """A count with one bound, or literals, as one sum: a literal that holds makes up for all the count may lack.

    None if *formula* is no such thing.
    """
    if not isinstance(formula, FormulaJunction) or formula.every:
        return None
    literals = [part for part in formula.parts if isinstance(part, Literal)]
    totals = [part for part in formula.parts if isinstance(part, BoundedSum)]
    if len(totals) != 1 or len(literals) + 1 < len(formula.parts):
        return None
    total = totals[0]
    least, most = reach(shape, total.weights)
    if (total.low is None) is (total.high is None) or any(abs(values).max() > 1 for values in total.weights.values()):
        return None
    lacking = total.low - least if total.low is not None else (total.high or 0) - most
    held, always = tally(shape, literals)
    weights = {variable: values.copy() for variable, values in total.weights.items()}
    for variable, values in held.items():
        weights[variable] = weights[variable] + lacking * values if variable in weights else lacking * values
    low = None if total.low is None else total.low - lacking * always
    high = None if total.high is None else total.high - lacking * always
    return BoundedSum(weights, low, high)


def _merged(rules: list[Rule]) -> list[Rule]:
    """Tables over the same variables, and bounds of the same sum, as one rule."""
    found: dict[object, int] = {}
    merged: list[Rule] = []
    for rule in rules:
        key = _subject(rule)
        if key not in found:
            found[key] = len(merged)
            merged.append(rule)
            continue
        match rule, merged[found[key]]:
            case Table(scope, allowed, owner), Table() as before:
                merged[found[key]] = Table(scope, before.allowed & allowed, owner)
            case Linear(weights, low, high, owner, scale), Linear() as before:
                low = max((end for end in (low, before.low) if end is not None), default=None)
                high = min((end for end in (high, before.high) if end is not None), default=None)
                merged[found[key]] = Linear(weights, low, high, owner, scale)
    return merged


def _subject(rule: Rule) -> object:
    match rule:
        case Table(scope):
            return scope
        case Linear(weights):
            return tuple(sorted((variable, values.tobytes()) for variable, values in weights.items())), rule.scale
    return id(rule)
