"""The Halton sequence."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Brief, Point
from dse.exploration.once_sampler import MOST_RUNS, OnceSampler, scaled


class Halton(OnceSampler):
    """The first *samples* points of a Halton sequence, scrambled by the study's seed unless that is switched off.

    Any number of them is even, in up to about ten variables. An extended study keeps its points.
    """

    name: ClassVar[str] = "halton"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"samples": 12}, {"samples": 7, "scramble": False})

    samples: int = Field(ge=1, le=MOST_RUNS)
    scramble: bool = True

    def points(self, brief: Brief) -> Sequence[Point]:
        """The points in the order of the sequence."""
        import numpy as np
        from scipy.stats import qmc

        sequence = qmc.Halton(len(brief.variables), scramble=self.scramble, seed=np.random.default_rng(brief.seed))
        return scaled(sequence.random(self.samples), brief.variables)


SAMPLER = Halton
