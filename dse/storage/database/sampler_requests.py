"""What a study's sampler has asked for: numbers of runs, in blocks of one configuration.

Chunks and names of waveform files follow from the blocks, so that they are the same however the runs were made.
"""

from __future__ import annotations

import sqlite3
import zlib
from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import groupby

from dse.domain.run import RunRequest

LARGEST_CHUNK = 32
FEWEST_CHUNKS = 64


@dataclass(frozen=True, slots=True)
class Block:
    """*count* runs from number *first* on, of one *configuration*, in ask number *ask* of an *era*.

    A new era begins when a study is extended: its sampler asks again, and is given what is there.
    """

    first: int
    count: int
    configuration: str
    ask: int
    era: int


class SamplerRequests:
    """The blocks of a study, sorted by their first number."""

    def __init__(self, blocks: Iterable[Block] = ()) -> None:
        self.blocks: list[Block] = sorted(blocks, key=lambda block: block.first)
        self._firsts = [block.first for block in self.blocks]
        self._sizes: dict[tuple[int, int], int] = {}
        self.checksum = 0
        """Changes with any change of the blocks."""
        for block in self.blocks:
            self._count(block)

    @property
    def era(self) -> int:
        """The present era; 0 before the first ask."""
        return self.blocks[-1].era if self.blocks else 0

    @property
    def numbers(self) -> int:
        """One more than the largest number."""
        return self.blocks[-1].first + self.blocks[-1].count if self.blocks else 0

    def of(self, era: int, ask: int) -> list[Block]:
        """The blocks of one ask."""
        return [block for block in self.blocks if (block.era, block.ask) == (era, ask)]

    def add(self, blocks: Iterable[Block]) -> None:
        """Append *blocks*, which come after those that are there."""
        for block in blocks:
            self.blocks.append(block)
            self._firsts.append(block.first)
            self._count(block)

    def chunk(self, number: int, most: int | None = None) -> tuple[int, int]:
        """First and last number of the chunk that run *number* is in, of at most *most* runs; KeyError if not asked.

        At most 32 runs, fewer in a small ask, so that many workers have something to do.
        """
        block = self._block(number)
        if block is None:
            raise KeyError(number)
        size = max(1, min(LARGEST_CHUNK, self._sizes[block.era, block.ask] // FEWEST_CHUNKS))
        size = size if most is None else min(size, most)
        first = block.first + (number - block.first) // size * size
        return first, min(first + size, block.first + block.count) - 1

    def configuration(self, number: int) -> str | None:
        """The configuration of run *number*; None if it was not asked for."""
        block = self._block(number)
        return block.configuration if block else None

    def _block(self, number: int) -> Block | None:
        index = bisect_right(self._firsts, number) - 1
        block = self.blocks[index] if index >= 0 else None
        return block if block and number < block.first + block.count else None

    def _count(self, block: Block) -> None:
        self.checksum = (self.checksum + zlib.crc32(repr(block).encode()) * (block.first + 1)) % 2**64
        key = (block.era, block.ask)
        self._sizes[key] = self._sizes.get(key, 0) + block.count


def blocks_of(requests: Iterable[RunRequest], ask: int, era: int) -> list[Block]:
    """The blocks of *requests*, whose numbers follow each other."""
    blocks = []
    for configuration, group in groupby(requests, key=lambda request: request.configuration):
        numbers = [request.number for request in group]
        blocks.append(Block(numbers[0], len(numbers), configuration, ask, era))
    return blocks


def read_sampler_requests(connection: sqlite3.Connection) -> SamplerRequests:
    """The asks that are stored. ValueError if they are none."""
    rows = connection.execute("SELECT first, count, configuration, ask, era FROM asks ORDER BY first").fetchall()
    blocks = [Block(*row) for row in rows]
    end = 0
    for block in blocks:
        if block.first < end or block.count < 1:
            raise ValueError(f"the asks overlap at run {block.first}")
        end = block.first + block.count
    return SamplerRequests(blocks)


def write_sampler_requests(connection: sqlite3.Connection, blocks: Iterable[Block]) -> None:
    """Store *blocks*; the caller has a transaction open."""
    rows = [(block.first, block.count, block.configuration, block.ask, block.era) for block in blocks]
    connection.executemany("INSERT INTO asks VALUES (?, ?, ?, ?, ?)", rows)
