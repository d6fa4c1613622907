"""For few expensive runs: each where it promises most."""

from __future__ import annotations

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
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_MOST_EVALUATIONS = 5000
_POOL = 256
_PARENTS = 8
_SCALES = (0.2, 0.05, 0.01, 0.002)
"""Standard deviations of moves near the best, as shares of the ranges."""

_DIGITS = 9
"""Decimals of a place in a range: the last bits of another machine do not matter."""


class MixedGp(OptimizingSampler):
    """Gaussian processes over configurations and variables together (`Improvement`): *first* designs fill the space,
    then come *batch* at a time, the most promising of a pool of draws, children of the best, and moves near them.

    Several objectives become one by weights that are drawn for each batch (ParEGO, Knowles 2006).
    """

    name: ClassVar[str] = "mixed_gp"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = (
        {"evaluations": 12, "first": 8},
        {"evaluations": 14, "first": 6, "batch": 2, "draws": 2},
    )

    # The time of an ask grows with the third power.
    evaluations: int = Field(ge=1, le=_MOST_EVALUATIONS)
    first: int = Field(default=24, ge=1)
    batch: int = Field(default=4, ge=1)

    def proposer(self, brief: Brief, cases: Cases) -> Proposer:
        """By processes through what is known."""
        return _Promising(self, brief, cases)


class _Promising:
    def __init__(self, sampler: MixedGp, brief: Brief, cases: Cases) -> None:
        import numpy as np

        from dse.exploration.optimization.expected_improvement import ImprovementShapes

        self._shapes = ImprovementShapes()
        self._space, self._cases, self._sampler, self._seed = space_of(brief), cases, sampler, brief.seed
        self._breeding = Breeding(self._space, len(cases.variables))
        self._objectives = len(brief.objectives)
        self._random = np.random.default_rng(brief.seed)
        self._asked: list[Design] = []
        self._designs: list[Design] = []
        self._told: list[Worth] = []

    def next(self) -> list[Design]:
        """The first designs; then the most promising ones."""
        if not self._designs:
            self._asked = self._breeding.begin(self._sampler.first, self._seed, self._cases)
        else:
            self._asked = self._promising()
        return self._asked

    def tell(self, judgement: Worth) -> None:
        """Remember it."""
        self._designs += self._asked
        self._told.append(judgement)

    def _promising(self) -> list[Design]:
        import numpy as np

        from dse.exploration.optimization.expected_improvement import Improvement, encoded, scalar

        known = Worth(*(np.concatenate(columns) for columns in zip(*self._told, strict=True)))
        weights = np.maximum(self._random.dirichlet(np.ones(self._objectives)), 1e-6)
        worth = scalar(known.objectives, weights)
        alternatives = self._space.alternatives
        told = encoded(self._designs, self._cases, alternatives)
        if not told.shape[1]:
            return []
        improvement = Improvement(told, known, worth, self._shapes)
        order = np.lexsort([np.nan_to_num(worth), known.violations])
        pool = self._pool([self._designs[number] for number in order[:_PARENTS].tolist()])
        # Twice: where the first pool promises most, the second looks closer.
        points = encoded(pool, self._cases, alternatives)
        near = improvement.best(points, _PARENTS)
        moved = [self._moved(pool[number]) for number in near for _ in range(_POOL // _PARENTS)]
        pool, points = pool + moved, np.vstack([points, encoded(moved, self._cases, alternatives)])
        chosen = improvement.best(points, 4 * self._sampler.batch)
        taken = (pool[number] for number in chosen if self._cases.take(pool[number]))
        found = [design for design, _ in zip(taken, range(self._sampler.batch), strict=False)]
        return found or self._breeding.fresh(1, int(self._random.integers(1 << 31)), self._cases)

    def _pool(self, best: Sequence[Design]) -> list[Design]:
        pool = self._breeding.first(_POOL, int(self._random.integers(1 << 31)))
        for one, other in self._random.integers(len(best), size=(_POOL // 2, 2)).tolist():
            pool += self._breeding.children(best[one], best[other], self._random)
        return pool + [self._moved(best[number % len(best)]) for number in range(_POOL)]

    def _moved(self, design: Design) -> Design:
        import numpy as np

        scale = _SCALES[int(self._random.integers(len(_SCALES)))]
        unit = np.array(design.unit) + scale * self._random.standard_normal(len(design.unit))
        return Design(design.architecture, tuple(np.round(np.clip(unit, 0, 1), _DIGITS).tolist()))


SAMPLER = MixedGp
