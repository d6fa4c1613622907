"""Formulas over literals as clauses."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import product

import numpy as np

from dse.space.flat import Bools
from dse.space.lowering.cells import holds_in_cells
from dse.space.lowering.formulas import Atom, Formula, FormulaJunction, Literal
from dse.space.lowering.shape import SpaceShape

Disjunct = dict[int, Bools]
"""A clause: the mask of what each variable may take; one of them must hold."""

MOST_CLAUSES = 2048
MOST_LITERALS = 65_536
_MOST_CELLS = 256


def clauses(shape: SpaceShape, formula: Formula) -> list[Disjunct] | None:
    """Clauses that hold together exactly where *formula* does; None if it has sums, or they would be too many."""
    match formula:
        case Literal():
            return [{formula.variable: formula.mask}]
        case Atom():
            return _of_cells(shape, formula)
        case FormulaJunction():
            return _conjunction(shape, formula.parts) if formula.every else _disjunction(shape, formula.parts)
    return None


def _conjunction(shape: SpaceShape, parts: Iterable[Formula]) -> list[Disjunct] | None:
    found: list[Disjunct] = []
    for part in parts:
        below = clauses(shape, part)
        if below is None:
            return None
        found += below
        if _too_many(found):
            return None
    return found


def _disjunction(shape: SpaceShape, parts: Iterable[Formula]) -> list[Disjunct] | None:
    found: list[Disjunct] = [{}]
    for part in parts:
        below = clauses(shape, part)
        if below is None or len(found) * len(below) > MOST_CLAUSES:
            return None
        found = [one for one in _joined(shape, found, below) if one is not None]
        if _too_many(found):
            return None
    return found


def _joined(shape: SpaceShape, left: list[Disjunct], right: list[Disjunct]) -> Iterator[Disjunct | None]:
    for one, other in product(left, right):
        joined = dict(one)
        for variable, mask in other.items():
            joined[variable] = joined[variable] | mask if variable in joined else mask
        # A clause that always holds is none.
        yield None if any(_is_certain(shape, variable, mask) for variable, mask in joined.items()) else joined


def _is_certain(shape: SpaceShape, variable: int, mask: Bools) -> bool:
    return bool(mask[:-1].all()) and (bool(mask[-1]) or shape.is_root(variable))


def _of_cells(shape: SpaceShape, atom: Atom) -> list[Disjunct] | None:
    """For each combination of all variables but the widest: one of them differs, or the widest takes what is left."""
    if not shape.cells(atom.scope, _MOST_CELLS):
        return None
    holds = holds_in_cells(shape, atom)
    widest = int(np.argmax(holds.shape))
    others = [variable for axis, variable in enumerate(atom.scope) if axis != widest]
    holds = np.moveaxis(holds, widest, -1)
    found: list[Disjunct] = []
    for index in product(*(range(width) for width in holds.shape[:-1])):
        left = holds[index]
        if left.all() or any(
            at == shape.widths[variable] - 1 and shape.is_root(variable)
            for at, variable in zip(index, others, strict=True)
        ):
            continue
        clause: Disjunct = {atom.scope[widest]: left.copy()}
        for at, variable in zip(index, others, strict=True):
            differs = np.ones(shape.widths[variable], bool)
            differs[at] = False
            clause[variable] = differs
        found.append(clause)
    return None if _too_many(found) else found


def _too_many(found: list[Disjunct]) -> bool:
    return len(found) > MOST_CLAUSES or sum(map(len, found)) > MOST_LITERALS
