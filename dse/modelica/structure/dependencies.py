"""On which inputs and states the outputs and derivatives depend, for the model description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dse.errors import Problem, raise_if_any
from dse.graphs import components
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import FlatModel, Relation
from dse.modelica.solved_model import EventBlock
from dse.modelica.structure.blocks.arrange import Quantity, Stage


class Reach:
    """On which of *sources* everything that is computed depends, also by way of discrete variables.

    By way of held *relations* too, if they are given; not by way of pre-values, which are known at an event.
    """

    def __init__(
        self,
        stages: Sequence[Stage[EventBlock]],
        sources: Sequence[Symbol],
        relations: Sequence[Relation] = (),
    ) -> None:
        self._sources = {symbol: place for place, symbol in enumerate(sources)}
        nodes: list[tuple[tuple[Quantity, ...], tuple[Quantity, ...]]] = [(one.gives, one.needs) for one in stages]
        nodes += [
            ((Symbol(str(place), referent=Referent.HELD),), tuple(symbols(relation.truth)))
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
            symbol = aliases[name][0] if name in aliases else Symbol(name)
            found[name] = frozenset(map(str, reach.of(symbol)))
    for state in states:
        derivative = state.derivative
        found[str(derivative)] = frozenset(map(str, reach.of(derivative)))
    return found


def refuse_uncertain(flat: FlatModel, states: Sequence[Symbol], reach: Reach) -> None:
    """Raise DseError for each ``reinit`` of what is no state, and where old and new values of a state could be mixed.

    ``reinit(x, expression)`` makes x an unknown of the event instant (Modelica 3.6, 8.3.6), so whatever else reads x
    without ``pre`` at that instant means the new value; but values are read before any state is written. Its own state
    may be read plainly: ``reinit(v, -e * v)`` is common and means the value before.
    """
    names = {state.name for state in states if not state.order}
    hint = "prefer it as a state by stateSelect"
    what = "reinit of '{}', which is not a state: its value follows from other states"
    problems = [
        Problem(what.format(one.state), one.where, hint) for one in flat.reinitializations if one.state not in names
    ]
    written = {one.state for one in flat.reinitializations}
    written_by = {(one.trigger, one.state) for one in flat.reinitializations}
    for one in flat.reinitializations:
        for name in _read(one.value, reach):
            if name in written and name != one.state:
                what = f"the new value of '{one.state}' is read from '{name}', which is set anew itself"
                problems.append(Problem(what, one.where, f"write pre({name})"))
    for assignment in flat.assignments:
        if assignment.trigger is None:
            continue
        for name in _read(assignment.value, reach):
            if (assignment.trigger, name) in written_by:
                what = f"'{assignment.target}' is read from '{name}', which is set anew at the same instant"
                problems.append(Problem(what, assignment.where, f"write pre({name})"))
    raise_if_any(problems)


def _read(value: Expression, reach: Reach) -> list[str]:
    """States that *value* depends on at the instant."""
    return [symbol.name for symbol in reach.of(*symbols(value)) if not symbol.order]
