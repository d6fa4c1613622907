"""What decides between ways to go on, for many rows at once: chance, or the number of the row in a list.

A lot holds *rows*, indices of rows that went the same way so far. It can `choose` among alternatives, `part` a factor
of independent results from all else, and join others that stand at the same place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import accumulate

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Bools, Ints
from dse.space.sampling.uniform import BITS, bits

_SMALL = 1 << 31
"""A divisor that leaves room in a machine word; more than the rows of a block."""


@dataclass(frozen=True, slots=True, eq=False)
class Chance:
    """Every result is equally likely, exactly; the generator is taken to be random."""

    rows: NDArray[np.intp]
    random: np.random.Generator

    def choose(self, amounts: Sequence[int]) -> list[tuple[int, Chance]]:
        """A word of random bits decides; where it falls on a bound, further bits do."""
        possible = [index for index, amount in enumerate(amounts) if amount]
        if len(possible) == 1:
            return [(possible[0], self)]
        ends = list(accumulate(amounts[index] for index in possible))
        scaled = [(end << BITS) // ends[-1] for end in ends[:-1]]
        words = bits(self.random, (len(self.rows),))
        bounds = np.array(scaled, np.uint64)
        chosen = np.searchsorted(bounds, words, side="left")
        # Words equal to a bound lie on it, partly below: decide those in whole numbers of any length.
        for row in np.flatnonzero(np.isin(words, bounds)).tolist():
            chosen[row] = self._exactly(int(words[row]), ends)
        return [
            (index, Chance(self.rows[chosen == at], self.random))
            for at, index in enumerate(possible)
            if (chosen == at).any()
        ]

    def part(self, amount: int) -> list[tuple[Chance, Chance]]:  # noqa: ARG002  # independent of everything else
        """The same rows twice."""
        return [(self, self)]

    def together(self, lots: Sequence[Chance]) -> list[Chance]:
        """Lots that go the same way, as few as possible."""
        return [Chance(np.concatenate([lot.rows for lot in lots]), self.random)] if len(lots) > 1 else list(lots)

    def _exactly(self, word: int, ends: Sequence[int]) -> int:
        length = BITS
        while True:
            first = next(at for at, end in enumerate(ends) if word * ends[-1] < end << length)
            if (word + 1) * ends[-1] <= ends[first] << length:
                return first
            word = word << BITS | int(bits(self.random, ()))
            length += BITS


@dataclass(frozen=True, slots=True, eq=False)
class Rank:
    """Row r is result number *base* + *offsets*[r]; the least offset is 0, the base may be of any size."""

    rows: NDArray[np.intp]
    base: int
    offsets: Ints

    def choose(self, amounts: Sequence[int]) -> list[tuple[int, Rank]]:
        """Alternatives one after another."""
        found: list[tuple[int, Rank]] = []
        rest = self
        for index, amount in enumerate(amounts):
            left = amount - rest.base
            if left > int(rest.offsets.max()):
                return [*found, (index, rest)]
            if left > 0:
                inside: Bools = rest.offsets < left
                found.append((index, _rank(rest.rows[inside], rest.base, rest.offsets[inside])))
                rest = _rank(rest.rows[~inside], rest.base - amount, rest.offsets[~inside])
            else:
                rest = Rank(rest.rows, -left, rest.offsets)
        raise ValueError("rank beyond the last result")

    def part(self, amount: int) -> list[tuple[Rank, Rank]]:
        """The last digit of the rank to the base *amount*, and the digits before it."""
        whole, start = divmod(self.base, amount)
        if start + int(self.offsets.max()) < amount:
            return [(Rank(self.rows, start, self.offsets), Rank(self.rows, whole, np.zeros_like(self.offsets)))]
        if amount < _SMALL:
            sums = self.offsets + start
            return [(_rank(self.rows, 0, sums % amount), _rank(self.rows, whole, sums // amount))]
        # Offsets are smaller than the amount, so there is one carry at most.
        carries: Bools = self.offsets >= amount - start
        return [
            (digit, Rank(digit.rows, whole + carry, np.zeros_like(digit.offsets)))
            for carry, goes in ((0, ~carries), (1, carries))
            if goes.any()
            for digit in (_rank(self.rows[goes], start - carry * amount, self.offsets[goes]),)
        ]

    def together(self, lots: Sequence[Rank]) -> list[Rank]:
        """Lots that go the same way, as few as possible."""
        return list(lots)


def _rank(rows: NDArray[np.intp], base: int, offsets: Ints) -> Rank:
    least = int(offsets.min())
    return Rank(rows, base + least, offsets - least)
