"""Many narrowings of one diagram answered at once: one bit of a machine word for each."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.space.methods.mdd.diagram import DecisionDiagram

ScenarioBits = NDArray[np.uint64]
"""Bits of scenarios: the last axis has a word for each 64 of them."""

_BITS = 64


@dataclass(frozen=True, slots=True, eq=False)
class Scenarios:
    """*number* of narrowings; allowed[variable], shape (values + 1, words), tells in which each value may be taken.

    A variable that is not in *allowed* may take any value in all of them.
    """

    number: int
    allowed: Mapping[int, ScenarioBits]

    def all(self) -> ScenarioBits:
        """The bits of every scenario, shape (words,)."""
        return bits_of(range(self.number), self.number)


def bits_of(scenarios: Iterable[int], number: int) -> ScenarioBits:
    """The bits of some of *number* scenarios, shape (words,)."""
    bits = np.zeros(-(-number // _BITS), np.uint64)
    for scenario in scenarios:
        bits[scenario // _BITS] |= np.uint64(1 << scenario % _BITS)
    return bits


def whole(words: ScenarioBits) -> int:
    """Bits of shape (words,) as one number."""
    return sum(int(word) << _BITS * place for place, word in enumerate(words.tolist()))


def possible(diagram: DecisionDiagram, scenarios: Scenarios) -> ScenarioBits:
    """In which scenarios any row is left, shape (words,)."""
    return _alive(diagram, scenarios)[0][0] if not diagram.empty else np.zeros_like(scenarios.all())


def taken(diagram: DecisionDiagram, scenarios: Scenarios) -> tuple[ScenarioBits, ...]:
    """For each variable in file order: in which scenarios a row is left that takes each value, (values + 1, words)."""
    nothing = np.zeros(len(scenarios.all()), np.uint64)
    found = [np.zeros((len(each.values) + 1, len(nothing)), np.uint64) for each in diagram.flat.variables]
    if diagram.empty:
        return tuple(found)
    alive = _alive(diagram, scenarios)
    reached = scenarios.all()[None]
    for variable, layer, after in zip(diagram.order, diagram.layers, alive[1:], strict=True):
        # Bits of rows through an edge: down to its node, along it, and on to the end.
        through = reached[:, None] & np.append(after, nothing[None], axis=0)[layer]
        allowed = scenarios.allowed.get(variable)
        if allowed is not None:
            through &= allowed
        found[variable] = np.bitwise_or.reduce(through, axis=0)
        reached = np.zeros_like(after)
        there = layer >= 0
        np.bitwise_or.at(reached, layer[there], through[there])
    return tuple(found)


def _alive(diagram: DecisionDiagram, scenarios: Scenarios) -> list[ScenarioBits]:
    """In which scenarios each node has a way to the end: per layer, (nodes, words), the terminal's layer included."""
    bits = scenarios.all()[None]
    alive = [bits]
    for variable, layer in zip(reversed(diagram.order), reversed(diagram.layers), strict=True):
        # The child -1 finds the nothing at the end.
        below = np.append(bits, np.zeros_like(bits[:1]), axis=0)[layer]
        allowed = scenarios.allowed.get(variable)
        bits = np.bitwise_or.reduce(below if allowed is None else below & allowed, axis=1)
        alive.append(bits)
    return alive[::-1]
