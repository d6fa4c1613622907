"""Children of designs, all of them valid: wishes of both parents are granted as far as the design space allows."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.domain.sampler import Architecture, Architectures
from dse.errors import fail
from dse.exploration.optimization.designs import Cases, Design

if TYPE_CHECKING:
    from numpy.typing import NDArray

_CROSSED = 0.9
"""How often parents are crossed; else each child has all of one, but for mutations."""

_CHOOSING = 0.5
"""The same where there are choices: as many children are a parent with about one other choice."""

_SBX = 15.0
_MUTATION = 20.0
"""Distribution indices of simulated binary crossover and polynomial mutation (Deb and Agrawal 1995; Deb 2001)."""

_TURNS = 20
"""Rounds of drawing without enough new designs after which there are as many as there are."""

Wish = tuple[str, str | None]


class Breeding:
    """First designs and children, of the configurations of *space* and *variables* design variables."""

    def __init__(self, space: Architectures, variables: int) -> None:
        self._space = space
        self._variables = variables
        self._open = [place for place, choices in space.alternatives.items() if len(choices) > 1]

    def first(self, number: int, seed: int) -> list[Design]:
        """*number* on a Latin hypercube: in equal shares to the architectures, and drawn uniformly, in turns."""
        from scipy.stats.qmc import LatinHypercube

        unit = LatinHypercube(self._variables, seed=np.random.default_rng(seed)).random(number).tolist()
        drawn = self._space.stratified(number - number // 2, seed), self._space.draw(number // 2, seed)
        mixed = [drawn[place % 2][place // 2] for place in range(number)]
        return [Design(each, tuple(point)) for each, point in zip(mixed, unit, strict=True)]

    def begin(self, number: int, seed: int, cases: Cases) -> list[Design]:
        """As `fresh`. Raises DseError if there is none."""
        found = self.fresh(number, seed, cases)
        if not found:
            raise fail("the sampler finds no design that the constraints between variables allow")
        return found

    def fresh(self, number: int, seed: int, cases: Cases) -> list[Design]:
        """Up to *number* first designs that *cases* takes; more are drawn in place of those it does not."""
        found: list[Design] = []
        for turn in range(_TURNS):
            for design in self.first(number, seed + turn):
                if len(found) == number:
                    return found
                found += [design] * cases.take(design)
        return found

    def children(self, one: Design, other: Design, random: np.random.Generator) -> tuple[Design, Design]:
        """Two children of two parents, mutated."""
        is_crossed = random.random() < (_CHOOSING if self._open else _CROSSED)
        units = np.array([[one.unit], [other.unit]])
        if self._variables:
            units = _varied(units, is_crossed, random)
        parents = one.architecture, other.architecture
        made = [self._child(parents if is_crossed else (parent,), random) for parent in parents]
        return Design(made[0], tuple(units[0, 0].tolist())), Design(made[1], tuple(units[1, 0].tolist()))

    def _child(self, parents: Sequence[Architecture], random: np.random.Generator) -> Architecture:
        """All wishes of the parents in random order, after other choices at as many places as one on average."""
        wishes = [wish for parent in parents for wish in self._wishes(parent)]
        wishes = [wishes[index] for index in random.permutation(len(wishes)).tolist()]
        # At a place that is the only one every other child has to keep its parent's choice, or none is inherited.
        changes = int(random.binomial(len(self._open), min(0.5, 1 / len(self._open)))) if self._open else 0
        changed = [self._other(parents[0], random) for _ in range(changes)]
        return self._space.completed([*changed, *wishes], int(random.integers(1 << 31)))

    def _other(self, parent: Architecture, random: np.random.Generator) -> Wish:
        place = self._open[int(random.integers(len(self._open)))]
        others = [choice for choice in self._space.alternatives[place] if choice != parent.choices.get(place)]
        return place, others[int(random.integers(len(others)))]

    def _wishes(self, parent: Architecture) -> list[Wish]:
        """What a parent has, and what it leaves out where that can be chosen; else the place is not there anyway."""
        known = self._space.alternatives.items()
        there = [(place, parent.choices.get(place), choices) for place, choices in known]
        return [(place, choice) for place, choice, choices in there if choice is not None or None in choices]


def _varied(units: NDArray[np.float64], is_crossed: bool, random: np.random.Generator) -> NDArray[np.float64]:
    """Points of the unit cube, (2, 1, variables), crossed and mutated."""
    from pymoo.operators.crossover.sbx import cross_sbx
    from pymoo.operators.mutation.pm import mut_pm

    width = units.shape[2]
    low, high = np.zeros(width), np.ones(width)
    if is_crossed:
        half = np.full((1, 1), 0.5)
        units = cross_sbx(units, low, high, np.full((1, 1), _SBX), 0.5, half, random_state=random)
    share = np.full(2, min(0.5, 1 / width))
    mutated = mut_pm(units[:, 0], low, high, np.full(2, _MUTATION), share, at_least_once=False, random_state=random)
    return np.asarray(np.clip(mutated, 0.0, 1.0), dtype=np.float64)[:, None, :]
