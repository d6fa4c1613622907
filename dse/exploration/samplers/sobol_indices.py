"""Points from which Sobol' indices are computed."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field, field_validator

from dse.domain.sampler import Brief, Placing
from dse.errors import fail
from dse.exploration.one_shot_sampler import ValueSampler
from dse.exploration.variables import scaled

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class SobolIndices(ValueSampler):
    """Blocks of runs that differ in one variable each (Saltelli et al. 2010): *base* blocks of k + 2 runs for k
    variables, with *second_order* of 2 k + 2. *base* is a power of two. A point that occurs twice is one run.
    """

    name: ClassVar[str] = "sobol_indices"
    placing: ClassVar[Placing] = Placing.EVEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"base": 8}, {"base": 4, "second_order": True})

    base: int = Field(ge=2, le=2**18)
    second_order: bool = False

    @field_validator("base")
    @classmethod
    def _is_power(cls, value: int) -> int:
        if value & (value - 1):
            raise ValueError(f"base: {value} is not a power of two: take {2 ** (value.bit_length() - 1)}")
        return value

    def values(self, brief: Brief) -> NDArray[np.float64]:
        """Those that are different, in the order of the blocks; DseError as `design`."""
        return different(self.design(brief))

    def design(self, brief: Brief) -> NDArray[np.float64]:
        """Block after block, (base * block, variables), some points more than once.

        DseError if variables are correlated, or SALib is not installed.
        """
        if brief.correlations:
            raise fail("Sobol' indices are of independent variables, and some are correlated", None, "take 'sobol'")
        names = [variable.name for variable in brief.variables]
        problem = {"num_vars": len(names), "names": names, "bounds": [[0.0, 1.0]] * len(names)}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            # It takes the seed 0 as none at all.
            unit = salib("sample.sobol").sample(
                problem, self.base, calc_second_order=self.second_order, seed=brief.seed + 1
            )
        return scaled(unit, brief.variables)


def different(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """*points*, (n, variables), each once, in their order."""
    import numpy as np

    return points[np.sort(np.unique(points, axis=0, return_index=True)[1])]


def salib(module: str) -> Any:
    """A module of SALib; DseError that says how to install it."""
    try:
        return import_module(f"SALib.{module}")
    except ImportError as error:
        raise fail("SALib is needed for this, and is not installed", None, HINT) from error


HINT = 'pip install "dse-workbench[analysis]"'

SAMPLER = SobolIndices
