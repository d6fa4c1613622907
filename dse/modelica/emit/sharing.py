"""What the passes at events and at the start have in common with the continuous functions is compiled once.

At an event, everything is computed: first what does not depend on the discrete variables, then these and what they
need, then the rest. The first and the last are parts of the continuous functions too, so all of them call the same C
functions. Only large models are split so: a small one is compiled in no time, and runs best in one piece.
"""

from __future__ import annotations

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import FlatModel
from dse.modelica.solved_model import Activation, Block, EventBlock, Explicit, System, When, expressions, targets

_LARGE = 80
_SMALLEST_PART = 8

# When a block of the continuous functions is computed in another pass.
_FIRST, _BETWEEN, _LAST = range(3)


@dataclass(frozen=True, slots=True)
class Part:
    """Blocks that become a function of their own, *number* in its name."""

    number: int
    blocks: tuple[Block, ...]


Program = tuple[Part | EventBlock, ...]


@dataclass(frozen=True, slots=True)
class Passes:
    """The order of each function; *initial* is absent if it has to be made without sharing."""

    parts: tuple[Part, ...]
    derivatives: Program
    outputs: Program
    event: Program
    initial: Program | None


def key(block: EventBlock) -> Hashable:
    """Equal for blocks that compute the same in the same way."""
    match block:
        case Explicit(unknown, value):
            return unknown, value.number
        case System(unknowns, inner, residuals, jacobian):
            entries = (entry.number for row in jacobian for entry in row)
            return unknowns, tuple(map(key, inner)), tuple(each.number for each in residuals), tuple(entries)
    return id(block)


def shared_passes(
    derivatives: Sequence[Block],
    outputs: Sequence[Block],
    event: Sequence[EventBlock],
    initial: Sequence[EventBlock],
    flat: FlatModel,
) -> Passes:
    """Parts of a large model. *event* and *initial* hold the very same blocks where they compute the same."""
    hot = (*derivatives, *outputs)
    at_event = _phases(hot, event, flat)
    at_start = _phases(hot, initial, flat)
    if len(hot) < _LARGE or at_event is None:
        return Passes((), tuple(derivatives), tuple(outputs), tuple(event), None)
    start = at_start or dict.fromkeys(at_event, _BETWEEN)
    parts: list[Part] = []

    def split(blocks: Iterable[Block]) -> list[tuple[tuple[int, int], Program]]:
        """Blocks by their phases. What a block needs is in no later phase of any pass, so that the order holds."""
        ordered = sorted(blocks, key=lambda block: (at_event[id(block)], start[id(block)]))
        found: list[tuple[tuple[int, int], Program]] = []
        for phases, group in groupby(ordered, lambda block: (at_event[id(block)], start[id(block)])):
            members = tuple(group)
            if phases == (_BETWEEN, _BETWEEN) or len(members) < _SMALLEST_PART:
                found.append((phases, members))
                continue
            parts.append(Part(len(parts), members))
            found.append((phases, (parts[-1],)))
        return found

    of_derivatives, of_outputs = split(derivatives), split(outputs)
    every = [*of_derivatives, *of_outputs]

    def whole(which: int, order: Sequence[EventBlock], phase: Mapping[int, int]) -> Program:
        early = [item for phases, items in every if phases[which] == _FIRST for item in items]
        late = [item for phases, items in every if phases[which] == _LAST for item in items]
        between = [block for block in order if phase.get(id(block), _BETWEEN) == _BETWEEN]
        return (*early, *between, *late)

    return Passes(
        tuple(parts),
        tuple(item for _, items in of_derivatives for item in items),
        tuple(item for _, items in of_outputs for item in items),
        whole(0, event, at_event),
        whole(1, initial, at_start) if at_start is not None else None,
    )


def _phases(hot: Sequence[Block], order: Sequence[EventBlock], flat: FlatModel) -> dict[int, int] | None:
    """When each block of *hot* is due in the pass *order*, by its id; None if the pass does not have them all."""
    shared = {id(block) for block in hot}
    if not shared <= {id(block) for block in order}:
        return None
    phases: dict[int, int] = {}
    own: set[Hashable] = set()
    for block in order:
        if id(block) in shared and own.isdisjoint(_reads(block, flat)):
            phases[id(block)] = _FIRST
        else:
            own |= set(_writes(block))
    needed: set[Hashable] = set()
    for block in reversed(order):
        if id(block) in phases:
            continue
        if id(block) in shared:
            phases[id(block)] = _LAST if needed.isdisjoint(_writes(block)) else _BETWEEN
        if phases.get(id(block)) != _LAST:
            needed |= set(_reads(block, flat))
    return phases


def _writes(block: EventBlock) -> list[Hashable]:
    return [("trigger", block.trigger)] if isinstance(block, Activation) else list(targets((block,)))


def _reads(block: EventBlock, flat: FlatModel) -> list[Hashable]:
    triggers = [("trigger", trigger) for trigger, _ in block.branches] if isinstance(block, When) else []
    return [*(symbol for symbol in symbols(*expressions(block, flat)) if symbol.is_variable), *triggers]
