"""What samplers that ask once have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from dse.domain.sampler import Brief, Grid, Once, Point, Search
from dse.errors import Location, fail
from dse.exploration.variables import at_conditions, free
from dse.loading import SamplerSection

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

MOST_RUNS = 5_000_000
"""Larger studies are refused: no sampler here is a sensible way to spend them."""


class OnceSampler(SamplerSection):
    """A sampler that asks once, for the same *points* on every configuration."""

    once: ClassVar[bool] = True

    @property
    def grid(self) -> Grid | None:
        """The points may lie anywhere."""
        return None

    @abstractmethod
    def points(self, brief: Brief) -> Array | Sequence[Point]:
        """The points, (n, variables), within the ranges of the *brief*'s variables, none of which is a condition.

        The same brief gives the same.
        """

    def start(self, brief: Brief) -> Search:
        """Asks once, for those of the points that are allowed, each at every condition."""
        import numpy as np

        variables = free(brief)
        points = self.points(replace(brief, variables=variables, conditions=()))
        asked = at_conditions(np.array(points, dtype=np.float64).reshape(len(points), len(variables)), brief)
        return Once(asked if brief.allowed is None else asked[brief.allowed(asked)], brief.configurations)


def require_few(runs: int, where: Location | None) -> None:
    """DseError, at *where*, if there are more than `MOST_RUNS`."""
    if runs > MOST_RUNS:
        raise fail(
            f"the study has {runs:,} runs, more than {MOST_RUNS:,}",
            where,
            "take fewer levels, slices of two variables, or another sampler",
        )
