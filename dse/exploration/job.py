"""What an executor is given, what its workers are, and what they send back."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

from dse.domain.component import Value
from dse.domain.run import Run, RunRequest
from dse.storage.rows import RowBlock


class Bench(Protocol):
    """A configuration ready to be simulated; picklable."""

    @property
    def timeout(self) -> float:
        """Seconds a single run may take."""

    @property
    def memory(self) -> float:
        """Bytes a worker may be resident with."""

    @property
    def thread_safe(self) -> bool:
        """Whether several runs may be simulated at once in threads of one process."""

    @property
    def most_runs(self) -> int | None:
        """How many runs one process may make; None for any number."""

    def describe_progress(self, block: bytes) -> str:
        """Where a simulation was, from the progress block it left."""


class Runner(Protocol):
    """Simulates one configuration again and again in a worker process."""

    @property
    def runs_left(self) -> int | None:
        """How many more runs this process may make of the configuration; None for any number."""

    def run(self, request: RunRequest, *, keep: bool) -> Run:
        """The run of *request*, with waveforms only if *keep*; a run that fails is a result."""

    def close(self) -> None:
        """Free what the simulation holds."""


MakeRunner = Callable[[Any, memoryview], Runner]
"""Makes a runner from a `Bench` and a progress block; a function that can be imported by name."""


@dataclass(frozen=True, slots=True)
class Batch:
    """Runs of one configuration that go to one worker together.

    *numbers* are sorted; *points* has a row per number and a column per entry of *names*. If *file* is not "",
    waveforms are kept in the file of that name. *alone* has its runs made one at a time.
    """

    identity: int
    configuration: str
    names: tuple[str, ...]
    numbers: tuple[int, ...]
    points: tuple[tuple[Value, ...], ...]
    file: str = ""
    alone: bool = False

    @property
    def keep(self) -> bool:
        """Whether waveforms are kept."""
        return bool(self.file)

    def point(self, number: int) -> tuple[Value, ...]:
        """The point of run *number*; ValueError if it is not in the batch."""
        return self.points[self.numbers.index(number)]

    def requests(self) -> list[RunRequest]:
        """The runs one by one."""
        return [
            RunRequest(number, self.configuration, dict(zip(self.names, point, strict=True)))
            for number, point in zip(self.numbers, self.points, strict=True)
        ]

    def without(self, numbers: set[int]) -> Batch:
        """The same batch less *numbers*."""
        left = [row for row, number in enumerate(self.numbers) if number not in numbers]
        return replace(
            self,
            numbers=tuple(self.numbers[row] for row in left),
            points=tuple(self.points[row] for row in left),
        )


class Sink(Protocol):
    """Takes the results as they come."""

    def rows(self, batch: Batch, block: RowBlock) -> None:
        """Some runs of *batch* are finished."""

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        """All of *batch* is; the waveforms of *kept* are in its file, which lies in the study's folder of waveforms."""

    def tick(self) -> None:
        """Called at least some times a second."""


@dataclass(frozen=True, slots=True)
class Work:
    """What a study's runs are made from: a bench per configuration, and who simulates it.

    Files of waveforms go into the folder *waveforms*. *metrics* and *requirements* name what every run has to give.
    """

    benches: Mapping[str, Bench]
    make_runner: MakeRunner
    waveforms: Path
    metrics: tuple[str, ...]
    requirements: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Setup:
    """What every worker of an exploration needs; *benches* holds a pickled bench per configuration.

    A worker makes *threads* runs at a time.
    """

    make_runner: MakeRunner
    benches: Path
    waveforms: Path
    metrics: tuple[str, ...]
    requirements: tuple[str, ...]
    threads: int = 1


@dataclass(frozen=True, slots=True)
class Report:
    """From a worker: runs of the batch *identity* that are finished.

    *ended* with the last of them; then *kept* are the numbers whose waveforms are in the batch's file. *retired*
    comes last: the process is worn out and leaves, runs that are still to be made go to another. *broken* says why the
    worker cannot go on at all, as when the disk is full; *hurt* why this process cannot, which a run has harmed.
    """

    identity: int
    block: RowBlock | None = None
    ended: bool = False
    kept: tuple[int, ...] = ()
    retired: bool = False
    broken: str = ""
    hurt: str = ""
