"""Points stratified in every variable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from pydantic import Field

from dse.domain.sampler import Brief, Placing, Point
from dse.errors import fail
from dse.exploration.one_shot_sampler import MOST_RUNS, OneShotSampler
from dse.exploration.variables import scaled, unit_of
from dse.loading import Surroundings

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class LatinHypercube(OneShotSampler):
    """Points of which every variable has exactly one in each of *samples* equal strata, placed by the study's seed.

    In a study that is extended, the points that are there stay, and new ones are put into the strata that are empty.
    With *optimize* coordinates are exchanged between points until all projections are filled evenly, too: the centred
    L2 discrepancy (Hickernell 1998) gets smaller.
    """

    name: ClassVar[str] = "latin_hypercube"
    placing: ClassVar[Placing] = Placing.EVEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"samples": 12}, {"samples": 12, "optimize": True})

    samples: int = Field(ge=1, le=MOST_RUNS)
    optimize: bool = False

    def options(self) -> Mapping[str, Any]:
        """What it was given; studies from before there was *optimize* say nothing of it."""
        return {name: value for name, value in super().options().items() if name != "optimize" or value}

    def settled(self, around: Surroundings) -> Self:
        """Raises DseError for more samples than can be optimised."""
        if self.optimize and self.samples > _MOST_OPTIMIZED:
            what = f"{self.samples:,} samples are too many to be optimised"
            hint = f"take at most {_MOST_OPTIMIZED:,}, or leave out 'optimize': many samples are even by themselves"
            raise fail(what, around.place("samples"), hint)
        return self

    def values(self, brief: Brief) -> NDArray[np.float64]:
        """The points in a random order, those that are there first."""
        import numpy as np

        there = _points_everywhere(brief)[: self.samples]
        if there:
            return np.concatenate([there, scaled(self._between(there, brief), brief.variables, brief.correlations)])
        return super().values(brief)

    def points(self, brief: Brief) -> NDArray[np.float64]:
        """Those of a new study, in a random order."""
        import numpy as np
        from scipy.stats.qmc import LatinHypercube as Hypercube

        method: Literal["random-cd"] | None = "random-cd" if self.optimize and self.samples > 1 else None
        random = np.random.default_rng(brief.seed)
        return Hypercube(len(brief.variables), optimization=method, seed=random).random(self.samples)

    def _between(self, there: Sequence[Point], brief: Brief) -> NDArray[np.float64]:
        """New points of the unit cube, each in strata of its own that none of those *there* lies in."""
        import numpy as np

        random = np.random.default_rng([brief.seed, len(there)])
        old = np.clip(unit_of(np.array(there), brief.variables), 0.0, 1.0)
        taken = np.clip(old * self.samples, 0, self.samples - 1).astype(int)
        new = self.samples - len(there)

        def draw() -> NDArray[np.float64]:
            columns = []
            for strata in taken.T:
                empty = np.setdiff1d(np.arange(self.samples), strata)
                columns.append((random.permutation(empty)[:new] + random.random(new)) / self.samples)
            return np.stack(columns, axis=1)

        first = draw()
        return _exchanged(old, first, random) if self.optimize and new > 1 else first


def _exchanged(old: NDArray[np.float64], new: NDArray[np.float64], random: np.random.Generator) -> NDArray[np.float64]:
    """*new* with coordinates exchanged between its points, which keeps their strata, as long as that helps."""
    import numpy as np
    from scipy.stats.qmc import discrepancy

    best = discrepancy(np.concatenate([old, new]))
    for _ in range(_EXCHANGES):
        one, other = random.choice(len(new), 2, replace=False)
        column = random.integers(new.shape[1])
        tried = new.copy()
        tried[[one, other], column] = tried[[other, one], column]
        found = discrepancy(np.concatenate([old, tried]))
        if found < best:
            new, best = tried, found
    return new


_EXCHANGES = 1000
_MOST_OPTIMIZED = 2000


def _points_everywhere(brief: Brief) -> list[Point]:
    """Points within the ranges that there are runs of on every configuration, in the order of the runs."""
    columns = [brief.earlier.points[variable.name].tolist() for variable in brief.variables]
    ranges = [(variable.low, variable.high) for variable in brief.variables]
    found: dict[Point, set[str]] = {}
    for configuration, *point in zip(brief.earlier.configurations, *columns, strict=True):
        if all(low <= value <= high for value, (low, high) in zip(point, ranges, strict=True)):
            found.setdefault(tuple(point), set()).add(configuration)
    return [point for point, names in found.items() if names.issuperset(brief.configurations)]


SAMPLER = LatinHypercube
