"""Answers from a list of every valid row."""

from __future__ import annotations

from dse.space.flat import FlatSpace, Rows
from dse.space.sampling.estimate import Shares, exact_shares, taken
from dse.space.sampling.uniform import generator


def drawn(every: Rows, number: int, seed: int) -> Rows:
    """*number* of the rows, independently, each as likely as any other."""
    rows: Rows = every[generator(seed).integers(len(every), size=number)]
    return rows


def shares(flat: FlatSpace, every: Rows) -> Shares:
    """The share of the rows that take each value."""
    return exact_shares([times.tolist() for times in taken(flat, every)], len(every))
