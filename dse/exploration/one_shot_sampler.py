"""What samplers that ask once have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from dse.domain.sampler import Brief, Grid, OneShot, Point, Search
from dse.errors import Location, fail
from dse.exploration.variables import at_conditions, free, scaled
from dse.loading import SamplerSection

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

MOST_RUNS = 5_000_000
"""Larger studies are refused: no sampler here is a sensible way to spend them."""


class ValueSampler(SamplerSection):
    """A sampler that asks once, for the same values of the variables on every configuration."""

    once: ClassVar[bool] = True

    @property
    def grid(self) -> Grid | None:
        """The points may lie anywhere."""
        return None

    @abstractmethod
    def values(self, brief: Brief) -> Array | Sequence[Point]:
        """The values, (n, variables), within the ranges of the *brief*'s variables, none of which is a condition.

        The same brief gives the same.
        """

    def start(self, brief: Brief) -> Search:
        """Asks once, for those of the points that are allowed, each at every condition."""
        import numpy as np

        variables = free(brief)
        points = self.values(replace(brief, variables=variables, conditions=()))
        asked = at_conditions(np.array(points, dtype=np.float64).reshape(len(points), len(variables)), brief)
        return OneShot(asked if brief.allowed is None else asked[brief.allowed(asked)], brief.configurations)


class OneShotSampler(ValueSampler):
    """A sampler that asks once, for the same *points* of the unit cube on every configuration.

    What a variable's range, scale, values, distribution and correlations make of a point is not its concern.
    """

    @abstractmethod
    def points(self, brief: Brief) -> Array:
        """The points, (n, variables), each coordinate 0 … 1, for the *brief*'s variables, none of which is a condition.

        The same brief gives the same.
        """

    def values(self, brief: Brief) -> Array:
        """The points on the variables' scales. Raises DseError for points outside of the unit cube."""
        import numpy as np

        unit = np.asarray(self.points(brief), dtype=np.float64).reshape(-1, len(brief.variables))
        if not ((unit >= 0) & (unit <= 1)).all():
            what = f"the sampler '{self.name}' gives a point outside of the unit cube"
            raise fail(what, None, "'points' are 0 … 1; dse scales them to ranges, values and distributions")
        return scaled(unit, brief.variables, brief.correlations)


def require_few(runs: int, where: Location | None) -> None:
    """DseError, at *where*, if there are more than `MOST_RUNS`."""
    if runs > MOST_RUNS:
        raise fail(
            f"the study has {runs:,} runs, more than {MOST_RUNS:,}",
            where,
            "take fewer levels, slices of two variables, or another sampler",
        )
