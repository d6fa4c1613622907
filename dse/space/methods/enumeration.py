"""Answers from a list of every valid row."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from dse.errors import fail
from dse.space.flat import FlatSpace, Rows
from dse.space.methods.sampling.estimate import Shares, exact_shares, taken
from dse.space.methods.sampling.tilt import EmptyError
from dse.space.methods.sampling.uniform import generator

LISTED = 20_000_000
"""Rows that are listed for a count where nothing else helps."""

_LISTED_CELLS = 1_200_000_000
"""The same in decisions of all rows together."""

_KEPT_CELLS = 200_000_000
"""Decisions of all rows together that are kept in memory, to draw from them."""


def count(flat: FlatSpace, blocks: Iterable[Rows]) -> int | None:
    """How many rows *blocks* have; None if there are more than `LISTED`, or fewer in a space of many decisions."""
    most = min(LISTED, _LISTED_CELLS // max(1, len(flat.variables)))
    number = 0
    for block in blocks:
        number += len(block)
        if number > most:
            return None
    return number


def every(flat: FlatSpace, first_rows: Callable[[int], Rows]) -> Rows:
    """All rows of a space whose valid rows are so rare that drawing does not find them.

    Raises EmptyError if there is none, DseError if there are too many.
    """
    most = min(LISTED, _KEPT_CELLS // max(1, len(flat.variables)))
    rows = first_rows(most + 1)
    if not len(rows):
        raise EmptyError
    if len(rows) > most:
        hint = "fix some of the choices"
        raise fail(f"the valid configurations of '{flat.name}' are too rare to be drawn", None, hint)
    return rows


def drawn(every: Rows, number: int, seed: int) -> Rows:
    """*number* of the rows, independently, each as likely as any other."""
    rows: Rows = every[generator(seed).integers(len(every), size=number)]
    return rows


def shares(flat: FlatSpace, every: Rows) -> Shares:
    """The share of the rows that take each value."""
    return exact_shares([times.tolist() for times in taken(flat, every)], len(every))
