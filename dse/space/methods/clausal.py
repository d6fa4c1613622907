"""Answers about a space that is too wide for a decision diagram in every order, as large feature models are.

A decision-DNNF of all rules, where they have a small form in clauses; else one of the logical rules, from which rows
are drawn and kept if they meet the others; else a complete search, which may have to give up.

Example of the second way: 12 coins, of which at least 6 show heads. The logical rules leave 4,096 rows. Of 50,000 rows
drawn from them, about 61 % meet the sum, so the estimate is near the true 2,510. Rules that one row in 2,500 or fewer
meets are refused. Models of up to 2,513 features were measured: docs/decisions/0007-design-space-engine.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cached_property
from itertools import islice
from math import ceil, floor, sqrt

import numpy as np

from dse.errors import DseError, fail
from dse.space.flat import FlatSpace, Ints, Linear, Rows, Wide
from dse.space.methods import enumeration
from dse.space.methods.budget import TooMuchError
from dse.space.methods.dnnf import queries, rows as listing
from dse.space.methods.dnnf.compile import Dnnf, compile_dnnf
from dse.space.methods.dnnf.optimum import least
from dse.space.methods.dnnf.satisfiability import satisfiable
from dse.space.methods.dnnf.trim import UnsupportedError
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.listing.search import Effort, first as search_first, rows as search_rows
from dse.space.methods.mdd.growth import TooWideError
from dse.space.methods.sampling.estimate import Shares, exact_shares
from dse.space.methods.sampling.tilt import EmptyError
from dse.space.methods.tally import Tally

SEARCHED = 2_000_000
"""Values that a complete search tries before it gives up."""

SEARCH_WORK = 50_000_000
"""Variables of rules that a search looks at before it gives up, in all or, where rows are listed, since the last block.
"""

_BLOCK = 256
_DRAWS = 50_000
_MOST_DRAWS = 20 * _DRAWS
_LIKELY = 20
"""Draws for each wanted row that are never too many."""
_SEEN = 20
_NORMAL = 1.959963984540054


class ClausalEngine:
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
            return sum(1 for _ in search_rows(self.flat, SEARCHED, Effort(SEARCH_WORK)))
        except TooMuchError:
            return None

    def estimate(self, seed: int) -> Tally:
        """The rows that meet the logical rules, times the share of those that meet the others (Wilson's interval).

        Exactly none if nothing meets the logical ones. Raises DseError if that is too small to be seen.
        """
        if self._logical is None:
            raise self._gives_up("count")
        total = queries.count(self._logical)
        if not total:
            return Tally(0)
        seen = int(recheck(self.flat).valid(listing.sample(self._logical, _DRAWS, seed)).sum())
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
            return search_first(self.flat, SEARCHED, Effort(SEARCH_WORK))
        except TooMuchError as error:
            raise self._gives_up("find a configuration") from error

    def blocks(self) -> Iterator[Rows]:
        """Every valid row in blocks, in a stable order. Raises DseError if a search finds no more for too long."""
        if self.graph is None:
            effort = Effort(SEARCH_WORK)
            searched = search_rows(self.flat, effort=effort)
            try:
                while waiting := list(islice(searched, _BLOCK)):
                    yield np.array(waiting)
                    effort.left = SEARCH_WORK
            except TooMuchError as error:
                raise self._gives_up("list the configurations") from error
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
        kept = self._kept(number, seed)
        if kept is not None:
            return kept
        return enumeration.drawn(self._searched("draw configurations"), number, seed)

    def least(self, weights: Mapping[int, Ints], number: int) -> Rows:
        """The *number* rows of least sum of weights, ascending. Raises TooMuchError where rules fit into no graph."""
        try:
            return recheck(self.flat).insist(least(self.flat, weights, number))
        except (UnsupportedError, TooWideError) as error:
            raise TooMuchError from error

    def times_taken(self) -> Sequence[Sequence[int]] | None:
        """How many rows take each value of each variable, `ABSENT` last; None where there is no graph."""
        return None if self.graph is None else queries.occurrences(self.graph)

    def shares(self) -> Shares:
        """The share of valid rows that take each value, exactly. Raises EmptyError, DseError if it cannot be known."""
        if self.graph is None:
            return enumeration.shares(self.flat, self._searched("compute how often each alternative occurs"))
        total = queries.count(self.graph)
        if not total:
            raise EmptyError
        return exact_shares(queries.occurrences(self.graph), total)

    @cached_property
    def _logical(self) -> Dnnf | None:
        rules = tuple(rule for rule in self.flat.rules if not isinstance(rule, Linear | Wide))
        return _compiled(replace(self.flat, rules=rules))

    def _kept(self, number: int, seed: int) -> Rows | None:
        """*number* rows drawn under the logical rules that meet the others, too; None if those are too rare.

        The first rows are those of a smaller sample. Raises EmptyError if nothing meets the logical rules.
        """
        if self._logical is None:
            return None
        check = recheck(self.flat)
        kept: list[Rows] = []
        seen = drawn = 0
        for block in listing.drawn(self._logical, seed):
            kept.append(block[check.valid(block)])
            drawn, seen = drawn + len(block), seen + len(kept[-1])
            if seen >= number or (drawn >= _DRAWS and not seen) or drawn >= _MOST_DRAWS + _LIKELY * number:
                break
        if not drawn:
            raise EmptyError
        return np.concatenate(kept)[:number] if seen >= number else None

    def _searched(self, what: str) -> Rows:
        """All rows by complete search. Raises EmptyError, DseError that it cannot do *what* if there are too many."""
        try:
            rows = list(search_rows(self.flat, SEARCHED, Effort(SEARCH_WORK)))
        except TooMuchError as error:
            raise self._gives_up(what) from error
        if not rows:
            raise EmptyError
        return np.array(rows, np.int16)

    def _gives_up(self, what: str) -> DseError:
        hint = "no method fits its rules: fix some choices, or leave some constraints out"
        return fail(f"cannot {what} of '{self.flat.name}'", None, hint)


def _compiled(flat: FlatSpace) -> Dnnf | None:
    try:
        return compile_dnnf(flat)
    except (UnsupportedError, TooWideError):
        return None
