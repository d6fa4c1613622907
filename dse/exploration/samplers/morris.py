"""Trajectories through the ranges, from which Morris's elementary effects are computed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field, field_validator

from dse.domain.sampler import Brief
from dse.errors import fail
from dse.exploration.one_shot_sampler import ValueSampler
from dse.exploration.samplers.sobol_indices import different, salib
from dse.exploration.variables import scaled

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Morris(ValueSampler):
    """*trajectories* of k + 1 runs for k variables, each changing one variable at a time by half its range or a little
    more (Morris 1991). Variables take *levels* values, an even number. A point of several trajectories is one run.
    """

    name: ClassVar[str] = "morris"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"trajectories": 4}, {"trajectories": 3, "levels": 6})

    trajectories: int = Field(ge=2, le=100_000)
    levels: int = Field(default=4, ge=2, le=100)

    @field_validator("levels")
    @classmethod
    def _is_even(cls, value: int) -> int:
        if value % 2:
            raise ValueError(f"levels: {value} is odd: take {value + 1}")
        return value

    def values(self, brief: Brief) -> NDArray[np.float64]:
        """Those that are different, in the order of the trajectories; DseError as `design`."""
        return different(self.design(brief))

    def design(self, brief: Brief) -> NDArray[np.float64]:
        """Trajectory after trajectory, (trajectories * (variables + 1), variables), some points more than once.

        DseError if variables are correlated, or SALib is not installed.
        """
        if brief.correlations:
            raise fail("elementary effects are of independent variables, and some are correlated", None, "take 'sobol'")
        names = [variable.name for variable in brief.variables]
        problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
        unit = salib("sample.morris").sample(problem, self.trajectories, self.levels, seed=brief.seed + 1)
        return scaled(unit, brief.variables)


SAMPLER = Morris
