"""The Halton sequence."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Brief, Placing
from dse.exploration.one_shot_sampler import MOST_RUNS, OneShotSampler

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


class Halton(OneShotSampler):
    """The first *samples* points of a Halton sequence, scrambled by the study's seed unless that is switched off.

    Any number of them is even, in up to about ten variables. An extended study keeps its points.
    """

    name: ClassVar[str] = "halton"
    placing: ClassVar[Placing] = Placing.EVEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"samples": 12}, {"samples": 7, "scramble": False})

    samples: int = Field(ge=1, le=MOST_RUNS)
    scramble: bool = True

    def points(self, brief: Brief) -> NDArray[np.float64]:
        """The points in the order of the sequence."""
        import numpy as np
        from scipy.stats import qmc

        sequence = qmc.Halton(len(brief.variables), scramble=self.scramble, seed=np.random.default_rng(brief.seed))
        return sequence.random(self.samples)


SAMPLER = Halton
