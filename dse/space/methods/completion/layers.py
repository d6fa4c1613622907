"""Rows that meet preferences, from a diagram that holds every rule: one pass up its layers and one walk down.

A preference is worth twice all that come after it together, so the paths of greatest worth are those that meet the
preferences in their order. A node keeps the worth of its best completions and in how many ways there are such.

Example: three preferences are worth 4, 2 and 1. A row with only the first (4) beats one with both others (3); among
rows with the first, one that also has the third (5) is best if none has the second. Of equal rows one is drawn.

Cost: a pass over ten thousand nodes takes half a millisecond. Where the sums fit into no diagram,
`dse.space.methods.completion.completion` narrows the space first: 2 to 60 ms a row, against 160 to 460 ms by an exact
optimum (docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import ABSENT, Floats, Ints, Rows
from dse.space.methods.completion.preferences import Preference
from dse.space.methods.mdd.diagram import DecisionDiagram

_TOGETHER = 60
"""Preferences whose worth a machine word holds."""

_NOTHING = -(1 << 62)
"""Worth of no completion: less than any, and twice that still fits."""

_LARGE = 2.0**500
"""Ways above which those of a layer are counted in a larger unit: only their ratios matter."""

Children = Sequence[NDArray[Any]]
"""By layer, shape (values + 1, nodes): a node of the next layer; one more than there are for none."""


class LayeredCompletion:
    """Completes rows by a *diagram* that is not empty and whose layers hold all rules."""

    def __init__(self, diagram: DecisionDiagram) -> None:
        self._diagram = diagram
        # Without choices there is no layer, and so no next one.
        self._none = [*map(len, diagram.layers), 1][1:]
        self._children = [
            np.ascontiguousarray(np.where(layer < 0, none, layer).T)
            for layer, none in zip(diagram.layers, self._none, strict=True)
        ]

    def row(self, preferences: Sequence[Preference], random: np.random.Generator) -> Rows:
        """A row that meets *preferences* in their order, uniform among those that do; shape (variables,)."""
        row: Rows = self.rows(preferences, random, 1)[0]
        return row

    def rows(self, preferences: Sequence[Preference], random: np.random.Generator, number: int) -> Rows:
        """*number* such rows, drawn independently; shape (number, variables)."""
        children: Children = self._children
        while len(preferences) > _TOGETHER:
            ways = self._best(children, preferences[:_TOGETHER])
            children = [
                np.where(way > 0, child, none) for way, child, none in zip(ways, children, self._none, strict=True)
            ]
            preferences = preferences[_TOGETHER:]
        ways = self._best(children, preferences)
        rows = np.full((number, len(self._diagram.flat.variables)), ABSENT, np.int16)
        for row, chances in zip(rows, random.random((number, len(ways))).tolist(), strict=True):
            node = 0
            for variable, below, through, chance in zip(self._diagram.order, children, ways, chances, strict=True):
                value = _drawn(through[:, node].tolist(), chance)
                node = int(below[value, node])
                if value < len(below) - 1:
                    row[variable] = value
        return rows

    def _best(self, children: Children, preferences: Sequence[Preference]) -> list[Floats]:
        """The ways through each of *children* that are on the best paths, in a unit of the layer; else 0."""
        worth: dict[int, Ints] = {}
        for rank, preference in enumerate(reversed(preferences)):
            for variable, marks in preference.marks.items():
                worth[variable] = worth.get(variable, 0) + (marks << rank)
        best, ways = np.array([0, _NOTHING]), np.array([1.0, 0.0])
        found: list[Floats] = []
        for variable, child in zip(reversed(self._diagram.order), reversed(children), strict=True):
            reached = best[child]
            if variable in worth:
                reached += worth[variable][:, None]
            best = np.full(child.shape[1] + 1, _NOTHING)
            reached.max(axis=0, out=best[:-1])
            through = ways[child]
            through *= reached == best[:-1]
            ways = np.zeros(child.shape[1] + 1)
            through.sum(axis=0, out=ways[:-1])
            most = float(ways.max())
            if most > _LARGE:
                np.maximum(ways[:-1] / most, np.finfo(np.float64).tiny, out=ways[:-1])
            found.append(through)
        return found[::-1]


def _drawn(amounts: Sequence[float], chance: float) -> int:
    """The place that *chance* in [0, 1) falls on among *amounts*, one of which is positive."""
    left = chance * sum(amounts)
    found = 0
    for place, amount in enumerate(amounts):
        if amount > 0:
            found = place
            left -= amount
            if left < 0:
                break
    return found
