"""Searches for the best designs by evolution: the loop that NSGA-II and NSGA-III share, whose selection is pymoo's."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

from pydantic import Field

from dse.domain.sampler import Brief, Candidate, Grid, Outcomes, Search
from dse.errors import fail
from dse.exploration.once_sampler import MOST_RUNS
from dse.exploration.optimising.breeding import Breeding
from dse.exploration.optimising.designs import Cases, Design
from dse.exploration.optimising.judging import Aggregate, Judge, Judgement, results, scales
from dse.exploration.optimising.racing import Order, Race
from dse.exploration.proposing import space_of
from dse.loading import SamplerSection

if TYPE_CHECKING:
    from numpy.random import Generator

_BAD = 1e30
"""The objectives of a design that violates a requirement: never looked at, but they have to be numbers."""

_MATINGS = 20
"""Rounds of mating without enough new designs after which a generation is as small as it is."""


class EvolutionSampler(SamplerSection):
    """A generation of *population* designs after the other, until *evaluations* runs were asked for.

    Requirements come first: designs that meet them are compared by their objectives, the others by how far they are
    from meeting them (`Judge`). Designs are raced over the conditions (`Race`). What is uncertain is at its nominal
    value, or with *draws* at so many values, as further conditions.
    """

    once: ClassVar[bool] = False
    proposes: ClassVar[bool] = True
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"population": 8, "evaluations": 40},
        {"population": 4, "evaluations": 30, "aggregate": "mean", "not_exercised": "pass", "draws": 2},
    )

    evaluations: int = Field(ge=1, le=MOST_RUNS)
    population: int = Field(default=64, ge=4, le=100_000)
    aggregate: Aggregate = "worst"
    not_exercised: Literal["fail", "pass"] = "fail"
    draws: int = Field(default=0, ge=0, le=1000)

    @property
    def grid(self) -> Grid | None:
        """The points may lie anywhere."""
        return None

    @abstractmethod
    def algorithm(self, objectives: int, options: Mapping[str, Any]) -> Any:
        """The algorithm of pymoo with these *options*. Raises DseError for a number of *objectives* it cannot do."""

    def start(self, brief: Brief) -> Search:
        """Refused without an objective, and without pymoo."""
        if not brief.objectives:
            what = f"the sampler '{self.name}' needs something to be as small or as large as can be"
            raise fail(what, None, "objectives: [minimize sum(cost)]")
        try:
            import pymoo  # noqa: F401
        except ImportError as error:
            raise fail(
                f"the sampler '{self.name}' needs pymoo", hint="pip install 'dse-workbench[optimize]'"
            ) from error
        return _Search(self, brief)


class _Search:
    def __init__(self, sampler: EvolutionSampler, brief: Brief) -> None:
        self._sampler, self._brief = sampler, brief
        self._cases = Cases(brief, sampler.draws)
        self._order = Order(len(self._cases))
        self._judge: Judge | None = None
        self._left = sampler.evaluations
        self._selection = _Selection(sampler, brief, _Mating(brief, self._cases))
        self._designs: list[Design] = []
        self._race = Race(0, ())
        self._wanted: list[tuple[int, int]] = []
        self._asked: list[Candidate] = []

    def ask(self) -> Sequence[Candidate]:
        """The next cases of the designs that are in the race; if there is none, a generation's first."""
        self._wanted = self._race.wanted()
        if not self._wanted and self._left:
            if self._designs:
                self._select()
            self._designs = self._selection.next()
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
        found = dict(zip(asked, results(outcomes, self._brief.objectives), strict=True))
        told = [found[candidate] for candidate in self._asked]
        self._race.tell(self._wanted, told)
        for (_, case), result in zip(self._wanted, told, strict=True):
            self._order.count(case, result)

    def _select(self) -> None:
        if self._judge is None:
            first = [result for found in self._race.results for result in found]
            idle = self._sampler.not_exercised == "pass"
            self._judge = Judge(len(self._cases), self._sampler.aggregate, idle, scales(first))
        self._selection.tell([self._judge.judged(found) for found in self._race.results])


class _Selection:
    """pymoo's algorithm, which asks for designs and is told how good they are."""

    def __init__(self, sampler: EvolutionSampler, brief: Brief, mating: _Mating) -> None:
        from pymoo.core.population import Population
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination

        first = mating.first(sampler.population, brief.seed)
        options = {
            "pop_size": sampler.population,
            "sampling": Population.new(X=_column(first)),
            "eliminate_duplicates": False,
            "mating": mating,
            "seed": brief.seed,
        }
        self._objectives = len(brief.objectives)
        self._problem = Problem(n_var=1, n_obj=self._objectives, n_ieq_constr=1)
        self._algorithm = sampler.algorithm(self._objectives, options)
        self._algorithm.setup(self._problem, termination=NoTermination())
        self._asked: Any = None

    def next(self) -> list[Design]:
        """The designs of the next generation; none if there is no new one."""
        self._asked = self._algorithm.ask()
        return [] if self._asked is None else [one.X[0] for one in self._asked]

    def tell(self, judgements: Sequence[Judgement]) -> None:
        """How good they are."""
        import numpy as np
        from pymoo.problems.static import StaticProblem

        bad = (_BAD,) * self._objectives
        values = np.array([bad if one.violation else one.objectives for one in judgements], dtype=np.float64)
        violations = np.array([[one.violation] for one in judgements], dtype=np.float64)
        self._algorithm.evaluator.eval(StaticProblem(self._problem, F=values, G=violations), self._asked)
        self._algorithm.tell(infills=self._asked)


class _Mating:
    """In place of pymoo's: children of selected parents that are allowed, and that no one asked for before."""

    def __init__(self, brief: Brief, cases: Cases) -> None:
        self._breeding = Breeding(space_of(brief), len(cases.variables))
        self._cases = cases
        self._known: set[Candidate] = set()

    def first(self, number: int, seed: int) -> list[Design]:
        """Up to *number* designs; more are drawn in place of those that are not allowed."""
        found: list[Design] = []
        for turn in range(_MATINGS):
            fresh = [design for design in self._breeding.first(number, seed + turn) if self._is_new(design)]
            found += fresh[: number - len(found)]
            if len(found) == number:
                break
        if not found:
            raise fail("the sampler finds no design that the constraints between variables allow")
        return found

    def do(self, problem: Any, population: Any, number: int, *, random_state: Generator, algorithm: Any) -> Any:
        """*number* of them, as pymoo asks for them; fewer if there are not so many."""
        from pymoo.core.population import Population

        selection = algorithm.selection
        found: list[Design] = []
        for _ in range(_MATINGS):
            pairs = -(-(number - len(found)) // 2)
            parents = selection(problem, population, pairs, 2, algorithm=algorithm, random_state=random_state)
            for one, other in parents:
                children = self._breeding.children(one.X[0], other.X[0], random_state)
                found += [child for child in children if len(found) < number and self._is_new(child)]
            if len(found) >= number:
                break
        return Population.new(X=_column(found[:number])) if found else Population.empty()

    def _is_new(self, design: Design) -> bool:
        key = self._cases.candidate(design, 0)
        if key in self._known or not self._cases.is_allowed(design):
            return False
        self._known.add(key)
        return True


def _column(designs: Sequence[Design]) -> Any:
    import numpy as np

    column = np.empty((len(designs), 1), dtype=object)
    column[:, 0] = designs
    return column
