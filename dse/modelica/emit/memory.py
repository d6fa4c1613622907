"""Where everything lives in the component's ``double v[]``, and what is numbered besides: pre-values and conditions."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from dse.errors import fail
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import Role
from dse.modelica.solved_model import Solved, When, all_expressions, targets


@dataclass(frozen=True, slots=True)
class MemoryLayout:
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
        """Referent of the value of the flat variable *name*."""
        return self.own[name] if name in self.own else self.places[Symbol(name)]


def memory_layout(solved: Solved) -> MemoryLayout:
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
                places[Symbol(name)] = places[kept]
            else:
                own[name] = size
                size += 1
        elif Symbol(name) not in places:
            where = solved.flat.variables[name].where
            raise fail(f"nothing computes the variable '{name}'", where, "give it an equation, or make it an input")
    conditions, count = [], 0
    for trigger in solved.flat.triggers:
        conditions.append(count)
        count += len(trigger.conditions)
    return MemoryLayout(places, own, _pre(solved, places), tuple(conditions), count, size)


def _in_order(solved: Solved) -> Iterator[Symbol]:
    flat = solved.flat
    for role in (Role.PARAMETER, Role.INPUT):
        for name, declared in flat.variables.items():
            if declared.role is role and name not in solved.aliases:
                yield Symbol(name)
    yield from solved.states
    yield from (state.derivative for state in solved.states)
    for blocks in (solved.parameters, solved.derivatives, solved.outputs, solved.event, solved.initial, solved.guesses):
        yield from targets(blocks)


def _pre(solved: Solved, places: Mapping[Symbol, int]) -> dict[str, int]:
    """Numbers of the variables whose value just before is kept: whoever asks for it, and whoever falls back on it."""
    wanted = {symbol.name for symbol in symbols(*all_expressions(solved)) if symbol.referent is Referent.PRE}
    for block in (*solved.event, *solved.initial):
        if isinstance(block, When) and all(trigger is not None for trigger, _ in block.branches):
            wanted.add(block.target.name)
    wanted -= {state.name for state in solved.states if state.order == 0}
    return {name: number for number, name in enumerate(sorted(wanted, key=lambda name: places[Symbol(name)]))}
