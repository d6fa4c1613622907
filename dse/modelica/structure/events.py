"""Discrete and continuous equations in one order, for the instants of events."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from dse.errors import Problem, raise_if_any
from dse.graphs import components
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import FlatModel
from dse.modelica.solved_model import Activation, EventBlock, When
from dse.modelica.structure.blocks.arrange import Quantity, Stage


def discrete_steps(
    flat: FlatModel, skipped: frozenset[str] = frozenset(), at_start: bool = False
) -> list[Stage[EventBlock]]:
    """Triggers and assignments of *flat*; without the assignments to *skipped*.

    With *at_start* branches under a trigger that is not active at the start are left out.
    """
    steps: list[Stage[EventBlock]] = []
    for number, trigger in enumerate(flat.triggers):
        needs: tuple[Quantity, ...] = tuple(symbols(*trigger.conditions))
        steps.append(Stage(Activation(number), (number,), needs, None, f"when {number + 1}"))
    for target, own in by_target(flat).items():
        if target in skipped:
            continue
        branches = [
            (one.trigger, one.value)
            for one in (flat.assignments[place] for place in own)
            if not at_start or one.trigger is None or flat.triggers[one.trigger].at_start
        ]
        symbol = Symbol(target)
        triggers = tuple(dict.fromkeys(trigger for trigger, _ in branches if trigger is not None))
        needs = (*triggers, Symbol(target, referent=Referent.PRE), *symbols(*(value for _, value in branches)))
        where = next((flat.assignments[place].where for place in own), None)
        steps.append(Stage(When(symbol, tuple(branches)), (symbol,), needs, where, target))
    return steps


def by_target(flat: FlatModel) -> dict[str, list[int]]:
    """Places of the assignments to each discrete variable, in the model's order."""
    found: dict[str, list[int]] = {}
    for place, assignment in enumerate(flat.assignments):
        found.setdefault(assignment.target, []).append(place)
    return found


def ordered(nodes: Sequence[Stage[EventBlock]]) -> list[EventBlock]:
    """The blocks of *nodes*, each after what it needs. Raises DseError for a loop through discrete equations."""
    giver: Mapping[Quantity, int] = {quantity: place for place, node in enumerate(nodes) for quantity in node.gives}
    needs = [[giver[quantity] for quantity in node.needs if quantity in giver] for node in nodes]
    order: list[EventBlock] = []
    problems = []
    for component in components(needs):
        if len(component) > 1 or component[0] in needs[component[0]]:
            texts = ", ".join(nodes[place].text for place in component[:8])
            where = next((nodes[place].where for place in component if nodes[place].where is not None), None)
            hint = "break the loop with pre()"
            problems.append(Problem(f"discrete equations depend on themselves: {texts}", where, hint))
        order.extend(nodes[place].block for place in component)
    raise_if_any(problems)
    return order
