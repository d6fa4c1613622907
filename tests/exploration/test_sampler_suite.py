"""Every sampler that is found, those of installed packages too, in the suite that others run over theirs."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
import pytest

from dse.domain.sampler import Placing
from dse.errors import DseError
from dse.exploration.one_shot_sampler import OneShotSampler
from dse.loading.extensions import SAMPLERS
from dse.testing.samplers import SCALES, SamplerSuite

for _name in SAMPLERS.names():
    _members = {"sampler": SAMPLERS.get(_name), "listed": _name == "csv"}
    globals()[f"Test_{_name}"] = type(f"Test_{_name}", (SamplerSuite,), _members)


class Scaled(OneShotSampler):
    """Scales its points itself, linearly."""

    name: ClassVar[str] = "scaled"

    def points(self, brief):
        low, high = (np.array([getattr(variable, end) for variable in brief.variables]) for end in ("low", "high"))
        return low + np.array([[0.2, 0.3], [0.7, 0.8]]) * (high - low)


class Linear(Scaled):
    """The same past the check of points."""

    name: ClassVar[str] = "linear"

    def values(self, brief):
        return self.points(brief)


class Crowded(Scaled):
    """Declares that its points are spread over the whole, and has all of them at one end."""

    placing: ClassVar[Placing] = Placing.EVEN

    def points(self, brief):
        return np.linspace(0.0, 0.3, 80).reshape(40, 2)


def test_a_sampler_that_declares_even_points_and_has_others_fails():
    suite = SamplerSuite()
    suite.sampler = Crowded
    with pytest.raises(AssertionError):
        suite.test_what_it_declares_to_be_drawn_evenly_is(Crowded())


@pytest.mark.parametrize("key", SCALES)
def test_a_sampler_that_scales_points_itself_fails(key):
    def suite(sampler):
        found = SamplerSuite()
        found.sampler = sampler
        return found

    with pytest.raises(DseError, match="outside of the unit cube"):
        suite(Scaled).test_every_run_it_wants_lies_in_the_ranges(Scaled())
    with pytest.raises(AssertionError):
        suite(Linear).test_it_heeds_a_scale_values_and_a_distribution(Linear(), key)
