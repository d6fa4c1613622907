"""Every valid row of a space by depth-first search with propagation, where a decision diagram would be too large.

Complete, slower than a diagram, and without one: memory is that of the rules and one row.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from dse.space.flat import ABSENT, FlatSpace, Rows
from dse.space.methods.budget import TooMuchError
from dse.space.methods.listing.propagators import Propagator, propagators
from dse.space.methods.listing.recheck import recheck

_BLOCK = 256


@dataclass(slots=True)
class Effort:
    """What propagation may still cost: *left* counts the variables of rules looked at. Whoever searches spends it."""

    left: int


def rows(flat: FlatSpace, most_nodes: int | None = None, effort: Effort | None = None) -> Iterator[Rows]:
    """Every valid row, shape (variables,), in lexicographic order of value numbers in the order of the file.

    Every row was checked again against the rules themselves; RuntimeError if one failed. Raises TooMuchError
    when more than *most_nodes* values had to be tried, or *effort* is spent, which may be renewed between rows.
    """
    check = recheck(flat)
    waiting: list[Rows] = []
    block = 1
    for row in _Search(flat, most_nodes, effort).rows():
        waiting.append(row)
        if len(waiting) == block:
            yield from check.insist(np.array(waiting))
            waiting, block = [], min(2 * block, _BLOCK)
    if waiting:
        yield from check.insist(np.array(waiting))


def first(flat: FlatSpace, most_nodes: int | None = None, effort: Effort | None = None) -> Rows | None:
    """The first valid row, shape (variables,); None if there is none, which is then proven. Raises like `rows`."""
    return next(rows(flat, most_nodes, effort), None)


class _Search:
    """Domains, and the trail by which they are restored."""

    def __init__(self, flat: FlatSpace, most_nodes: int | None, effort: Effort | None) -> None:
        self.domains = [
            (1 << len(variable.values)) - 1 if variable.parent is None else (2 << len(variable.values)) - 1
            for variable in flat.variables
        ]
        self._absent = [len(variable.values) for variable in flat.variables]
        self._left = most_nodes
        self._effort = effort
        self._trail: list[tuple[int, int]] = []
        self._propagators = propagators(flat)
        self._watching: list[list[int]] = [[] for _ in flat.variables]
        for number, propagator in enumerate(self._propagators):
            for variable in propagator.scope:
                self._watching[variable].append(number)
        self._waiting: deque[int] = deque()
        self._queued = [False] * len(self._propagators)

    def rows(self) -> Iterator[Rows]:
        self._wake(range(len(self._propagators)))
        if not all(self.domains) or not self._settle():
            return
        decisions: list[tuple[int, int, int]] = []
        place = 0
        while True:
            while place < len(self.domains) and not self.domains[place] & (self.domains[place] - 1):
                place += 1
            if place < len(self.domains):
                lowest = self.domains[place] & -self.domains[place]
                decisions.append((place, lowest, len(self._trail)))
                if self._try(place, lowest):
                    continue
            else:
                yield self._row()
            # Back to the last decision whose other values can still be.
            while decisions:
                place, tried, mark = decisions.pop()
                self._undo(mark)
                if self._try(place, self.domains[place] & ~tried):
                    break
            else:
                return

    def _try(self, variable: int, mask: int) -> bool:
        if self._left is not None:
            if not self._left:
                raise TooMuchError
            self._left -= 1
        return self._restrict(variable, mask) and self._settle()

    def _restrict(self, variable: int, mask: int) -> bool:
        before = self.domains[variable]
        after = before & mask
        if after != before:
            self._trail.append((variable, before))
            self.domains[variable] = after
            self._wake(self._watching[variable])
        return after != 0

    def _wake(self, numbers: range | list[int]) -> None:
        for number in numbers:
            if not self._queued[number]:
                self._queued[number] = True
                self._waiting.append(number)

    def _settle(self) -> bool:
        while self._waiting:
            number = self._waiting.popleft()
            self._queued[number] = False
            propagator: Propagator = self._propagators[number]
            if self._effort is not None:
                self._effort.left -= len(propagator.scope) + 1
                if self._effort.left < 0:
                    raise TooMuchError
            if not propagator.revise(self.domains, self._restrict):
                return False
        return True

    def _undo(self, mark: int) -> None:
        for number in self._waiting:
            self._queued[number] = False
        self._waiting.clear()
        while len(self._trail) > mark:
            variable, before = self._trail.pop()
            self.domains[variable] = before

    def _row(self) -> Rows:
        found = [domain.bit_length() - 1 for domain in self.domains]
        return np.array(
            [ABSENT if value == absent else value for value, absent in zip(found, self._absent, strict=True)], np.int16
        )
