"""Formulas over few variables, worked out for every combination of their values."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from fractions import Fraction
from itertools import product
from typing import TypeVar

import numpy as np

from dse.domain.expression import Expression, Truth
from dse.space.decisions import Site
from dse.space.flat import Bools
from dse.space.language.arithmetic import Value
from dse.space.language.evaluate import Evaluate, evaluator
from dse.space.language.terms import Leaf, RollUp, SameChoice, Standing, Stated
from dse.space.lowering.formulas import Atom, Formula, Junction, Literal, Total
from dse.space.lowering.shape import Shape

T = TypeVar("T")
Cell = Mapping[int, int]
"""The value number of every variable looked at; `ABSENT` for one that does not exist."""

_NOWHERE = Expression("", Truth(True, (0, 0)))
"""Failures in a cell are caught; the judge tells them where they stand."""


def holds_in(shape: Shape, formula: Formula, scope: Sequence[int]) -> Bools:
    """Where *formula* holds; one axis of length values + 1 for each variable of *scope*, which has all it looks at.

    Raises DseError where an atom does, as for a division by zero.
    """
    return np.broadcast_to(_holds(shape, formula, scope), [shape.widths[variable] for variable in scope]).copy()


def holds_in_cells(shape: Shape, atom: Atom) -> Bools:
    """Where *atom* holds; one axis for each variable of its scope. Raises DseError as `holds_in`."""
    evaluate = evaluator(_NOWHERE, atom.term, over_cells, lambda _: "")
    widths = [shape.widths[variable] for variable in atom.scope]
    found = np.zeros(widths, bool)
    for index in product(*(range(width) for width in widths)):
        values = (-1 if at == width - 1 else at for at, width in zip(index, widths, strict=True))
        value = evaluate(dict(zip(atom.scope, values, strict=True)))
        found[index] = (value is not None and bool(value) is atom.outcome) is not atom.denied
    return found


def over_cells(leaf: Leaf) -> Evaluate[Cell]:
    """How the value of *leaf* is read from a cell."""
    match leaf:
        case Standing(sites, named):
            name_at = _found([(site, site.name) for site in sites])
            return lambda cell: next(iter(name_at(cell)), None) in named
        case Stated(entries):
            stated = _found(entries)
            return lambda cell: next(iter(stated(cell)), None)
        case RollUp(function, entries):
            there = _found(entries)
            return lambda cell: _rolled_up(function, there(cell))
        case SameChoice(places):
            names = [_found([(site, site.name) for site in sites]) for sites in places]

            def same(cell: Cell) -> bool | None:
                found = [name for name_at in names for name in name_at(cell)]
                return None if len(found) < 2 else len(set(found)) == 1

            return same


def _holds(shape: Shape, formula: Formula, scope: Sequence[int]) -> Bools:
    match formula:
        case Literal():
            return _along(shape, formula.mask, [formula.variable], scope)
        case Total(weights, low, high):
            total = sum(_along(shape, values, [variable], scope) for variable, values in weights.items())
            holds = np.ones((1,) * len(scope), bool)
            if low is not None:
                holds = holds & (total >= low)
            return holds if high is None else holds & (total <= high)
        case Atom():
            return _along(shape, holds_in_cells(shape, formula), formula.scope, scope)
        case Junction():
            holds = np.full((1,) * len(scope), formula.every)
            for part in formula.parts:
                below = _holds(shape, part, scope)
                holds = holds & below if formula.every else holds | below
            return holds


def _along(shape: Shape, array: np.ndarray, own: Sequence[int], scope: Sequence[int]) -> np.ndarray:
    return array.reshape([shape.widths[variable] if variable in own else 1 for variable in scope])


def _found(entries: Sequence[tuple[Site, T]]) -> Callable[[Cell], list[T]]:
    always = [value for site, value in entries if site.branch is None]
    tables: dict[int, dict[int, list[T]]] = {}
    for site, value in entries:
        if site.branch:
            tables.setdefault(site.branch[0], {}).setdefault(site.branch[1], []).append(value)
    pairs = list(tables.items())

    def find(cell: Cell) -> list[T]:
        found = list(always)
        for variable, table in pairs:
            found += table.get(cell[variable], ())
        return found

    return find


def _rolled_up(function: str, values: Sequence[Fraction]) -> Value:
    match function:
        case "sum":
            return sum(values, Fraction(0))
        case "count":
            return Fraction(len(values))
        case "product":
            return math.prod(values, start=Fraction(1))
    if not values:
        return None
    match function:
        case "mean":
            return sum(values, Fraction(0)) / len(values)
        case "min":
            return min(values)
    return max(values)
