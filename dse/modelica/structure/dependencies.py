"""On which inputs and states the outputs and derivatives depend, for the model description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dse.modelica.algebra.expression import Place, Symbol
from dse.modelica.flat import FlatModel, Relation
from dse.modelica.structure.arrange import Stage
from dse.modelica.structure.blocks import components
from dse.modelica.structure.events import Quantity, Step
from dse.modelica.structure.incidence import occurring


class Reach:
    """On which of *sources* everything that is computed depends, also by way of discrete variables.

    By way of held *relations* too, if they are given; not by way of pre-values, which are known at an event.
    """

    def __init__(
        self,
        stages: Sequence[Stage],
        steps: Sequence[Step],
        sources: Sequence[Symbol],
        relations: Sequence[Relation] = (),
    ) -> None:
        self._sources = {symbol: place for place, symbol in enumerate(sources)}
        nodes: list[tuple[tuple[Quantity, ...], tuple[Quantity, ...]]] = [(one.gives, one.needs) for one in stages]
        nodes += [(step.gives, step.needs) for step in steps]
        nodes += [
            ((Symbol(Place.HELD, str(place)),), tuple(occurring(relation.truth)))
            for place, relation in enumerate(relations)
        ]
        self._giver = {quantity: place for place, (gives, _) in enumerate(nodes) for quantity in gives}
        needs = [[self._giver[quantity] for quantity in refers if quantity in self._giver] for _, refers in nodes]
        self._reached = [0] * len(nodes)
        for component in components(needs):
            mask = 0
            for place in component:
                for quantity in nodes[place][1]:
                    if quantity in self._sources:
                        mask |= 1 << self._sources[quantity]
                for other in needs[place]:
                    mask |= self._reached[other]
            for place in component:
                self._reached[place] = mask

    def of(self, *symbols: Symbol) -> list[Symbol]:
        """The sources that *symbols* depend on, themselves if they are sources."""
        mask = 0
        for symbol in symbols:
            if symbol in self._sources:
                mask |= 1 << self._sources[symbol]
            elif symbol in self._giver:
                mask |= self._reached[self._giver[symbol]]
        return [symbol for symbol, place in self._sources.items() if mask >> place & 1]


def dependencies(
    flat: FlatModel, reach: Reach, states: Sequence[Symbol], aliases: Mapping[str, tuple[Symbol, int]]
) -> dict[str, frozenset[str]]:
    """For each output (its name) and state's derivative (its symbol's text): names of inputs, texts of states."""
    found = {}
    for name, variable in flat.variables.items():
        if variable.is_output:
            symbol = aliases[name][0] if name in aliases else Symbol(Place.VARIABLE, name)
            found[name] = frozenset(map(str, reach.of(symbol)))
    for state in states:
        derivative = Symbol(Place.VARIABLE, state.name, state.order + 1)
        found[str(derivative)] = frozenset(map(str, reach.of(derivative)))
    return found
