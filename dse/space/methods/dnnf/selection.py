"""Which rows go which way, for many rows at once: by chance, or by the number of the row in a list.

A selection holds *rows*, indices of rows that went the same way so far. It can `choose` among alternatives, `part` a
factor of independent results from all else, those that stand at the same place can be `joined`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Ints
from dse.space.methods.sampling.uniform import DRAWN_BITS, bits

_LARGEST = np.iinfo(np.int64).max


@dataclass(frozen=True, slots=True, eq=False)
class RandomSelection:
    """Every result is equally likely, exactly; the generator is taken to be random."""

    rows: NDArray[np.intp]
    random: np.random.Generator

    def choose(self, amounts: Sequence[int]) -> list[tuple[int, RandomSelection]]:
        """A word of random bits decides; where it falls on a bound, further bits do."""
        possible = [index for index, amount in enumerate(amounts) if amount]
        if len(possible) == 1:
            return [(possible[0], self)]
        ends = list(accumulate(amounts[index] for index in possible))
        scaled = [(end << DRAWN_BITS) // ends[-1] for end in ends[:-1]]
        words = bits(self.random, (len(self.rows),))
        bounds = np.array(scaled, np.uint64)
        chosen = np.searchsorted(bounds, words, side="left")
        # Words equal to a bound lie on it, partly below: decide those in whole numbers of any length.
        for row in np.flatnonzero(np.isin(words, bounds)).tolist():
            chosen[row] = self._exactly(int(words[row]), ends)
        return [
            (index, RandomSelection(self.rows[chosen == at], self.random))
            for at, index in enumerate(possible)
            if (chosen == at).any()
        ]

    def part(self, amount: int) -> tuple[RandomSelection, RandomSelection]:  # noqa: ARG002  # independent of all else
        """The same rows twice."""
        return self, self

    @staticmethod
    def joined(selections: Sequence[RandomSelection]) -> RandomSelection:
        """Selections that stand at the same place as one."""
        return RandomSelection(np.concatenate([one.rows for one in selections]), selections[0].random)

    def _exactly(self, word: int, ends: Sequence[int]) -> int:
        length = DRAWN_BITS
        while True:
            first = next(at for at, end in enumerate(ends) if word * ends[-1] < end << length)
            if (word + 1) * ends[-1] <= ends[first] << length:
                return first
            word = word << DRAWN_BITS | int(bits(self.random, ()))
            length += DRAWN_BITS


@dataclass(frozen=True, slots=True, eq=False)
class RankSelection:
    """Row r is result number *ranks*[r]."""

    rows: NDArray[np.intp]
    ranks: Ints

    def choose(self, amounts: Sequence[int]) -> list[tuple[int, RankSelection]]:
        """Alternatives one after another."""
        ends = np.array([min(end, _LARGEST) for end in accumulate(amounts)], np.int64)
        chosen = np.searchsorted(ends, self.ranks, side="right")
        starts = np.concatenate((np.zeros(1, np.int64), ends))
        return [
            (index, RankSelection(self.rows[chosen == index], self.ranks[chosen == index] - starts[index]))
            for index in np.unique(chosen).tolist()
        ]

    def part(self, amount: int) -> tuple[RankSelection, RankSelection]:
        """The last digit of the ranks to the base *amount*, and the digits before it."""
        before, digit = np.divmod(self.ranks, min(amount, _LARGEST))
        return RankSelection(self.rows, digit), RankSelection(self.rows, before)

    @staticmethod
    def joined(selections: Sequence[RankSelection]) -> RankSelection:
        """Selections that stand at the same place as one."""
        rows, ranks = zip(*((one.rows, one.ranks) for one in selections), strict=True)
        return RankSelection(np.concatenate(rows), np.concatenate(ranks))


SelectionT = TypeVar("SelectionT", RandomSelection, RankSelection)
