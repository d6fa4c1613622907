"""Formulas over few variables, worked out for every combination of their values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from itertools import product
from typing import Any

import numpy as np

from dse.domain.expression import Expression, Truth
from dse.space.decisions import Site
from dse.space.flat import ABSENT, Bools
from dse.space.language.arithmetic import ExactValue
from dse.space.language.evaluate import evaluator
from dse.space.language.terms import Term, leaves, sites_of
from dse.space.lowering.formulas import Atom, BoundedSum, Formula, FormulaJunction, Literal
from dse.space.lowering.shape import SpaceShape

Cell = Mapping[int, int]
"""The value number of every variable looked at; `ABSENT` for one that does not exist."""

_NOWHERE = Expression("", Truth(True, (0, 0)))
"""Failures in a cell are caught; the judge tells them where they stand."""


def holds_in(shape: SpaceShape, formula: Formula, scope: Sequence[int]) -> Bools:
    """Where *formula* holds; one axis of length values + 1 for each variable of *scope*, which has all it looks at.

    Raises DseError where an atom does, as for a division by zero.
    """
    return np.broadcast_to(_holds(shape, formula, scope), [shape.widths[variable] for variable in scope]).copy()


def holds_in_cells(shape: SpaceShape, atom: Atom) -> Bools:
    """Where *atom* holds; one axis for each variable of its scope. Raises DseError as `holds_in`."""
    evaluate = evaluator(_NOWHERE, atom.term, _there, lambda _: "")
    widths = [shape.widths[variable] for variable in atom.scope]
    found = np.zeros(widths, bool)
    for index in product(*(range(width) for width in widths)):
        values = (-1 if at == width - 1 else at for at, width in zip(index, widths, strict=True))
        value = evaluate(dict(zip(atom.scope, values, strict=True)))
        found[index] = (value is not None and bool(value) is atom.outcome) is not atom.denied
    return found


def scope_of_term(term: Term) -> tuple[int, ...]:
    """The variables *term* looks at, ascending."""
    branches = {site.branch for leaf in leaves(term) for site in sites_of(leaf)}
    return tuple(sorted({branch[0] for branch in branches if branch}))


def value_in_cells(shape: SpaceShape, term: Term) -> list[ExactValue]:
    """*term*, which looks at one variable, for each of its values and last for its absence.

    Raises DseError as `holds_in`.
    """
    (variable,) = scope_of_term(term)
    evaluate = evaluator(_NOWHERE, term, _there, lambda _: "")
    return [evaluate({variable: value}) for value in (*range(shape.widths[variable] - 1), ABSENT)]


def _holds(shape: SpaceShape, formula: Formula, scope: Sequence[int]) -> Bools:
    match formula:
        case Literal():
            return _along(shape, formula.mask, [formula.variable], scope)
        case BoundedSum(weights, low, high):
            total = sum(_along(shape, values, [variable], scope) for variable, values in weights.items())
            holds = np.ones((1,) * len(scope), bool)
            if low is not None:
                holds = holds & (total >= low)
            return holds if high is None else holds & (total <= high)
        case Atom():
            return _along(shape, holds_in_cells(shape, formula), formula.scope, scope)
        case FormulaJunction():
            holds = np.full((1,) * len(scope), formula.every)
            for part in formula.parts:
                below = _holds(shape, part, scope)
                holds = holds & below if formula.every else holds | below
            return holds


def _along(shape: SpaceShape, array: np.ndarray, own: Sequence[int], scope: Sequence[int]) -> np.ndarray:
    return array.reshape([shape.widths[variable] if variable in own else 1 for variable in scope])


def _there(entries: Sequence[tuple[Site, Any]]) -> Callable[[Cell], list[Any]]:
    always = [value for site, value in entries if site.branch is None]
    tables: dict[int, dict[int, list[Any]]] = {}
    for site, value in entries:
        if site.branch:
            tables.setdefault(site.branch[0], {}).setdefault(site.branch[1], []).append(value)
    pairs = list(tables.items())

    def find(cell: Cell) -> list[Any]:
        found = list(always)
        for variable, table in pairs:
            found += table.get(cell[variable], ())
        return found

    return find
