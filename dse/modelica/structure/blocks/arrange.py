"""Equations matched to unknowns, cut into blocks and put in order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Generic, TypeVar

from dse.errors import Location, raise_if_any
from dse.graphs import components
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import smooth, symbols
from dse.modelica.solved_model import Block, EventBlock, expressions, targets
from dse.modelica.structure.blocks.tearing import block
from dse.modelica.structure.known import Known
from dse.modelica.structure.rows import Row, matched

B_co = TypeVar("B_co", bound=EventBlock, covariant=True)
Quantity = Symbol | int
"""A symbol, or the number of a trigger."""


@dataclass(frozen=True, slots=True)
class Stage(Generic[B_co]):
    """One block with what it gives and what it needs. *text* names it."""

    block: B_co
    gives: tuple[Quantity, ...]
    needs: tuple[Quantity, ...]
    where: Location | None
    text: str


def arranged(rows: Sequence[Row], unknowns: Sequence[Symbol], known: Known) -> list[Stage[Block]]:
    """Blocks that compute *unknowns* from *rows*, each after those it needs.

    Raises DseError if there is no matching: *rows* do not determine *unknowns*.
    """
    number = {symbol: place for place, symbol in enumerate(unknowns)}
    solvable = [[number[symbol] for symbol in smooth(row.residual) if symbol in number] for row in rows]
    matching, problems = matched(rows, solvable, unknowns)
    raise_if_any(problems)
    occurs = [[number[symbol] for symbol in symbols(row.residual) if symbol in number] for row in rows]
    row_of = matching.row_of
    needs = [sorted(row_of[column] for column in occurs[row] if row_of[column] != row) for row in range(len(rows))]
    stages: list[Stage[Block]] = []
    for component in components(needs):
        own_rows = [rows[row] for row in component]
        own = [unknowns[matching.column_of[row]] for row in component]
        made = block(own_rows, own, known)
        gives = tuple(targets((made,)))
        own_gives = frozenset(gives)
        needed = tuple(symbol for symbol in symbols(*expressions(made, known.flat)) if symbol not in own_gives)
        where = next((row.where for row in own_rows if row.where is not None), None)
        stages.append(Stage(made, gives, needed, where, ", ".join(map(str, gives[:3]))))
    return stages
