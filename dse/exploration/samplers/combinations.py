"""Every combination of choices, with the same points each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Architecture, Architectures, Brief, Placing
from dse.errors import Problem, closest, fail, raise_if_any
from dse.exploration.configuration_sampler import ConfigurationSampler
from dse.exploration.one_shot_sampler import MOST_RUNS
from dse.exploration.variables import scaled

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

Wishes = tuple[tuple[str, str | None], ...]

_MOST = 100_000
"""Combinations that are made; more are refused."""


class Combinations(ConfigurationSampler):
    """A configuration for every combination of what can be chosen at the places of *choices*, all places if there are
    none, that a valid one has; what they leave open is drawn. With *samples* points of a Latin hypercube, the same for
    each.
    """

    name: ClassVar[str] = "combinations"
    placing: ClassVar[Placing] = Placing.EVEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({}, {"choices": ["s"], "samples": 3})

    choices: list[str] = Field(default_factory=list)
    samples: int = Field(default=1, ge=1, le=MOST_RUNS)

    def designs(self, brief: Brief, space: Architectures) -> Iterator[tuple[str, Array]]:
        """The combinations, the last place the fastest. Raises DseError if there are too many."""
        import numpy as np
        from scipy.stats.qmc import LatinHypercube

        raise_if_any(
            Problem(f"the sampler 'combinations': there is no '{place}' to choose at", None, closest(place, known))
            for known in [space.alternatives]
            for place in self.choices
            if place not in known
        )
        random = np.random.default_rng(brief.seed)
        unit = LatinHypercube(len(brief.variables), seed=random).random(self.samples)
        points = scaled(unit, brief.variables, brief.correlations)
        seen: set[str] = set()
        for each in _combined(space, (), self.choices or list(space.alternatives), brief.seed):
            if each.id not in seen:
                seen.add(each.id)
                if len(seen) > _MOST:
                    what = f"the sampler 'combinations': there are more than {_MOST:,} combinations"
                    raise fail(what, None, "name fewer places under 'choices', or take 'uniform' or 'stratified'")
                yield each.id, points


def _combined(space: Architectures, wishes: Wishes, places: Sequence[str], seed: int) -> Iterator[Architecture]:
    """A valid configuration for each way to choose at *places* that goes with *wishes*, which can be had."""
    if not places:
        yield space.completed(wishes, seed)
        return
    place, *others = places
    for choice in dict.fromkeys((*space.alternatives[place], None)):
        # None, too, where the file has no such alternative: the place need not be there.
        if space.completed((*wishes, (place, choice)), seed).choices.get(place) == choice:
            yield from _combined(space, (*wishes, (place, choice)), others, seed)


SAMPLER = Combinations
