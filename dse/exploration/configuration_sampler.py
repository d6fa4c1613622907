"""What samplers that choose configurations themselves have in common."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar

from dse.domain.sampler import Architectures, Brief, Candidate, Grid, Outcomes, Search
from dse.errors import fail
from dse.exploration.one_shot_sampler import require_few
from dse.exploration.variables import at_conditions, free
from dse.loading import SamplerSection

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    Array = NDArray[np.float64]


class ConfigurationSampler(SamplerSection):
    """A sampler that asks once, for configurations it chooses, each with points of its own."""

    once: ClassVar[bool] = True
    proposes: ClassVar[bool] = True

    @property
    def grid(self) -> Grid | None:
        """The points may lie anywhere."""
        return None

    @abstractmethod
    def designs(self, brief: Brief, space: Architectures) -> Iterable[tuple[str, Array]]:
        """Configurations of *space* by id, and points, (n, variables), of the *brief*'s, none of which is a condition.

        The same brief gives the same.
        """

    def start(self, brief: Brief) -> Search:
        """Asks once, for those of the designs that are allowed, each at every condition."""
        asked: dict[Candidate, None] = {}
        for name, points in self.designs(replace(brief, variables=free(brief), conditions=()), space_of(brief)):
            whole = at_conditions(points, brief)
            kept = whole if brief.allowed is None else whole[brief.allowed(whole)]
            asked.update(dict.fromkeys(Candidate(name, tuple(point)) for point in kept.tolist()))
            require_few(len(asked), None)
        return _Asked(list(asked))


def space_of(brief: Brief) -> Architectures:
    """What the configurations are proposed from. Raises DseError if the study has none."""
    if brief.space is None:
        raise fail("the sampler chooses configurations itself, and the study has no design space to choose from")
    return brief.space


class _Asked:
    def __init__(self, candidates: Sequence[Candidate]) -> None:
        self._candidates = candidates

    def ask(self) -> Sequence[Candidate]:
        """All of them; nothing the second time."""
        asked, self._candidates = self._candidates, ()
        return asked

    def tell(self, outcomes: Outcomes) -> None:
        """Nothing depends on results."""
