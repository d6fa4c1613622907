"""Answers about a space too entangled for a decision diagram, as large feature models are.

A decision-DNNF of all rules, where they have a small form in clauses; else one of the logical rules, from which rows
are drawn and kept if they meet the others; else complete search, which may have to give up.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from math import ceil, floor, sqrt

import numpy as np

from dse.errors import DseError, fail
from dse.space.budget import TooMuchError
from dse.space.dnnf import queries
from dse.space.dnnf import rows as listing
from dse.space.dnnf.compile import Dnnf, compile_dnnf
from dse.space.dnnf.satisfy import satisfiable
from dse.space.dnnf.trim import UnsupportedError
from dse.space.estimate import Shares
from dse.space.flat import FlatSpace, Linear, Rows, Wide
from dse.space.growth import TooWideError
from dse.space.recheck import recheck
from dse.space.search import first as search_first
from dse.space.search import rows as search_rows
from dse.space.tally import Tally
from dse.space.tilt import EmptyError

SEARCHED = 2_000_000
"""Values that a complete search tries before it gives up."""

_DRAWS = 50_000
_SEEN = 20
_NORMAL = 1.959963984540054


class Entangled:
    """Answers about *flat* without a diagram. Rows are rechecked against the rules before anyone sees them."""

    def __init__(self, flat: FlatSpace) -> None:
        self.flat = flat

    @cached_property
    def graph(self) -> Dnnf | None:
        """The decision-DNNF of all rules; None where one does not fit into it, or it is too large too."""
        return _compiled(self.flat)

    def exact_count(self) -> int | None:
        """How many rows are valid; None if that cannot be known."""
        if self.graph is not None:
            return queries.count(self.graph)
        try:
            return sum(map(len, search_rows(self.flat, SEARCHED)))
        except TooMuchError:
            return None

    def estimate(self, seed: int) -> Tally:
        """The rows that meet the logical rules, times the share of those that meet the others (Wilson's interval).

        Raises DseError if that is too small to be seen.
        """
        total = queries.count(self._logical) if self._logical is not None else 0
        if self._logical is None:
            raise self._gives_up("count")
        seen = int(recheck(self.flat).valid(listing.sample(self._logical, _DRAWS, seed)).sum()) if total else 0
        if seen < _SEEN:
            raise self._gives_up("count")
        share, square = seen / _DRAWS, _NORMAL**2 / _DRAWS
        middle = (share + square / 2) / (1 + square)
        half = sqrt(share * (1 - share) * square + square**2 / 4) / (1 + square)
        low, high = (total * Fraction(end) for end in (middle - half, middle + half))
        return Tally(total * seen // _DRAWS, False, floor(low), min(ceil(high), total))

    def first(self) -> Rows | None:
        """A valid row, always the same, or None. Raises DseError if a complete search has to give up."""
        try:
            found = satisfiable(self.flat)
        except UnsupportedError:
            pass
        else:
            return None if found is None else recheck(self.flat).insist(found[None, :])[0]
        try:
            return search_first(self.flat, SEARCHED)
        except TooMuchError as error:
            raise self._gives_up("find a configuration") from error

    def blocks(self) -> Iterator[Rows]:
        """Every valid row in blocks, in a stable order."""
        if self.graph is None:
            yield from search_rows(self.flat)
            return
        check = recheck(self.flat)
        for block in listing.rows(self.graph):
            yield check.insist(block)

    def sample(self, number: int, seed: int) -> Rows:
        """*number* uniform rows. Raises EmptyError if there is none, DseError if they are too rare to be drawn."""
        if self.graph is not None:
            drawn = listing.sample(self.graph, number, seed)
            if not len(drawn):
                raise EmptyError
            return recheck(self.flat).insist(drawn)
        if self._logical is None:
            raise self._gives_up("draw configurations")
        drawn = listing.sample(self._logical, max(_DRAWS, 20 * number), seed)
        kept = drawn[recheck(self.flat).valid(drawn)]
        if len(kept) < number:
            raise self._gives_up("draw configurations")
        return kept[:number]

    def shares(self) -> Shares:
        """The share of valid rows that take each value. Raises EmptyError, and DseError without a graph."""
        if self.graph is None:
            raise self._gives_up("tell how often each alternative occurs")
        total = queries.count(self.graph)
        if not total:
            raise EmptyError
        times = queries.occurrences(self.graph)
        exact = [np.array([float(Fraction(number, total)) for number in found]) for found in times]
        return Shares(tuple(exact), tuple(np.zeros_like(share) for share in exact))

    @cached_property
    def _logical(self) -> Dnnf | None:
        rules = tuple(rule for rule in self.flat.rules if not isinstance(rule, Linear | Wide))
        return _compiled(replace(self.flat, rules=rules))

    def _gives_up(self, what: str) -> DseError:
        hint = "its rules are too entangled for every method; fix some choices, or leave some constraints out"
        return fail(f"cannot {what} of '{self.flat.name}'", None, hint)


def _compiled(flat: FlatSpace) -> Dnnf | None:
    try:
        return compile_dnnf(flat)
    except (UnsupportedError, TooWideError):
        return None
