"""Equations on their way through the structure room."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from dse.errors import Location, Problem, some_of
from dse.modelica.algebra.expression import Expression, shown
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.structure.graphs import Matching


@dataclass(frozen=True, slots=True)
class Row:
    """``residual = 0``; *where* is the equation it stems from, *order* how often it was differentiated."""

    residual: Expression
    where: Location | None = None
    order: int = 0

    def __str__(self) -> str:
        times = f" (differentiated {self.order} times)" if self.order > 1 else " (differentiated)" if self.order else ""
        own = self.residual
        sides = map(shown, own.operands) if own.operator == "subtract" else (shown(own), "0")
        return f"{' = '.join(sides)}{times}"


def told(rows: Iterable[Row], what: str) -> list[Problem]:
    """One problem for each of *rows*, at its place; not more than a screen holds."""
    return [Problem(f"{what}: {row}", row.where) for row in list(rows)[:12]]


def listed(symbols: Iterable[Symbol]) -> str:
    """Names for a message; not more than a line holds."""
    return some_of([str(symbol) for symbol in symbols], 8)


def matched(
    rows: Sequence[Row], columns: Sequence[Sequence[int]], unknowns: Sequence[Symbol]
) -> tuple[Matching, list[Problem]]:
    """A matching of *rows* with the *columns* of *unknowns* they can be solved for, and the rows that are too many."""
    matching = Matching()
    problems: list[Problem] = []
    for place, row in enumerate(rows):
        seen = matching.match(place, columns)
        if seen:
            others = sorted({column for one in seen for column in columns[one]})
            what = f"this equation is one too many for {listed(unknowns[column] for column in others)}"
            problems.extend(told([row], what if others else "this equation contains no unknown"))
    return matching, problems
