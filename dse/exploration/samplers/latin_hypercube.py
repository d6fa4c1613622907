"""Points stratified in every variable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Brief, Point
from dse.exploration.once_sampler import MOST_RUNS, OnceSampler, scaled

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class LatinHypercube(OnceSampler):
    """Points of which every variable has exactly one in each of *samples* equal strata, placed by the study's seed.

    In a study that is extended, the points that are there stay, and new ones are put into the strata that are empty.
    """

    name: ClassVar[str] = "latin_hypercube"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"samples": 12},)

    samples: int = Field(ge=1, le=MOST_RUNS)

    def points(self, brief: Brief) -> Sequence[Point]:
        """The points in a random order, those that are there first."""
        import numpy as np
        from scipy.stats.qmc import LatinHypercube as Hypercube

        there = _points_everywhere(brief)[: self.samples]
        if there:
            return [*there, *scaled(self._between(there, brief), brief.variables)]
        unit = Hypercube(len(brief.variables), seed=np.random.default_rng(brief.seed)).random(self.samples)
        return scaled(unit, brief.variables)

    def _between(self, there: Sequence[Point], brief: Brief) -> NDArray[np.float64]:
        """New points of the unit cube, each in strata of its own that none of those *there* lies in."""
        import numpy as np

        random = np.random.default_rng([brief.seed, len(there)])
        low = np.array([variable.low for variable in brief.variables])
        width = np.array([variable.high - variable.low for variable in brief.variables])
        taken = np.clip((np.array(there) - low) / width * self.samples, 0, self.samples - 1).astype(int)
        new = self.samples - len(there)
        columns = []
        for strata in taken.T:
            empty = np.setdiff1d(np.arange(self.samples), strata)
            columns.append((random.permutation(empty)[:new] + random.random(new)) / self.samples)
        return np.stack(columns, axis=1)


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
