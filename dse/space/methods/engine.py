"""Answers about a design space, each by the method that fits; what has to be compiled is compiled once, on first use.

Methods are tried in this order:

| method | rules | answers |
|---|---|---|
| decision diagram with the sums compiled in (`mdd.expand`) | all, if few partial sums occur | all, exactly |
| grids of sums over the diagram (`grid`) | sums | the exact count |
| tilted sampling over the diagram (`sampling`) | all | samples; counts and shares as estimates with an interval |
| bounds and a search over the diagram (`listing`, `optimum`) | all | lists, the first row, the best rows |
| decision-DNNF (`dnnf`), where every order makes the diagram too wide | clauses, tables, small counts | all, exactly |
| CP-SAT (`solver`), if that is too large too, or a search over a diagram late | all | rows, best rows, conflicts |
| thinned populations (`sampling.population`), if there is no diagram and no DNNF | all | estimates, draws |

Each module works an example by hand, as x in {1, 2, 4}, y in {0, 3}, x + y <= 4: 4 rows. A method is imported where it
is used: together they take longer to import than most spaces to count. They were raced: none could be left out
(docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from dse.domain.design import DesignSpace
from dse.errors import DseError, fail
from dse.space.flat import FlatSpace, Ints, Rows, Rule, Table
from dse.space.lowering import flatten
from dse.space.lowering.cliques import with_cliques
from dse.space.methods.budget import TooMuchError
from dse.space.methods.mdd.diagram import DecisionDiagram, count, occurrences, restrict
from dse.space.methods.tally import Tally

if TYPE_CHECKING:
    from dse.space.methods.clausal import ClausalEngine
    from dse.space.methods.optimum.pareto import ParetoFront
    from dse.space.methods.sampling.estimate import Shares
    from dse.space.methods.solver.model import Tell

DIAGRAM = 200_000
"""Nodes a diagram may have before reduction; beyond, the decision-DNNF takes over."""

EXPANSION = 150_000
"""Nodes before reduction of a diagram with the sums compiled in."""

EVERYDAY_WORK = 5e9
"""Additions of a cell that an everyday exact count may take: a few seconds."""

MOST_WORK = 1e12
"""The same where an exact count is insisted on: many minutes."""

LATE = 300
"""Pieces of work, some milliseconds each, after which a search over the diagram is left to the solver."""


class Engine:
    """Answers about *flat*. They do not depend on what was asked before.

    *model* is the engine of another space over much the same variables: no diagram is tried where none fitted there.
    *diagram* and *expanded* are known where they are those of another engine, restricted.
    """

    def __init__(
        self,
        flat: FlatSpace,
        model: Engine | None = None,
        diagram: DecisionDiagram | None = None,
        expanded: DecisionDiagram | None = None,
    ) -> None:
        self.flat = flat
        self._model = model
        self._diagram = diagram
        self._expanded = expanded
        self._is_too_wide = False

    @classmethod
    def of(cls, space: DesignSpace) -> Engine:
        """The engine of a design space. Raises DseError if a constraint cannot be understood."""
        return cls(flatten(space))

    def only(self, owners: Collection[int]) -> Engine:
        """The engine of the same space under these constraints alone."""
        return Engine(self.flat.only(owners), self)

    def having(self, *rules: Rule) -> Engine:
        """The engine of the same space under further rules."""
        flat = self.flat.having(*rules)
        masks = {rule.scope[0]: rule.allowed for rule in rules if isinstance(rule, Table) and len(rule.scope) == 1}
        if len(masks) < len(rules) or self.diagram is None:
            return Engine(flat, self)
        diagram, expanded = (
            known and replace(restrict(known, masks), flat=known.flat.having(*rules))
            for known in (self.diagram, self._expanded)
        )
        return Engine(flat, self, diagram, expanded)

    @cached_property
    def _merged(self) -> FlatSpace:
        """As what the diagram is compiled."""
        return with_cliques(self.flat)

    @cached_property
    def diagram(self) -> DecisionDiagram | None:
        """The decision diagram of hierarchy and rules, sums aside; None where it is too wide in every order."""
        if self._diagram is not None:
            return self._diagram
        from dse.space.methods.mdd.growth import TooWideError
        from dse.space.methods.mdd.ordering import compile_best

        if self._model is not None and self._model.diagram is None and self._model.clausal.graph is not None:
            return None
        try:
            return compile_best(self._merged, DIAGRAM)
        except TooWideError:
            return None

    @property
    def expanded(self) -> DecisionDiagram | None:
        """The diagram of exactly the valid rows; None where it is too wide."""
        if self._expanded is None and self.diagram is not None and not self._is_too_wide:
            from dse.space.methods.mdd.expand import expand
            from dse.space.methods.mdd.growth import TooWideError

            try:
                self._expanded = expand(self.diagram, EXPANSION)
            except TooWideError:
                self._is_too_wide = True
        return self._expanded

    @property
    def late(self) -> int | None:
        """`LATE` where the solver is installed; else None, and a search goes on."""
        from importlib.util import find_spec

        return LATE if find_spec("ortools") else None

    @cached_property
    def clausal(self) -> ClausalEngine:
        """What answers where there is no diagram."""
        from dse.space.methods.clausal import ClausalEngine

        return ClausalEngine(self.flat)

    def is_structural(self) -> bool:
        """Whether all rules are logical, without sums and the like."""
        return not (self._merged.linears() or self._merged.wides())

    def count(self, seed: int = 0, *, relative: float | None = None) -> Tally:
        """How many rows are valid: exact if that takes no more than everyday work, else by `estimate`.

        Raises DseError if neither can be had.
        """
        exact = self.exact_count()
        return self.estimate(seed, relative) if exact is None else Tally(exact)

    def estimate(self, seed: int, relative: float | None = None, size: int | None = None) -> Tally:
        """About how many rows are valid, where it takes too long to count them.

        *relative*, unless it is given, and *size* are as in `sampling.estimate`. Raises DseError if it cannot be had.
        """
        if self.diagram is None:
            return self.clausal.estimate(seed)
        from dse.space.methods import enumeration
        from dse.space.methods.sampling.estimate import RELATIVE_HALF_WIDTH, estimate
        from dse.space.methods.sampling.tilt import TooRareError

        try:
            return estimate(self.diagram, seed, RELATIVE_HALF_WIDTH if relative is None else relative, size=size)
        except TooRareError as error:
            found = enumeration.count(self.flat, self.blocks())
            if found is None:
                hint = "what is valid is too rare to be drawn and too much to be listed; try --exact"
                raise fail(f"the configurations of '{self.flat.name}' cannot be estimated", None, hint) from error
            return Tally(found)

    def exact_count(self, most_work: float = EVERYDAY_WORK) -> int | None:
        """How many rows are valid; None if that would take more than *most_work* additions."""
        if self.diagram is None:
            return self.clausal.exact_count()
        if self.is_structural():
            return count(self.diagram)
        if self._expanded is None and not self._is_too_wide and self._is_hopeless:
            return 0
        if self.expanded is not None:
            return count(self.expanded)
        from dse.space.methods.grid.exact import exact_count

        try:
            return exact_count(self.diagram, most_work=most_work)
        except TooMuchError:
            return None

    def exactly(self) -> int:
        """How many rows are valid, however long that takes. Raises DseError where it cannot be known."""
        found = self.exact_count(MOST_WORK)
        if found is None and self.diagram is not None:
            from dse.space.methods import enumeration

            found = enumeration.count(self.flat, self.blocks())
        if found is None:
            hint = "ask for an estimate: the same without --exact"
            raise fail(f"the configurations of '{self.flat.name}' are too many to be counted exactly", None, hint)
        return found

    def is_empty(self) -> bool:
        """Whether no row is valid. Raises DseError if a complete search has to give up."""
        return self.first() is None

    def first(self) -> Rows | None:
        """The first valid row in the engine's order, shape (variables,), or None. Raises like `is_empty`."""
        return self._first[0]

    @property
    def is_solved(self) -> bool:
        """Whether the first row, or that there is none, had to be found by the solver. Raises like `is_empty`."""
        return self._first[1]

    @cached_property
    def _first(self) -> tuple[Rows | None, bool]:
        from dse.space.methods.listing.blocks import MOST_ROUNDS, first

        try:
            if self.diagram is None:
                return self.clausal.first(), self.clausal.is_solved
            try:
                return first(self.diagram, self.late or MOST_ROUNDS), False
            except TooMuchError:
                from dse.space.methods.solver import answers

                return answers.first(self.flat), True
        except TooMuchError as error:
            raise self._undecided() from error

    def blocks(self, limit: int | None = None) -> Iterator[Rows]:
        """The first *limit* valid rows, in blocks of shape (rows, variables), in a stable order.

        It is that of the file, the last decision the fastest, unless the diagram of the space only fits in another.
        """
        from dse.space.methods.listing.blocks import blocks

        missing = limit
        for rows in self.clausal.blocks() if self.diagram is None else blocks(self.diagram):
            yield rows if missing is None else rows[:missing]
            if missing is not None:
                missing -= len(rows)
                if missing <= 0:
                    return

    def rows(self, limit: int | None = None) -> Rows:
        """The rows of `blocks` together."""
        return np.concatenate([np.zeros((0, len(self.flat.variables)), np.int16), *self.blocks(limit)])

    def sample(self, number: int, seed: int = 0) -> Rows:
        """*number* rows drawn uniformly among the valid ones, independently; nearly so where only populations are left.

        Raises DseError if there is none.
        """
        from dse.space.methods import enumeration
        from dse.space.methods.sampling.sample import sample
        from dse.space.methods.sampling.tilt import EmptyError, TooRareError

        try:
            if self.diagram is None:
                return self.clausal.sample(number, seed)
            try:
                return sample(self.expanded or self.diagram, number, seed)
            except TooRareError:
                return enumeration.drawn(enumeration.every(self.flat, self.rows), number, seed)
        except EmptyError as error:
            raise self.nothing() from error

    def least(self, weights: Mapping[int, Ints], number: int, tell: Tell | None = None) -> Rows:
        """The *number* valid rows of least sum of weights[variable][value]; of equal ones those that are listed first.

        Where the solver finds them, it is always the same ones of those that are equal, and *tell* hears how far it is.
        Raises TooMuchError if it gives up.
        """
        if self.diagram is None:
            return self.clausal.least(weights, number, tell)
        from dse.space.methods.listing.walk import Rounds
        from dse.space.methods.optimum.optimizer import best

        try:
            return best(self.diagram, weights, number, rounds=None if self.late is None else Rounds(self.late)).rows
        except TooMuchError:
            from dse.space.methods.solver import answers

            return answers.least(self.flat, weights, number, tell)

    def pareto(self, objectives: Sequence[Mapping[int, Ints]], largest: Sequence[bool]) -> ParetoFront:
        """The complete Pareto set over sums, see `optimum.pareto`. Raises TooMuchError if it takes too long."""
        from functools import partial

        from dse.space.methods.listing.walk import Rounds
        from dse.space.methods.optimum.optimizer import Optimizer
        from dse.space.methods.optimum.pareto import MOST_PARETO_ROUNDS, pareto
        from dse.space.methods.solver.answers import SolverOptimizer

        if self.diagram is not None:
            rounds = Rounds(self.late or MOST_PARETO_ROUNDS)
            try:
                return pareto(partial(Optimizer, self.diagram, rounds=rounds), objectives, largest)
            except TooMuchError:
                if self.late is None:
                    raise
        return pareto(partial(SolverOptimizer, self.flat), objectives, largest)

    def shares(self, seed: int = 0) -> Shares:
        """The share of valid rows that take each value; half-widths are 0 where that is exact.

        Raises DseError if there is no valid row.
        """
        from dse.space.methods import enumeration
        from dse.space.methods.sampling.estimate import estimate_occurrences
        from dse.space.methods.sampling.tilt import EmptyError, TooRareError

        try:
            if self.diagram is None:
                return self.clausal.shares(seed)
            try:
                return estimate_occurrences(self.expanded or self.diagram, seed)
            except TooRareError:
                return enumeration.shares(self.flat, enumeration.every(self.flat, self.rows))
        except EmptyError as error:
            raise self.nothing() from error

    def times_taken(self) -> Sequence[Sequence[int]] | None:
        """How many valid rows take each value of each variable, `ABSENT` last; None where that cannot be known."""
        if self.diagram is None:
            return self.clausal.times_taken()
        return None if self.expanded is None else occurrences(self.expanded)

    def nothing(self) -> DseError:
        """The problem that no row is valid."""
        hint = f"ask which constraints conflict: dse space conflict {self.flat.name}"
        return fail(f"'{self.flat.name}' has no valid configuration", None, hint)

    @cached_property
    def _is_hopeless(self) -> bool:
        """Whether a bound proves that no row is valid, before anything is spent on it."""
        if self.diagram is None:
            return False
        from dse.space.methods.sampling.tilt import EmptyError, tilt

        try:
            tilt(self.diagram)
        except EmptyError:
            return True
        return False

    def _undecided(self) -> DseError:
        hint = "fix some of the choices"
        return fail(f"whether '{self.flat.name}' has a valid configuration takes too long to find out", None, hint)
