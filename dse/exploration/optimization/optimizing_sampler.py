"""Searches for the best designs: the loop that all of them share, whatever it is that proposes designs."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from importlib.util import find_spec
from typing import Any, ClassVar, Protocol

from pydantic import Field

from dse.domain.sampler import Brief, Candidate, Grid, Outcomes, Placing, Search
from dse.errors import fail
from dse.exploration.one_shot_sampler import MOST_RUNS
from dse.exploration.optimization.designs import Cases, Design
from dse.exploration.optimization.fitness import Judge, Worth, lost
from dse.loading import SamplerSection


class Proposer(Protocol):
    """Proposes designs, and learns how good they are. The same judgements must lead to the same designs."""

    def next(self) -> Sequence[Design]:
        """The designs to be judged next, each for the first time; none if it has no more."""

    def tell(self, worth: Worth) -> None:
        """How good they are, in their order."""


class OptimizingSampler(SamplerSection):
    """Designs are proposed, run and judged, until *evaluations* runs were asked for.

    Requirements come first: designs that meet them are compared by their objectives, the others by how far they are
    from meeting them (`Judge`). Designs are raced over the conditions (`Race`). What is uncertain is at its nominal
    value, or with *draws* at so many values, as further conditions.
    """

    once: ClassVar[bool] = False
    proposes: ClassVar[bool] = True
    placing: ClassVar[Placing] = Placing.FIRST
    package: ClassVar[str] = ""
    """What has to be installed for it, of the extra ``optimize``; "" if nothing."""
    evaluations: int = Field(ge=1, le=MOST_RUNS)
    draws: int = Field(default=0, ge=0, le=1000)

    @property
    def grid(self) -> Grid | None:
        """The points may lie anywhere."""
        return None

    def options(self) -> Mapping[str, Any]:
        """What it was given."""
        return self.model_dump(mode="json", exclude_none=True)

    @abstractmethod
    def proposer(self, brief: Brief, cases: Cases) -> Proposer:
        """What proposes designs for *brief*, to be run in *cases*. Raises DseError for a brief it cannot do."""

    def start(self, brief: Brief) -> Search:
        """Refused without an objective, and without the package it needs."""
        if not brief.objectives:
            what = f"the sampler '{self.name}' needs something to be as small or as large as can be"
            raise fail(what, None, "objectives: [minimize sum(cost)]")
        if self.package and find_spec(self.package) is None:
            what = f"the sampler '{self.name}' needs {self.package}"
            raise fail(what, None, "pip install 'dse-workbench[optimize]'")
        return _Search(self, brief)


class _Search:
    def __init__(self, sampler: OptimizingSampler, brief: Brief) -> None:
        self._brief = brief
        self._cases = Cases(brief, sampler.draws)
        self._order = RaceOrder(len(self._cases))
        self._judge = Judge(brief.variables, brief.objectives)
        self._left = sampler.evaluations
        self._proposer = sampler.proposer(brief, self._cases)
        self._designs: Sequence[Design] = []
        self._race = Race(0, ())
        self._told: list[Outcomes] = []
        self._wanted: list[tuple[int, int]] = []
        self._asked: list[Candidate] = []

    def ask(self) -> Sequence[Candidate]:
        """The next cases of the designs that are in the race; if there is none, the first of new designs."""
        self._wanted = self._race.wanted()
        if not self._wanted and self._left:
            if self._designs:
                self._judged()
            self._designs, self._told = self._proposer.next(), []
            self._race = Race(len(self._designs), self._order.now())
            self._wanted = self._race.wanted()
        self._wanted = self._wanted[: self._left]
        self._left -= len(self._wanted)
        self._asked = [self._cases.candidate(self._designs[design], case) for design, case in self._wanted]
        return list(dict.fromkeys(self._asked))

    def tell(self, outcomes: Outcomes) -> None:
        """What came of the runs."""
        asked = list(dict.fromkeys(self._asked))
        self._cases.learn(asked, outcomes)
        self._told.append(outcomes)
        found = dict(zip(asked, lost(outcomes, self._brief.objectives), strict=True))
        told = [found[candidate] for candidate in self._asked]
        self._race.tell(self._wanted, told)
        for (_, case), is_lost in zip(self._wanted, told, strict=True):
            self._order.count(case, is_lost)

    def _judged(self) -> None:
        """What was not run, as a design was lost before, adds its share of the cases to the violation."""
        worth = self._judge.judged(self._told, [self._cases.key(design) for design in self._designs])
        skipped = [1 - run / len(self._cases) for run in self._race.run]
        self._proposer.tell(worth._replace(violations=worth.violations + skipped))


# Designs are run in one case after the other, and no further once one is lost.


class RaceOrder:
    """The cases of a study by how often designs were lost in them, the most often first."""

    def __init__(self, cases: int) -> None:
        self._lost = [0] * cases
        self._run = [0] * cases

    def count(self, case: int, is_lost: bool) -> None:
        """Take one more run into account."""
        self._run[case] += 1
        self._lost[case] += is_lost

    def now(self) -> tuple[int, ...]:
        """The numbers of the cases. A case that was never run counts as one in which every other design is lost."""
        share = [(lost + 1) / (run + 2) for lost, run in zip(self._lost, self._run, strict=True)]
        return tuple(sorted(range(len(share)), key=lambda case: (-share[case], case)))


class Race:
    """*number* designs on their way through the cases in *order*: one case first, then two more, then four, and so on.

    So a design that is lost costs few runs, and what is left is enough work for all processors. *run* counts the cases
    that each was run in.
    """

    def __init__(self, number: int, order: Sequence[int]) -> None:
        self.run = [0] * number
        self._left = dict.fromkeys(range(number))
        self._order = order
        self._begun = 0

    def wanted(self) -> list[tuple[int, int]]:
        """Which design is to be run in which case next, case after case; none at the end."""
        cases = self._order[self._begun : 2 * self._begun + 1]
        self._begun += len(cases)
        return [(design, case) for case in cases for design in self._left]

    def tell(self, asked: Sequence[tuple[int, int]], lost: Sequence[bool]) -> None:
        """Which designs are lost by what was wanted."""
        for (design, _), is_lost in zip(asked, lost, strict=True):
            self.run[design] += 1
            if is_lost:
                self._left.pop(design, None)
