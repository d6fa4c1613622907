"""Central composite designs: corners, axes and centre, what a quadratic model needs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self

from dse.domain.sampler import Brief
from dse.errors import fail
from dse.exploration.one_shot_sampler import ValueSampler
from dse.exploration.variables import scaled
from dse.loading import Surroundings

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

_MOST_VARIABLES = 16


class CentralComposite(ValueSampler):
    """The centre of the ranges, two points on each axis through it, and the corners of a cube (Box, Wilson 1951).

    *inscribed*: the axes reach to the ends of the ranges, and the corners are 2^(k/4) times nearer for k variables, so
    that all directions count alike (rotatable). *faced*: the corners are those of the ranges.
    """

    name: ClassVar[str] = "central_composite"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({}, {"corners": "faced"})

    corners: Literal["inscribed", "faced"] = "inscribed"

    def settled(self, around: Surroundings) -> Self:
        """Raises DseError for more variables than have a sensible number of corners."""
        if len(around.variables) > _MOST_VARIABLES:
            what = f"{len(around.variables)} design variables have 2^{len(around.variables)} corners"
            where = around.entry.document.top["sampler"].key
            raise fail(what, where, f"take at most {_MOST_VARIABLES}, or a sampler such as sobol")
        return self

    def values(self, brief: Brief) -> NDArray[np.float64]:
        """The centre, then the axes, then the corners, each once."""
        import numpy as np

        parts = dict.fromkeys(self._parts(len(brief.variables)))
        return scaled((1.0 + np.array([*parts])) / 2.0, brief.variables)

    def _parts(self, count: int) -> Iterator[tuple[float, ...]]:
        """Points of the cube from -1 to 1."""
        yield (0.0,) * count
        for axis in range(count):
            for end in (-1.0, 1.0):
                yield tuple(end if k == axis else 0.0 for k in range(count))
        near = 1.0 if self.corners == "faced" else 2.0 ** (-count / 4)
        yield from product((-near, near), repeat=count)


SAMPLER = CentralComposite
