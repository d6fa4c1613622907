"""Equations matched to unknowns, cut into blocks and put in order."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dse.errors import DseError, Problem
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import smooth, symbols
from dse.modelica.solved_model import Block, System, expressions, targets
from dse.modelica.structure.blocks.tearing import block
from dse.modelica.structure.graphs import Matching, components
from dse.modelica.structure.known import Known
from dse.modelica.structure.rows import Row, listed, told


@dataclass(frozen=True, slots=True)
class Stage:
    """One block with what it gives and what it needs, and the equations it stems from."""

    block: Block
    gives: tuple[Symbol, ...]
    needs: tuple[Symbol, ...]
    rows: tuple[Row, ...] = ()


def arranged(rows: Sequence[Row], unknowns: Sequence[Symbol], known: Known) -> list[Stage]:
    """Blocks that compute *unknowns* from *rows*, each after those it needs.

    Raises DseError if there is no matching: *rows* do not determine *unknowns*.
    """
    number = {symbol: place for place, symbol in enumerate(unknowns)}
    matching = matched(rows, unknowns)
    occurs = [[number[symbol] for symbol in symbols(row.residual) if symbol in number] for row in rows]
    row_of = matching.row_of
    needs = [sorted(row_of[column] for column in occurs[row] if row_of[column] != row) for row in range(len(rows))]
    stages = []
    for component in components(needs):
        own_rows = [rows[row] for row in component]
        own = [unknowns[matching.column_of[row]] for row in component]
        made = block(own_rows, own, known)
        gives = tuple(targets((made,)))
        own_gives = frozenset(gives)
        needed = tuple(symbol for symbol in symbols(*expressions(made, known.flat)) if symbol not in own_gives)
        stages.append(Stage(made, gives, needed, tuple(own_rows)))
    return stages


def matched(rows: Sequence[Row], unknowns: Sequence[Symbol]) -> Matching:
    """A complete matching of *rows* and *unknowns*; raises DseError, with places, if there is none."""
    number = {symbol: place for place, symbol in enumerate(unknowns)}
    columns = [[number[symbol] for symbol in smooth(row.residual) if symbol in number] for row in rows]
    matching = Matching()
    problems: list[Problem] = []
    for place, row in enumerate(rows):
        seen = matching.match(place, columns)
        if seen:
            others = sorted({column for one in seen for column in columns[one]})
            what = f"this equation is one too many for {listed(unknowns[column] for column in others)}"
            problems.extend(told([row], what if others else "this equation contains no unknown"))
    missing = [symbol for column, symbol in enumerate(unknowns) if column not in matching.row_of]
    if missing:
        problems.append(Problem(f"there are too few equations for {listed(missing)}"))
    if problems:
        raise DseError(*problems)
    return matching


def systems(stages: Sequence[Stage]) -> list[System]:
    """The blocks of *stages* that are to be solved together."""
    return [one.block for one in stages if isinstance(one.block, System)]
