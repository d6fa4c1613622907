"""Answers about a space that is too wide for a decision diagram in every order, as large feature models are.

A decision-DNNF of all rules, where they have a small form in clauses, answers everything. Else OR-tools CP-SAT finds
and proves rows (`solver`), and populations of rows estimate and draw (`sampling.population`). Models of up to 2,513
features were measured: docs/decisions/0007-design-space-engine.md; spaces with sums: 0045-second-engine.md.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property

from dse.errors import DseError, fail
from dse.space.flat import FlatSpace, Ints, Rows
from dse.space.methods import enumeration
from dse.space.methods.budget import TooMuchError
from dse.space.methods.dnnf import queries, rows as listing
from dse.space.methods.dnnf.compile import MOST_COMPONENTS, Dnnf, compile_dnnf
from dse.space.methods.dnnf.optimum import least
from dse.space.methods.dnnf.trim import UnsupportedError
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.mdd.growth import TooWideError
from dse.space.methods.sampling import population
from dse.space.methods.sampling.estimate import Shares, estimated_shares, exact_shares, taken
from dse.space.methods.sampling.tilt import EmptyError, TooRareError
from dse.space.methods.solver import answers, model
from dse.space.methods.tally import Tally

_COMPONENTS = 3_000
"""Components of a graph, half a second of work, beyond which the solver is faster."""

_FEW = 2_000
"""Rows that are listed for exact answers."""

_DRAWS = 20_000
"""Rows drawn to estimate shares."""


class ClausalEngine:
    """Answers about *flat* without a diagram. Rows are rechecked against the rules before anyone sees them."""

    def __init__(self, flat: FlatSpace) -> None:
        self.flat = flat

    @cached_property
    def graph(self) -> Dnnf | None:
        """The decision-DNNF of all rules; None where one does not fit into it, or it is too large too."""
        try:
            return compile_dnnf(self.flat)
        except (UnsupportedError, TooWideError):
            return None

    @cached_property
    def _few(self) -> Rows | None:
        """Every row, where the solver finds soon that they are at most `_FEW`; else None."""
        if not model.is_installed():
            return None
        try:
            rows, is_complete = model.SolverModel(self.flat).rows(_FEW + 1, model.Budget(time=1.0))
        except TooMuchError:
            return None
        return rows if is_complete and len(rows) <= _FEW else None

    @property
    def is_exact(self) -> bool:
        """Whether counts, shares and draws are exact: by the graph, or because the rows are few."""
        return self.graph is not None or self._few is not None

    def exact_count(self) -> int | None:
        """How many rows are valid; None if that cannot be known."""
        if self.graph is not None:
            return queries.count(self.graph)
        return None if self._few is None else len(self._few)

    def estimate(self, seed: int) -> Tally:
        """About how many rows are valid; exact where they are few. Raises DseError if they are too rare to be seen."""
        try:
            return population.estimate(self.flat, seed)
        except TooRareError as error:
            if self._few is not None:
                return Tally(len(self._few))
            raise self._gives_up("count the configurations") from error

    @property
    def is_solved(self) -> bool:
        """Whether the solver finds rows."""
        return model.is_installed() or self.graph is None

    def first(self) -> Rows | None:
        """A valid row, always the same, or None. Raises TooMuchError if the solver has to give up, and DseError."""
        if self.is_solved:
            return answers.first(self.flat)
        found: Rows | None = next((block[0] for block in self.blocks()), None)
        return found

    def blocks(self) -> Iterator[Rows]:
        """Every valid row in blocks, in a stable order. Raises DseError if the solver finds no more for too long."""
        if self.graph is None:
            try:
                yield from answers.blocks(self.flat)
            except TooMuchError as error:
                raise self._gives_up("list the configurations") from error
            return
        check = recheck(self.flat)
        for block in listing.rows(self.graph):
            yield check.insist(block)

    def sample(self, number: int, seed: int) -> Rows:
        """*number* rows: uniform ones of the graph, else nearly uniform ones of populations.

        Raises EmptyError if there is none, DseError if they are too rare to be drawn.
        """
        if self.graph is None:
            if self._few is not None:
                return enumeration.drawn(_some(self._few), number, seed)
            try:
                return recheck(self.flat).insist(population.drawn(self.flat, number, seed))
            except TooRareError as error:
                raise self._gives_up("draw configurations") from error
        drawn = listing.sample(self.graph, number, seed)
        if not len(drawn):
            raise EmptyError
        return recheck(self.flat).insist(drawn)

    def least(self, weights: Mapping[int, Ints], number: int, tell: model.Tell | None = None) -> Rows:
        """The *number* rows of least sum of weights, ascending. Raises TooMuchError if the solver has to give up."""
        try:
            most = _COMPONENTS if model.is_installed() else MOST_COMPONENTS
            return recheck(self.flat).insist(least(self.flat, weights, number, most))
        except (UnsupportedError, TooWideError):
            return answers.least(self.flat, weights, number, tell)

    def times_taken(self) -> Sequence[Sequence[int]] | None:
        """How many rows take each value of each variable, `ABSENT` last; None where that cannot be known."""
        if self.graph is not None:
            return queries.occurrences(self.graph)
        return None if self._few is None else [times.tolist() for times in taken(self.flat, self._few)]

    def shares(self, seed: int) -> Shares:
        """The share of valid rows that take each value, estimated from draws where it is not known exactly.

        Raises EmptyError, DseError if it cannot be had.
        """
        times, total = self.times_taken(), self.exact_count()
        if times is None or total is None:
            return estimated_shares(self.flat, self.sample(_DRAWS, seed))
        if not total:
            raise EmptyError
        return exact_shares(times, total)

    def _gives_up(self, what: str) -> DseError:
        hint = "no method fits its rules: fix some choices, or leave some constraints out"
        return fail(f"cannot {what} of '{self.flat.name}'", None, hint)


def _some(rows: Rows) -> Rows:
    if not len(rows):
        raise EmptyError
    return rows
