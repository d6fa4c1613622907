"""Rows that meet preferences, where sums or the like are in no diagram: the space is narrowed, and searched."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from dse.space.flat import Bools, Ints, Rows
from dse.space.methods.budget import TooMuchError
from dse.space.methods.completion.layers import LayeredCompletion
from dse.space.methods.completion.preferences import Preference
from dse.space.methods.engine import Engine
from dse.space.methods.listing.blocks import first
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.mdd.diagram import DecisionDiagram, restrict
from dse.space.methods.mdd.expand import expand
from dse.space.methods.mdd.growth import TooWideError

_TRIES = 16
"""Rows drawn before the space is narrowed."""

_STEP = 2
"""So many preferences more are given up each time."""

_NODES = 20_000
"""Nodes before reduction of what is left of a diagram, with the sums compiled in."""

_TOGETHER = 20
"""Preferences looked at together: an optimum of larger numbers is harder to prove."""


class Completion(Protocol):
    """Completes rows of a space."""

    def row(self, preferences: Sequence[Preference], random: np.random.Generator) -> Rows:
        """A row that meets *preferences* in their order, uniform among those that do; shape (variables,)."""


def completion(engine: Engine) -> Completion:
    """By the diagram of all rules, else by narrowing. Raises DseError if there is no row.

    A pass over a diagram of ten thousand nodes takes half a millisecond; to narrow and search takes from 10 ms up to
    seconds, where the sums that no diagram holds stand in the way, or there is no diagram.
    """
    if engine.is_empty():
        raise engine.nothing()
    if engine.expanded is not None:
        return LayeredCompletion(engine.expanded)
    return NarrowedCompletion(engine) if engine.diagram is None else DiagramCompletion(engine, engine.diagram)


class DiagramCompletion:
    """Completes rows by the diagram of an *engine* that some sums or the like are not in, and whose space has a row.

    The diagram tells what could be met at most; a row that is drawn from there and meets the sums, too, is what is
    wanted. If none does, the last of these preferences are given up, a few and then more, until there is a row with the
    others: then these are met in any case, and mostly so little is left of the diagram that the sums fit into it.
    Where they do not, the preferences that follow are looked at one by one until they do.
    """

    def __init__(self, engine: Engine, diagram: DecisionDiagram) -> None:
        self._engine = engine
        self._diagram = diagram
        self._recheck = recheck(engine.flat)
        self._loose = LayeredCompletion(diagram)

    def row(self, preferences: Sequence[Preference], random: np.random.Generator) -> Rows:
        """A row that meets *preferences* in their order, uniform among those that do; shape (variables,).

        Raises DseError where that cannot be found out.
        """
        rows = self._loose.rows(preferences, random, _TRIES)
        valid = np.flatnonzero(self._recheck.valid(rows))
        if len(valid):
            row: Rows = rows[valid[0]]
            return row
        try:
            found = self._sought([preference for preference in preferences if preference.is_met(rows[0])], random)
        except TooMuchError:
            found = None
        return NarrowedCompletion(self._engine).row(preferences, random) if found is None else found

    def _sought(self, likely: Sequence[Preference], random: np.random.Generator) -> Rows | None:
        """The row wanted; None if a preference is not for one variable. *likely* would be met if there were no sums."""
        if any(preference.masks() is None for preference in likely):
            return None
        number, left, whole = len(likely), self._diagram, None
        while whole is None or whole.empty:
            number = max(number - _STEP, 0)
            left = restrict(self._diagram, _masks(likely[:number]))
            whole = _expanded(left)
            if whole is None and first(left) is not None:
                break
            if not number:
                break
        for place in range(number, len(likely)):
            if whole is not None:
                return LayeredCompletion(whole).row(likely[place:], random)
            narrowed = restrict(left, _masks(likely[place : place + 1]))
            if first(narrowed) is not None:
                left, whole = narrowed, _expanded(narrowed)
        return None if whole is None else LayeredCompletion(whole).row((), random)


class NarrowedCompletion:
    """Completes rows of an *engine* whose space has a row, whatever it answers by.

    The row that is worth most is sought by the exact optimum of a sum, and what is left open is drawn from the space
    that is narrowed to what it meets.
    """

    def __init__(self, engine: Engine) -> None:
        self._engine = engine

    def row(self, preferences: Sequence[Preference], random: np.random.Generator) -> Rows:
        """A row that meets *preferences* in their order, uniform among those that do; shape (variables,).

        Raises DseError where that cannot be found out.
        """
        engine = self._engine
        for start in range(0, len(preferences), _TOGETHER):
            engine = _narrowed(engine, preferences[start : start + _TOGETHER])
        row: Rows = engine.sample(1, int(random.integers(1 << 62)))[0]
        return row


def _masks(preferences: Sequence[Preference]) -> dict[int, Bools]:
    return {variable: mask for preference in preferences for variable, mask in (preference.masks() or {}).items()}


def _expanded(diagram: DecisionDiagram) -> DecisionDiagram | None:
    try:
        return expand(diagram, _NODES)
    except TooWideError:
        return None


def _narrowed(engine: Engine, preferences: Sequence[Preference]) -> Engine:
    """*engine* narrowed to those of *preferences* that can be had."""
    penalty: dict[int, Ints] = {}
    for rank, preference in enumerate(reversed(preferences)):
        for variable, marks in preference.marks.items():
            penalty[variable] = penalty.get(variable, 0) - (marks << rank)
    try:
        row = engine.least(penalty, 1)[0]
    except TooMuchError:
        for preference in preferences:
            narrowed = engine.having(*preference.rules())
            engine = engine if narrowed.is_empty() else narrowed
        return engine
    return engine.having(*(rule for preference in preferences if preference.is_met(row) for rule in preference.rules()))
