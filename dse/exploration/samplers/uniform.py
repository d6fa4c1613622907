"""Configurations drawn from the whole design space, each with points of its own."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field

from dse.domain.sampler import Architecture, Architectures, Brief, Placing
from dse.exploration.configuration_sampler import ConfigurationSampler
from dse.exploration.one_shot_sampler import MOST_RUNS
from dse.exploration.variables import scaled, unit_of

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]

_MOST_DRAWS = 64
"""Draws for each configuration that is wanted: after so many, what did not come is not there, but for bad luck."""


class Uniform(ConfigurationSampler):
    """*configurations* different ones, each valid one as likely as any other, with *samples* points each.

    All points together are a sliced Latin hypercube (Qian 2012): those of each configuration have one in each of
    *samples* equal strata of every variable, those of all have one in each of as many strata as there are points. In a
    study that is extended, configurations and points that are there stay.
    """

    name: ClassVar[str] = "uniform"
    placing: ClassVar[Placing] = Placing.EVEN
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"configurations": 3}, {"configurations": 4, "samples": 3})

    configurations: int = Field(ge=1, le=MOST_RUNS)
    samples: int = Field(default=1, ge=1, le=MOST_RUNS)

    def drawn(self, space: Architectures, seed: int) -> Sequence[Architecture]:
        """The configurations; fewer if there are no more."""
        number = self.configurations
        found: dict[str, Architecture] = {}
        while len(found) < self.configurations and number <= _MOST_DRAWS * self.configurations:
            # The first of more draws are the same.
            found = {each.id: each for each in space.draw(number, seed)}
            number *= 2
        return list(found.values())[: self.configurations]

    def designs(self, brief: Brief, space: Architectures) -> Iterator[tuple[str, Array]]:
        """Those drawn, in their order."""
        import numpy as np

        drawn = self.drawn(space, brief.seed)
        slices = _sliced(len(drawn), self.samples, len(brief.variables), np.random.default_rng(brief.seed))
        there = _points_there(brief)
        for each, unit in zip(drawn, slices, strict=True):
            known = there.get(each.id, [])
            taken = known[: self.samples]
            old = np.array(taken).reshape(len(taken), len(brief.variables))
            # Drawn again, it has the others.
            there[each.id] = known[self.samples :]
            fresh = _without_nearest(unit, unit_of(old, brief.variables))
            yield each.id, np.concatenate([old, scaled(fresh, brief.variables, brief.correlations)])


def _sliced(slices: int, samples: int, variables: int, random: np.random.Generator) -> Array:
    """Points of the unit cube, (slices, samples, variables)."""
    import numpy as np

    # Of the fine strata in each coarse one, every slice gets one; in a slice, they are in random order.
    fine = random.permuted(np.tile(np.arange(slices), (samples, variables, 1)), axis=2)
    strata = fine.transpose(2, 0, 1) + slices * np.arange(samples)[None, :, None]
    mixed = random.permuted(strata, axis=1)
    return np.asarray((mixed + random.random(mixed.shape)) / (slices * samples), dtype=np.float64)


def _points_there(brief: Brief) -> dict[str, list[tuple[float, ...]]]:
    """Points within the ranges that there are runs of, by configuration, in the order of the runs."""
    columns = [brief.earlier.points[variable.name].tolist() for variable in brief.variables]
    found: dict[str, dict[tuple[float, ...], None]] = {}
    for name, *point in zip(brief.earlier.configurations, *columns, strict=True):
        if all(v.low <= value <= v.high for v, value in zip(brief.variables, point, strict=True)):
            found.setdefault(name, {})[tuple(point)] = None
    return {name: list(points) for name, points in found.items()}


def _without_nearest(unit: Array, old: Array) -> Array:
    """*unit* without a point for each of *old*: the nearest that is left, its place being taken."""
    import numpy as np

    for point in old:
        nearest = np.argmin(np.round(((unit - point) ** 2).sum(axis=1), 12))
        unit = np.delete(unit, nearest, axis=0)
    return unit


SAMPLER = Uniform
