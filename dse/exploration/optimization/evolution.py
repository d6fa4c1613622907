"""Searches for the best designs by evolution: the loop that NSGA-II and NSGA-III share, whose selection is pymoo's."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Brief
from dse.exploration.configuration_sampler import space_of
from dse.exploration.optimization.designs import Cases, Design
from dse.exploration.optimization.fitness import Worth
from dse.exploration.optimization.offspring import Breeding
from dse.exploration.optimization.optimizing_sampler import OptimizingSampler, Proposer

if TYPE_CHECKING:
    from numpy.random import Generator

_BAD = 1e30
"""The objectives of a design that violates a requirement: never looked at, but they have to be numbers."""

_MATINGS = 20
"""Rounds of mating without enough new designs after which a generation is as small as it is."""


_LEAST, _MOST = 16, 64
_GROWTH = 24
"""Without a *population*, a generation has one design for every 24 that were judged, within these bounds. So a short
search has many generations, and a longer one begins as the shorter one."""


class EvolutionSampler(OptimizingSampler):
    """A generation of *population* designs after the other; without that, of more and more, 16 to 64."""

    package: ClassVar[str] = "pymoo"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"population": 8, "evaluations": 40},
        {"population": 4, "evaluations": 30, "draws": 2},
    )

    population: int | None = Field(default=None, ge=4, le=100_000)

    @abstractmethod
    def algorithm(self, objectives: int, options: Mapping[str, Any]) -> Any:
        """The algorithm of pymoo with these *options*. Raises DseError for a number of *objectives* it cannot do."""

    def proposer(self, brief: Brief, cases: Cases) -> Proposer:
        """Generations as pymoo selects them."""
        return _Selection(self, brief, _Mating(brief, cases))


class _Selection:
    """pymoo's algorithm, which asks for designs and is told how good they are."""

    def __init__(self, sampler: EvolutionSampler, brief: Brief, mating: _Mating) -> None:
        from pymoo.core.population import Population
        from pymoo.core.problem import Problem
        from pymoo.core.termination import NoTermination

        self._population, self._judged = sampler.population, 0
        first = mating.breeding.begin(self._population or _LEAST, brief.seed, mating.cases)
        options = {
            "pop_size": self._population or _MOST,
            "sampling": Population.new(X=_column(first)),
            "eliminate_duplicates": False,
            "mating": mating,
            "seed": brief.seed,
        }
        self._problem = Problem(n_var=1, n_obj=len(brief.objectives), n_ieq_constr=1)
        self._algorithm = sampler.algorithm(len(brief.objectives), options)
        self._algorithm.setup(self._problem, termination=NoTermination())
        self._asked: Any = None
        self._grow()

    def next(self) -> list[Design]:
        """The designs of the next generation; none if there is no new one."""
        self._asked = self._algorithm.ask()
        return [] if self._asked is None else [one.X[0] for one in self._asked]

    def tell(self, worth: Worth) -> None:
        """How good they are."""
        import numpy as np
        from pymoo.problems.static import StaticProblem

        violation = worth.violations[:, None]
        values = np.where(violation > 0, _BAD, worth.objectives)
        self._algorithm.evaluator.eval(StaticProblem(self._problem, F=values, G=violation), self._asked)
        self._algorithm.tell(infills=self._asked)
        self._judged += len(worth.violations)
        self._grow()

    def _grow(self) -> None:
        size = self._population or min(max(_LEAST, self._judged // _GROWTH), _MOST)
        self._algorithm.pop_size = self._algorithm.n_offsprings = size


class _Mating:
    """In place of pymoo's: children of selected parents that are allowed, and that no one asked for before."""

    def __init__(self, brief: Brief, cases: Cases) -> None:
        self.breeding = Breeding(space_of(brief), len(cases.variables))
        self.cases = cases

    def do(self, problem: Any, population: Any, number: int, *, random_state: Generator, algorithm: Any) -> Any:
        """*number* of them, as pymoo asks for them; fewer if there are not so many."""
        from pymoo.core.population import Population

        selection = algorithm.selection
        found: list[Design] = []
        for _ in range(_MATINGS):
            pairs = -(-(number - len(found)) // 2)
            parents = selection(problem, population, pairs, 2, algorithm=algorithm, random_state=random_state)
            for one, other in parents:
                children = self.breeding.children(one.X[0], other.X[0], random_state)
                found += [child for child in children if len(found) < number and self.cases.take(child)]
            if len(found) >= number:
                break
        return Population.new(X=_column(found[:number])) if found else Population.empty()


def _column(designs: Sequence[Design]) -> Any:
    import numpy as np

    column = np.empty((len(designs), 1), dtype=object)
    column[:, 0] = designs
    return column
