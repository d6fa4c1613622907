"""What is still to be done of a study, cut into batches.

Where a chunk starts and ends, and so the name and the bytes of a waveform file, follows from what was asked for and
from what is known of the FMUs: not from the number of workers, nor from how often the exploration was stopped.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Set as AbstractSet
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from dse.domain.run import RunRequest
from dse.domain.study import Shard
from dse.exploration.work import Batch
from dse.storage import SamplerRequests, waveform_file


class Numbers(AbstractSet[int]):
    """Numbers of runs, in ascending order; a byte for each number up to the largest, where a set takes sixty."""

    def __init__(self, numbers: Iterable[int] = ()) -> None:
        self._has: NDArray[np.bool_] = np.zeros(0, np.bool_)
        self.update(numbers)

    def update(self, numbers: Iterable[int]) -> None:
        """Add *numbers*."""
        new = np.fromiter(numbers, np.int64)
        if len(new):
            missing = int(new.max()) + 1 - len(self._has)
            if missing > 0:  # half as much again, so that numbers which come one by one are not copied each time
                self._has = np.concatenate([self._has, np.zeros(max(missing, len(self._has) // 2), np.bool_)])
            self._has[new] = True

    def __contains__(self, number: object) -> bool:
        return isinstance(number, int) and 0 <= number < len(self._has) and bool(self._has[number])

    def __iter__(self) -> Iterator[int]:
        return map(int, np.flatnonzero(self._has))

    def __len__(self) -> int:
        return int(np.count_nonzero(self._has))


@dataclass(frozen=True, slots=True)
class Chunks:
    """How the runs that were asked for, *requests* by number, are cut.

    *most* tells how many runs of a configuration a process can make; None for any number.
    """

    requests: Mapping[int, RunRequest]
    asks: SamplerRequests
    most: Callable[[str], int | None]

    def runs(self, missing: Iterable[int]) -> Iterator[Batch]:
        """Batches for the *missing* runs, without waveforms."""
        for (first, _), numbers in self._cut(missing):
            yield self._batch(first, numbers, "")

    def waveforms(self, missing: Iterable[int], kept: Mapping[int, str]) -> Iterator[Batch]:
        """Batches for the runs whose waveforms are *missing*.

        The file of a chunk is written as a whole: runs whose waveforms are *kept* in it already are simulated with
        them.
        """
        for (first, last), numbers in self._cut(missing):
            wanted = set(numbers)
            todo = (n for n in range(first, last + 1) if n in self.requests and (n in wanted or kept.get(n)))
            yield self._batch(first, todo, waveform_file(first, last))

    def part(self, asked: Iterable[int], shard: Shard) -> set[int]:
        """Those of the *asked* runs that *shard* makes: every so many-th chunk as a whole."""
        cut = enumerate(self._cut(asked))
        return {n for index, (_, numbers) in cut if index % shard.of == shard.number - 1 for n in numbers}

    def _cut(self, missing: Iterable[int]) -> Iterator[tuple[tuple[int, int], Iterator[int]]]:
        asks = self.asks
        return groupby(Numbers(missing), lambda number: asks.chunk(number, self.most(asks.configuration(number) or "")))

    def _batch(self, identity: int, numbers: Iterable[int], file: str) -> Batch:
        requests = tuple(self.requests[number] for number in numbers)
        return Batch(identity, requests[0].configuration, requests, file)
