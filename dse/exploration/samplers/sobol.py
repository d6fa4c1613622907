"""The Sobol' sequence."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Brief, Placing
from dse.exploration.one_shot_sampler import MOST_RUNS, OneShotSampler

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Sobol(OneShotSampler):
    """The first *samples* points of a Sobol' sequence, scrambled by the study's seed (Owen) unless switched off.

    Powers of two fill the ranges most evenly. More samples go on with the sequence: an extended study keeps its points.
    """

    name: ClassVar[str] = "sobol"
    placing: ClassVar[Placing] = Placing.EVEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"samples": 16}, {"samples": 12, "scramble": False})

    samples: int = Field(ge=1, le=MOST_RUNS)
    scramble: bool = True

    def points(self, brief: Brief) -> NDArray[np.float64]:
        """The points in the order of the sequence."""
        import numpy as np
        from scipy.stats import qmc

        sequence = qmc.Sobol(len(brief.variables), scramble=self.scramble, seed=np.random.default_rng(brief.seed))
        with warnings.catch_warnings():
            # Any other number than a power of two is less even, not wrong.
            warnings.filterwarnings("ignore", message="The balance properties", category=UserWarning)
            return sequence.random(self.samples)


SAMPLER = Sobol
