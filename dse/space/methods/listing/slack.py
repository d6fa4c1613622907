"""What partial rows may still spend on every cut, several cuts to a machine word.

The slack of a partial row is the bound of a cut less the least sum that a completion can still have. An edge of
the diagram costs its reduced weight: by how much the least completion through it exceeds the least of its node.
Each cut has a field of a word with a guard bit on top that is set; after one subtraction of words for all cuts, a
guard that is gone says that its cut cannot be kept any more (Lamport, Multiple byte processing, 1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Ints
from dse.space.methods.listing.bounds import Cut, least, stacked
from dse.space.methods.mdd.diagram import DecisionDiagram

WORD = 64


@dataclass(frozen=True, slots=True, eq=False)
class Slack:
    """Fields of the cuts, and of every layer the packed costs.

    *costs*: per layer and word, shape (nodes, columns), where -1 in *children* has the cost that nothing can pay.
    *spreads*: per layer and word, shape (nodes,), what the dearest completion costs.
    """

    words: tuple[int, ...]
    """Of each cut: its word,"""
    shifts: tuple[int, ...]
    """the lowest bit of its field"""
    sizes: tuple[int, ...]
    """and the bits below its guard."""
    guards: tuple[np.int64, ...]
    root: tuple[np.int64, ...] | None
    """The words of the root; None if a cut cannot be kept at all."""
    costs: tuple[tuple[Ints, ...], ...]
    spreads: tuple[tuple[Ints, ...], ...]

    def packed(self, amounts: Sequence[int]) -> list[np.int64]:
        """One amount for each cut, taken as what its field can hold if it is more, as words without guards."""
        words = [0] * len(self.guards)
        for word, shift, size, amount in zip(self.words, self.shifts, self.sizes, amounts, strict=True):
            words[word] |= min(amount, (1 << size) - 1) << shift
        return [_signed(word) for word in words]


def slack_of(
    diagram: DecisionDiagram, columns: Sequence[Ints], cuts: Sequence[Cut], movable: frozenset[int] = frozenset()
) -> Slack:
    """The slack of the cuts on a diagram that is not empty; *columns*: the values of each layer that occur.

    The bounds of *movable* cuts can be lowered later, so all of their slack counts; of the others no more than can
    be spent is kept.
    """
    number = len(cuts)
    weights = stacked(diagram, [cut.weights for cut in cuts])
    both = least(diagram, [np.concatenate((part, -part)) for part in weights], 2 * number)
    low = [part[:number] for part in both]
    spread = [-part[number:] - part[:number] for part in both]
    slack = [cut.high - int(low[0][place, 0]) for place, cut in enumerate(cuts)]
    if any(amount < 0 for amount in slack):
        return Slack((), (), (), (), None, (), ())
    fields = [int(spread[0][place, 0]) + 1 for place in range(number)]
    fields = [max(f, slack[p]) if p in movable else f for p, f in enumerate(fields)]
    words, shifts, sizes, used = _placed([field.bit_length() for field in fields])
    guards = [0] * used
    for word, shift, size in zip(words, shifts, sizes, strict=True):
        guards[word] |= 1 << (shift + size)
    empty = Slack(words, shifts, sizes, tuple(_signed(guard) for guard in guards), None, (), ())
    root = empty.packed([min(amount, field) for amount, field in zip(slack, fields, strict=True)])
    costs: list[tuple[Ints, ...]] = []
    for depth, children in enumerate(diagram.layers):
        child = children[:, columns[depth]]
        cost = weights[depth][:, None, columns[depth]] + low[depth + 1][:, child] - low[depth][:, :, None]
        packed = _packed(cost, words, shifts, used)
        costs.append(tuple(np.where(child < 0, guard, part) for guard, part in zip(empty.guards, packed, strict=True)))
    return Slack(
        words,
        shifts,
        sizes,
        empty.guards,
        tuple(word | guard for word, guard in zip(root, empty.guards, strict=True)),
        tuple(costs),
        tuple(tuple(_packed(part, words, shifts, used)) for part in spread),
    )


def _placed(sizes: Sequence[int]) -> tuple[tuple[int, ...], tuple[int, ...], tuple[int, ...], int]:
    """Word and lowest bit of every field, each put into the first word that has room; and how many words."""
    taken: list[int] = []
    words: list[int] = []
    shifts: list[int] = []
    for size in sizes:
        word = next((place for place, bits in enumerate(taken) if bits + size + 1 <= WORD), len(taken))
        if word == len(taken):
            taken.append(0)
        words.append(word)
        shifts.append(taken[word])
        taken[word] += size + 1
    return tuple(words), tuple(shifts), tuple(sizes), len(taken)


def _packed(amounts: Ints, words: Sequence[int], shifts: Sequence[int], used: int) -> list[NDArray[np.int64]]:
    packed = [np.zeros(amounts.shape[1:], np.int64) for _ in range(used)]
    for amount, word, shift in zip(amounts, words, shifts, strict=True):
        packed[word] |= amount << shift
    return packed


def _signed(word: int) -> np.int64:
    """The word of these 64 bits."""
    return np.int64(word - (1 << WORD) if word >> (WORD - 1) else word)
