"""Choosing one configuration step by step: what can still be picked, how much is left, and what follows by itself."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, floor

import numpy as np

from dse.space.configurations.ids import IdentifiedChoices
from dse.space.flat import Linear, Variable
from dse.space.methods.engine import Engine
from dse.space.methods.mdd.diagram import DecisionDiagram, extremes
from dse.space.methods.tally import Tally
from dse.space.output.sums import PropertySum

ValuePick = tuple[int, int]
"""A decision by the number of its variable, and one of its values."""

PICKING_HALF_WIDTH = 0.02
"""Half-width of an estimated count; people wait for it."""

_MORE = 10**18


@dataclass(frozen=True, slots=True)
class Option:
    """A value of a decision, None for leaving the part out, and how many configurations are left if it is picked."""

    value: int
    name: str | None
    tally: Tally

    @property
    def is_possible(self) -> bool:
        """Whether any configuration is left with it; an estimate is never of nothing."""
        return self.tally.value > 0 or not self.tally.exact


@dataclass(frozen=True, slots=True)
class Range:
    """What a sum can still be, in its unit; *exact* if both ends are reached, else they are bounds."""

    total: PropertySum
    low: float
    high: float
    exact: bool


class Picking:
    """A space narrowed by *picks*, in the order they were made; never changed, each step makes a new one.

    *totals* are the sums whose ranges are asked for.
    """

    def __init__(self, engine: Engine, totals: tuple[PropertySum, ...] = (), picks: tuple[ValuePick, ...] = ()) -> None:
        self.engine = engine
        self.totals = totals
        self.picks = picks

    @property
    def variables(self) -> tuple[Variable, ...]:
        """Every decision; it exists only where its parent, if it has one, says so."""
        return self.engine.flat.variables

    def reset(self) -> Picking:
        """Without any pick."""
        return self._with(())

    def pick(self, variable: int, value: int) -> Picking:
        """With *value* picked, instead of another one, and without picks that this takes away."""
        return self._with((*self._without(variable, value), (variable, value)))

    def unpick(self, variable: int) -> Picking:
        """Without the pick of a decision, and without those that exist because of it."""
        return self._with(self._without(variable))

    def picked(self, variable: int) -> int | None:
        """The value picked for a decision; None if it is open or follows from others."""
        return dict(self.picks).get(variable)

    @cached_property
    def left(self) -> Tally:
        """How many valid configurations are left."""
        return self._narrowed.count(relative=PICKING_HALF_WIDTH)

    @cached_property
    def decisions(self) -> tuple[int, ...]:
        """The decisions that exist in every configuration left, in the order of the file."""
        return tuple(number for number in range(len(self.variables)) if self._exists(number))

    @cached_property
    def open(self) -> tuple[int, ...]:
        """The decisions that can still be made in several ways."""
        return tuple(number for number in self.decisions if number not in self._settled)

    @cached_property
    def is_complete(self) -> bool:
        """Whether a single configuration is left."""
        return self.left.value > 0 and not self.open

    def options(self, variable: int) -> tuple[Option, ...]:
        """What a decision that exists can be: with all other picks as they are."""
        picked = self.picked(variable)
        basis = self if picked is None else self.unpick(variable)
        names = self.variables[variable].values
        tallies = basis.tallies[variable]
        return tuple(
            Option(value, name, self.left if value == picked else tally)
            for value, (name, tally) in enumerate(zip(names, tallies, strict=True))
        )

    def settled(self, variable: int) -> int | None:
        """The value that a decision has, picked or forced; None while it is open."""
        return self._settled.get(variable)

    def first(self) -> IdentifiedChoices | None:
        """The first configuration left; None if there is none."""
        row = self._narrowed.first()
        return None if row is None else IdentifiedChoices(self.engine.flat.choices(row))

    def ranges(self) -> tuple[Range, ...]:
        """What each of *totals* can still be; not those of more than 64 bits, and none without a diagram."""
        layers = self._narrowed.expanded or self._narrowed.diagram
        if layers is None or layers.empty:
            return ()
        return tuple(self._range(layers, total) for total in self.totals if total.is_small)

    def _with(self, picks: tuple[ValuePick, ...]) -> Picking:
        return Picking(self.engine, self.totals, picks)

    @cached_property
    def _narrowed(self) -> Engine:
        if not self.picks:
            return self.engine
        rules = [self.engine.flat.taking(variable, value) for variable, value in self.picks]
        return self.engine.having(*rules)

    @cached_property
    def tallies(self) -> tuple[tuple[Tally, ...], ...]:
        """For each variable and value, how many configurations are left with it."""
        times = self._narrowed.times_taken()
        if times is not None:
            return tuple(tuple(Tally(number) for number in found[:-1]) for found in times)
        if not self.left.value:
            return tuple((Tally(0),) * len(variable.values) for variable in self.variables)
        shares = self._narrowed.shares()
        return tuple(
            tuple(
                self._estimated(number, value, float(shares.shares[number][value]), float(half_widths[value]))
                for value in range(len(variable.values))
            )
            for number, (variable, half_widths) in enumerate(zip(self.variables, shares.half_widths, strict=True))
        )

    def _estimated(self, variable: int, value: int, share: float, half_width: float) -> Tally:
        if not share and self._narrowed.having(self.engine.flat.taking(variable, value)).is_empty():
            return Tally(0)
        left = self.left
        low, high = (left.value, left.value) if left.exact else (left.low, left.high)
        ends = _part(low, max(share - half_width, 0.0)), _part(high, min(share + half_width, 1.0))
        return Tally(_part(left.value, share), False, floor(ends[0]), ceil(ends[1]))

    @cached_property
    def _settled(self) -> dict[int, int]:
        settled: dict[int, int] = {}
        picks = dict(self.picks)
        for number, variable in enumerate(self.variables):
            if variable.parent is not None and settled.get(variable.parent[0]) != variable.parent[1]:
                continue
            possible = [option for option, tally in enumerate(self.tallies[number]) if tally.value or not tally.exact]
            if number in picks:
                settled[number] = picks[number]
            elif len(possible) == 1:
                settled[number] = possible[0]
        return settled

    def _exists(self, variable: int) -> bool:
        parent = self.variables[variable].parent
        return parent is None or self._settled.get(parent[0]) == parent[1]

    def _without(self, variable: int, kept: int | None = None) -> tuple[ValuePick, ...]:
        """The picks of other decisions, without those below a branch of *variable* other than *kept*."""
        gone = {variable}
        for number, below in enumerate(self.variables):
            if below.parent is not None and below.parent[0] in gone and below.parent != (variable, kept):
                gone.add(number)
        return tuple(pick for pick in self.picks if pick[0] not in gone)

    def _range(self, layers: DecisionDiagram, total: PropertySum) -> Range:
        least, greatest = extremes(layers, total.weights)
        low, high = int(least[0][0]), int(greatest[0][0])
        if not layers.expanded:
            for linear in self.engine.flat.linears():
                low, high = _within(layers, linear, total, low, high)
        is_exact = layers.expanded or not (self.engine.flat.linears() or self.engine.flat.wides())
        return Range(total, total.shown(total.start + low), total.shown(total.start + high), is_exact)


def _part(whole: int, share: float) -> int:
    return whole * round(share * _MORE) // _MORE


def _within(layers: DecisionDiagram, linear: Linear, total: PropertySum, low: int, high: int) -> tuple[int, int]:
    """The range cut by a rule on the same sum: one that differs by the same number in every row."""
    times = linear.scale / total.scale
    if times.denominator != 1:
        return low, high
    length = {number: len(variable.values) + 1 for number, variable in enumerate(layers.flat.variables)}
    nothing = {number: np.zeros(length[number], np.int64) for number in {*linear.weights, *total.weights}}
    difference = {
        number: total.weights.get(number, zeros) - int(times) * linear.weights.get(number, zeros)
        for number, zeros in nothing.items()
    }
    least, greatest = (int(ends[0][0]) for ends in extremes(layers, difference))
    if least != greatest:
        return low, high
    if linear.low is not None:
        low = max(low, linear.low * int(times) + least)
    if linear.high is not None:
        high = min(high, linear.high * int(times) + least)
    return low, high
