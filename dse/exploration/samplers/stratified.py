"""Configurations in equal shares to the architectures, each with points of its own."""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar

from dse.domain.sampler import Architecture, Architectures
from dse.exploration.samplers.uniform import Uniform


class Stratified(Uniform):
    """As `Uniform`, but drawn in equal shares to the branches of each decision that brings others along.

    Uniform draws favour the architecture with the most configurations below it. One with fewer than its share has them
    all drawn several times, each time with other points.
    """

    name: ClassVar[str] = "stratified"

    def drawn(self, space: Architectures, seed: int) -> Sequence[Architecture]:
        """The configurations; some may come several times."""
        return space.stratified(self.configurations, seed)


SAMPLER = Stratified
