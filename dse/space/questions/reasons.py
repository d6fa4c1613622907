"""Why something cannot be chosen, for many scenarios at once; what has to be compiled for that is kept."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import partial

from dse.space.methods.engine import Engine
from dse.space.methods.mdd.diagram import Diagram
from dse.space.methods.mdd.scenarios import Scenarios, possible, whole
from dse.space.questions.minimal import minimal_conflict

Excludes = Callable[[Sequence[int]], bool]
"""Whether constraints, by number, leave nothing."""


class Reasons:
    """Smallest sets of an engine's constraints that exclude something.

    A set that explained one thing often explains the next: those that were found are tried first, so which of several
    is told may depend on what was asked before; each is minimal.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._diagrams: dict[frozenset[int], Diagram | None] = {}
        self._conflicts: list[tuple[int, ...]] = [(number,) for number in range(len(engine.flat.constraints))]

    def of(self, scenarios: Scenarios, groups: Iterable[int]) -> list[tuple[int, ...]]:
        """For each group, the bits of *scenarios* in none of which a row is valid: the constraints that say so.

        Their numbers, ascending; () if nothing is left whatever the constraints.
        """
        left: dict[frozenset[int], int] = {}

        def excludes(group: int, owners: Sequence[int]) -> bool:
            key = frozenset(owners)
            if key not in left:
                diagram = self._diagram(key)
                # Where it cannot be told, a constraint too much may be named, and never one too few.
                left[key] = -1 if diagram is None else whole(possible(diagram, scenarios))
            return not left[key] & group

        return [self._conflict(partial(excludes, group)) for group in groups]

    def _conflict(self, excludes: Excludes) -> tuple[int, ...]:
        if excludes(()):
            return ()
        for known in self._conflicts:
            if excludes(known) and not any(excludes(_without(known, each)) for each in known):
                return known
        every = range(len(self._engine.flat.constraints))
        found = minimal_conflict(every, lambda owners: not excludes(owners))
        self._conflicts = sorted([*self._conflicts, found], key=len)
        return found

    def _diagram(self, owners: frozenset[int]) -> Diagram | None:
        if owners not in self._diagrams:
            self._diagrams[owners] = self._engine.only(sorted(owners)).expanded
        return self._diagrams[owners]


def _without(numbers: Sequence[int], number: int) -> tuple[int, ...]:
    return tuple(each for each in numbers if each != number)
