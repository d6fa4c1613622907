"""What an executor is given to do, and what it gives back."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set as AbstractSet
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

from dse.domain.run import Run, RunRequest
from dse.storage import Attempt, Measures, RowBlock

PROGRESS_BYTES = 64
"""Size of the block that a simulation notes in where it is."""


class Runnable(Protocol):
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
        """The run of *request*, with waveforms only if *keep*; a failed run is a result, too."""

    def close(self) -> None:
        """Free what the simulation holds."""


MakeRunner = Callable[[Any, memoryview], Runner]
"""Makes a runner from a `Runnable` and a progress block; a function that can be imported by name."""


@dataclass(frozen=True, slots=True)
class Batch:
    """Runs of one configuration that go to one worker together, sorted by number.

    If *file* is not "", waveforms are kept in the file of that name, or, with *logged*, in the write-ahead log alone.
    Runs in *made* are in the log already: with it, they come into the file. *alone* has the others made one at a time,
    *fresh* by a process that has made none before. A *part* is not all that its file is made of. It goes to another
    worker than the maker *unlike*, where there is one.
    """

    identity: int
    configuration: str
    requests: tuple[RunRequest, ...]
    file: str = ""
    alone: bool = False
    made: frozenset[int] = frozenset()
    fresh: bool = False
    part: bool = False
    unlike: str = ""
    logged: bool = False

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of its runs."""
        return tuple(request.number for request in self.requests)

    @property
    def todo(self) -> tuple[RunRequest, ...]:
        """The runs that are to be made."""
        return tuple(request for request in self.requests if request.number not in self.made)

    @property
    def name(self) -> str:
        """What its runs are found under in the write-ahead log, the same whenever it is made."""
        return self.file or f"runs-{self.identity:08d}"

    @property
    def keep(self) -> bool:
        """Whether waveforms are kept."""
        return bool(self.file)

    @property
    def makes_file(self) -> bool:
        """Whether a file is made of its waveforms when all of its runs are made."""
        return self.keep and not self.part and not self.logged

    def after(self, made: AbstractSet[int]) -> Batch:
        """The same batch when the runs *made* are, too."""
        return replace(self, made=self.made | made)

    def only(self, number: int) -> Batch:
        """The part of it that is one run."""
        requests = tuple(request for request in self.requests if request.number == number)
        return replace(self, requests=requests, made=frozenset(), part=True)


class Sink(Protocol):
    """Takes the results as they come."""

    def rows(self, batch: Batch, block: RowBlock) -> None:
        """Some runs of *batch* are finished."""

    def tried(self, attempts: Sequence[Attempt]) -> None:
        """Tries at runs that gave no row."""

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        """All of *batch* is; the waveforms of *kept* are in its file, which lies in the study's folder of waveforms."""

    def tick(self) -> None:
        """Called at least some times a second."""


@dataclass(frozen=True, slots=True)
class Work:
    """What a study's runs are made from: its configurations by id, who simulates them, and what every run has to give.

    Files of waveforms go into the folder *waveforms*, what is needed aside into *write-ahead log*; *study* is the
    fingerprint of what is studied.
    """

    configurations: Mapping[str, Runnable]
    make_runner: MakeRunner
    waveforms: Path
    measures: Measures
    log_folder: Path
    study: str = ""
