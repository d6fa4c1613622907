"""A few runs of every study are simulated twice, to find FMUs that are not deterministic.

Of n runs one is repeated, or √n / 4, or one for each configuration up to n / 20: whichever is most. Another worker than
the first time makes them where there is one, so that a result that depends on the process (its id, addresses, a counter
in static memory) differs as one does that depends on a clock. Where a repeated run differs, it is recorded a few times
more: the signals that differ first name the parts to look at.

Of 100 runs of one configuration 2 are repeated, of 10,000 runs 25; of 200 runs of 200 configurations 10. A run that
takes longer than a minute is not.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from math import isqrt
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.domain.run import RunRequest, Waveforms
from dse.errors import DseError
from dse.exploration.executor import Executor
from dse.exploration.work import Batch, MakeRunner, Runnable, Work
from dse.scratch import ScratchFolder
from dse.storage import Attempt, Measures, RowBlock, read_waveforms, waveform_file

_LONGEST = 60.0
"""Seconds of a run that is not repeated only to compare."""

_MOST_NAMED = 3


@dataclass(slots=True)
class Made:
    """The finished runs that were simulated so far, and how many of them were *compared* with a second simulation."""

    compared: int = 0
    _numbers: list[NDArray[np.int64]] = field(default_factory=list)
    _makers: list[str] = field(default_factory=list)
    _configurations: set[str] = field(default_factory=set)

    def add(self, configuration: str, block: RowBlock) -> None:
        """Note the runs of *block*, all of one *configuration*."""
        self._configurations.add(configuration)
        self._numbers.append(block.numbers[block.done & ~(block.wall > _LONGEST)])
        self._makers.append(block.maker)

    def repeats(self, requests: Mapping[int, RunRequest]) -> Iterator[Batch]:
        """A batch for each run to repeat, found in *requests* by its number; none if enough were compared already."""
        numbers = np.concatenate([np.empty(0, np.int64), *self._numbers])
        order = np.argsort(numbers, kind="stable")
        blocks = np.repeat(np.arange(len(self._numbers)), [len(each) for each in self._numbers])[order]
        count, numbers = len(numbers), numbers[order]
        wanted = min(count, max(1, isqrt(count) // 4, min(len(self._configurations), count // 20)))
        for turn in range(wanted if self.compared < wanted else 0):
            at = (2 * turn + 1) * count // (2 * wanted)
            request = requests[int(numbers[at])]
            yield Batch(
                request.number, request.configuration, (request,), alone=True, unlike=self._makers[int(blocks[at])]
            )


def first_differences(
    prepared: Runnable, request: RunRequest, executor: Executor, make_runner: MakeRunner, measures: Measures
) -> str:
    """Which signals differ first, and when, if *request* is simulated four times by *executor*; "" if none does.

    Three of them are made by one process one after the other, the fourth by another where there is one.
    """
    name = request.configuration
    requests = tuple(RunRequest(number, name, request.point) for number in range(4))
    batches = [Batch(0, name, requests[:3], waveform_file(0, 2)), Batch(3, name, requests[3:], waveform_file(3, 3))]
    runs: list[Waveforms] = []
    with ScratchFolder() as scratch:
        folder = Path(scratch)
        work = Work({name: prepared}, make_runner, folder, measures, folder / "spool")
        with suppress(DseError):
            with executor.open(work, _Unheeded()) as pool:
                pool.work_off(batches)
            runs += [read_waveforms(folder / batch.file, number) for batch in batches for number in batch.numbers]
    found = sorted(first for other in runs[1:] for first in _apart(runs[0], other))
    if not found:
        return ""
    names = [f"'{signal}'" for time, signal in found if time == found[0][0]]
    named = list(dict.fromkeys(names))
    more = f" and {len(named) - _MOST_NAMED} others" if len(named) > _MOST_NAMED else ""
    return f"{', '.join(named[:_MOST_NAMED])}{more} at {found[0][0]:g} s"


def _apart(one: Waveforms, other: Waveforms) -> Iterator[tuple[float, str]]:
    """When each signal that differs does so first."""
    count = min(len(one.time), len(other.time))
    for name, values in one.values.items():
        a, b = values[:count], other.values[name][:count]
        different = np.flatnonzero((a != b) & ~(np.isnan(a) & np.isnan(b)))
        if len(different):
            yield float(one.time[different[0]]), name


class _Unheeded:
    """A sink for runs of which the waveforms alone are wanted."""

    def rows(self, batch: Batch, block: RowBlock) -> None:
        """Nothing is kept of them."""

    def tried(self, attempts: Sequence[Attempt]) -> None:
        """Nothing is kept of them."""

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        """The file is there."""

    def tick(self) -> None:
        """Nothing waits."""
