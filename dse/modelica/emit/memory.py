"""Where everything lives in the component's ``double v[]``, and what is numbered besides: pre-values and conditions."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from dse.errors import fail
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Place, Symbol, variable
from dse.modelica.algebra.traversal import walk
from dse.modelica.flat_model import FlatModel, Role
from dse.modelica.solved_model import Activation, EventBlock, Explicit, Solved, System, When


@dataclass(frozen=True, slots=True)
class Layout:
    """*places* of variables and derivatives in ``v``: parameters (in the order of the flat model, so that an array is
    in a row), inputs, states, their derivatives in the same order, everything else that is computed.

    *own* are the places of eliminated variables that cannot share one: negated ones and those that equal time.
    *pre* gives the place in ``pre[]`` of a variable's pre-value, *conditions* the first number of each trigger's
    conditions. *size* is the count of places so far; the code may add more behind them.
    """

    places: Mapping[Symbol, int]
    own: Mapping[str, int]
    pre: Mapping[str, int]
    conditions: tuple[int, ...]
    condition_count: int
    size: int

    def of(self, name: str) -> int:
        """Place of the value of the flat variable *name*."""
        return self.own[name] if name in self.own else self.places[variable(name)]


def layout(solved: Solved) -> Layout:
    """The layout of *solved*. Raises DseError for a variable that no equation computes."""
    places: dict[Symbol, int] = {}
    for symbol in _in_order(solved):
        places.setdefault(symbol, len(places))
    size = len(places)
    own: dict[str, int] = {}
    for name in solved.flat.variables:
        if name in solved.aliases:
            kept, sign = solved.aliases[name]
            if sign > 0 and kept in places:
                places[variable(name)] = places[kept]
            else:
                own[name] = size
                size += 1
        elif variable(name) not in places:
            where = solved.flat.variables[name].where
            raise fail(f"nothing computes the variable '{name}'", where, "give it an equation, or make it an input")
    conditions, count = [], 0
    for trigger in solved.flat.triggers:
        conditions.append(count)
        count += len(trigger.conditions)
    return Layout(places, own, _pre(solved, places), tuple(conditions), count, size)


def _in_order(solved: Solved) -> Iterator[Symbol]:
    flat = solved.flat
    for role in (Role.PARAMETER, Role.INPUT):
        for name, declared in flat.variables.items():
            if declared.role is role and name not in solved.aliases:
                yield variable(name)
    yield from solved.states
    yield from (variable(state.name, state.order + 1) for state in solved.states)
    for blocks in (solved.parameters, solved.derivatives, solved.outputs, solved.event, solved.initial, solved.guesses):
        yield from targets(blocks)


def targets(blocks: Iterable[EventBlock]) -> Iterator[Symbol]:
    """What *blocks* compute, in their order."""
    for block in blocks:
        match block:
            case Explicit(unknown):
                yield unknown
            case System(unknowns, inner):
                yield from unknowns
                yield from (assignment.unknown for assignment in inner)
            case When(target):
                yield target


def expressions(block: EventBlock, flat: FlatModel) -> tuple[Expression, ...]:
    """Everything *block* evaluates."""
    match block:
        case Explicit(_, value):
            return (value,)
        case System(_, inner, residuals, jacobian):
            rows = (entry for row in jacobian for entry in row)
            return (*(assignment.value for assignment in inner), *residuals, *rows)
        case When(_, branches):
            return tuple(value for _, value in branches)
        case Activation(trigger):
            return flat.triggers[trigger].conditions


def all_expressions(solved: Solved) -> Iterator[Expression]:
    """Every expression of the model that becomes code."""
    flat = solved.flat
    for blocks in (solved.parameters, solved.derivatives, solved.outputs, solved.event, solved.initial, solved.guesses):
        for block in blocks:
            yield from expressions(block, flat)
    yield from (condition for trigger in flat.triggers for condition in trigger.conditions)
    yield from (relation.truth for relation in flat.relations)
    yield from (reinitialization.value for reinitialization in flat.reinitializations)
    yield from (check.condition for check in flat.checks)


def _pre(solved: Solved, places: Mapping[Symbol, int]) -> dict[str, int]:
    """Numbers of the variables whose value just before is kept: whoever asks for it, and whoever falls back on it."""
    wanted = {
        node.symbol.name
        for node in walk(all_expressions(solved))
        if node.symbol is not None and node.symbol.place is Place.PRE
    }
    for block in (*solved.event, *solved.initial):
        if isinstance(block, When) and all(trigger is not None for trigger, _ in block.branches):
            wanted.add(block.target.name)
    wanted -= {state.name for state in solved.states if state.order == 0}
    return {name: number for number, name in enumerate(sorted(wanted, key=lambda name: places[variable(name)]))}
