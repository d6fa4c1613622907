"""What samplers that ask once have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from typing import TYPE_CHECKING, ClassVar

from dse.domain.sampler import Brief, DesignVariable, Grid, Once, Point, Search
from dse.errors import Location, fail
from dse.loading import SamplerSection

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

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
    def points(self, brief: Brief) -> Sequence[Point]:
        """The points, within the variables' ranges; the same *brief* gives the same."""

    def start(self, brief: Brief) -> Search:
        """Asks once."""
        return Once(self.points(brief), brief.configurations)


def scaled(unit: NDArray[np.float64], variables: Sequence[DesignVariable]) -> list[Point]:
    """Points of the unit cube, (n, variables), in the variables' ranges."""
    import numpy as np

    low = np.array([variable.low for variable in variables])
    high = np.array([variable.high for variable in variables])
    # Rounding may carry a point past the end of its range.
    return [tuple(row) for row in np.clip(low + unit * (high - low), low, high).tolist()]


def require_few(runs: int, where: Location | None) -> None:
    """DseError, at *where*, if there are more than `MOST_RUNS`."""
    if runs > MOST_RUNS:
        raise fail(
            f"the study has {runs:,} runs, more than {MOST_RUNS:,}",
            where,
            "take fewer levels, slices of two variables, or another sampler",
        )
