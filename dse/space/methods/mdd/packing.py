"""Where the states of automata lie in the machine words of a node: each takes its bits while it lives."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dse.space.flat import Ints
from dse.space.methods.mdd.automata import Automaton

_BITS = 62
"""Of a word: it stays positive, and sums of two do not overflow."""


@dataclass(frozen=True, slots=True, eq=False)
class Field:
    """What one automaton does in one layer: its bits in a word, and its step."""

    word: int
    shift: int
    mask: int
    step: Ints
    starts: bool
    ends: bool


def pack(automata: Sequence[Automaton], layers: int) -> tuple[list[list[Field]], int]:
    """The fields that each layer touches, and how many words a node needs."""
    fields: list[list[Field]] = [[] for _ in range(layers)]
    starting: list[list[Automaton]] = [[] for _ in range(layers)]
    freed: list[list[tuple[int, int]]] = [[] for _ in range(layers)]
    free: list[int] = []
    for automaton in automata:
        starting[automaton.layers[0]].append(automaton)
    for layer, automata_here in enumerate(starting):
        for word, bits in freed[layer]:
            free[word] |= bits
        for automaton in automata_here:
            bits = (automaton.states() - 1).bit_length()
            word, shift = _place(free, bits)
            mask = (1 << bits) - 1
            free[word] &= ~(mask << shift)
            last = automaton.layers[-1]
            freed[last].append((word, mask << shift))
            for at, step in zip(automaton.layers, automaton.steps, strict=True):
                fields[at].append(Field(word, shift, mask, step, at == layer, at == last))
    return fields, len(free)


def _place(free: list[int], bits: int) -> tuple[int, int]:
    """First word and shift with that many free bits in a row; a new word if there is none."""
    for word, available in enumerate(free):
        starts = available
        for _ in range(bits - 1):
            starts &= starts >> 1
        if starts:
            return word, (starts & -starts).bit_length() - 1
    free.append((1 << _BITS) - 1)
    return len(free) - 1, 0
