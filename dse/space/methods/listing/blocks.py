"""Every valid row of a diagram, lazily and in a stable order, and the first of them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from dse.space.flat import FlatSpace, Linear, Rows, Rule, Wide
from dse.space.methods.listing.bounds import Cut, cuts_of, fits, least, overall, stacked, surrogates, tightest
from dse.space.methods.listing.recheck import Recheck, recheck
from dse.space.methods.listing.walk import BLOCK_ROWS, DiagramWalk, Rounds
from dse.space.methods.mdd.diagram import DecisionDiagram
from dse.space.methods.mdd.folds import is_bounded

MOST_ROUNDS = 20_000
"""Pieces of work, some minutes, after which `first` gives up unless told otherwise."""


class RowListing:
    """All valid rows of a diagram, within further *wides*: iterate for blocks of rows.

    *cuts*, if given, are to prune by: those of the space and further ones. The bounds of the first *movable* of them
    may be tightened on the way, as `DiagramWalk` describes it.
    """

    def __init__(
        self,
        diagram: DecisionDiagram,
        cuts: Sequence[Cut] | None = None,
        wides: Sequence[Wide] = (),
        block: int = BLOCK_ROWS,
        movable: int = 0,
        rounds: Rounds | None = None,
    ) -> None:
        early, late = _parted(diagram, wides)
        if cuts is None:
            cuts = tightest(cuts_of([rule for rule in early if isinstance(rule, Linear)]))
            cuts += surrogates(diagram.flat, cuts)
        prunable = [rule for rule in early if isinstance(rule, Wide)]
        self.walk = DiagramWalk(diagram, cuts, prunable, block, frozenset(range(movable)), rounds)
        flat = diagram.flat
        self._late = recheck(FlatSpace(flat.name, flat.variables, flat.constraints, tuple(late))) if late else None
        self._recheck: Recheck = recheck(flat)

    def __iter__(self) -> Iterator[Rows]:
        for rows in self.walk:
            kept = rows if self._late is None else rows[self._late.valid(rows)]
            if len(kept):
                yield self._recheck.insist(kept)


def blocks(diagram: DecisionDiagram, block: int = BLOCK_ROWS) -> Iterator[Rows]:
    """Every valid row, all rules, in lexicographic order of value numbers along the diagram's order.

    Yields arrays of 1 to *block* rows, shape (rows, variables); the first ones are small. Memory does not grow
    with what was listed. Every row was checked again against the rules themselves; RuntimeError if one failed.
    """
    return iter(RowListing(diagram, block=block))


def first(diagram: DecisionDiagram, most_rounds: int | None = MOST_ROUNDS) -> Rows | None:
    """The first valid row of the list, shape (variables,); None if there is none, which is then proven.

    Raises TooMuchError after *most_rounds* pieces of work of `DiagramWalk`, None for no limit.
    """
    if cannot_be(diagram):
        return None
    found = next(iter(RowListing(diagram, rounds=None if most_rounds is None else Rounds(most_rounds))), None)
    if found is None:
        return None
    row: Rows = found[0]
    return row


def cannot_be(diagram: DecisionDiagram) -> bool:
    """Whether a cut, or the one combination of all, is out of reach of every path."""
    if diagram.empty:
        return True
    if diagram.expanded:
        return False
    cuts = tightest(cuts_of([linear for linear in diagram.flat.linears() if fits(linear)]))
    cuts += overall(diagram.flat, cuts)
    low = least(diagram, stacked(diagram, [cut.weights for cut in cuts]), len(cuts))[0]
    return any(int(reached[0]) > cut.high for reached, cut in zip(low, cuts, strict=False))


def _parted(diagram: DecisionDiagram, wides: Sequence[Wide]) -> tuple[list[Rule], list[Rule]]:
    """The rules that are not in the layers: those a walk can prune by, and those too large, for complete rows."""
    early: list[Rule] = []
    late: list[Rule] = []
    outside: tuple[Linear | Wide, ...] = () if diagram.expanded else (*diagram.flat.linears(), *diagram.flat.wides())
    for rule in (*outside, *wides):
        known = fits(rule) if isinstance(rule, Linear) else is_bounded(rule)
        (early if known else late).append(rule)
    return early, late
