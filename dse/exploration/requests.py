"""The runs that a study was asked for, by their numbers."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from dse.domain.run import RunRequest


class Requests(Mapping[int, RunRequest]):
    """Runs with the variables *names* by number: *earlier* ones, and those from *base* on, as they are asked for.

    As nouns, a million of them would take half a gigabyte.
    """

    def __init__(self, names: tuple[str, ...], base: int, earlier: Mapping[int, RunRequest]) -> None:
        self.end = base
        """The number of the next one."""
        self._names = names
        self._base = base
        self._earlier = earlier
        self._firsts: list[int] = []
        self._blocks: list[tuple[str, NDArray[np.float64], tuple[tuple[int, str], ...]]] = []

    def __getitem__(self, number: int) -> RunRequest:
        if number < self._base:
            return self._earlier[number]
        if number >= self.end:
            raise KeyError(number)
        index = bisect_right(self._firsts, number) - 1
        configuration, points, columns = self._blocks[index]
        values = points[number - self._firsts[index]].tolist()
        return RunRequest(number, configuration, {name: values[column] for column, name in columns})

    def __iter__(self) -> Iterator[int]:
        return chain(self._earlier, range(self._base, self.end))

    def __len__(self) -> int:
        return len(self._earlier) + self.end - self._base

    def append(self, configuration: str, points: NDArray[np.float64], has: NDArray[np.bool_]) -> None:
        """Have *points*, (n, variables), on *configuration*, which *has* these of the variables, as the next runs."""
        columns = tuple((column, name) for column, name in enumerate(self._names) if has[column])
        self._firsts.append(self.end)
        self._blocks.append((configuration, points, columns))
        self.end += len(points)
