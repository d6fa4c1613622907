"""Batches cut into loads: what one worker is given at a time, and what becomes of a batch that was cut."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path

from dse.exploration.failures import not_stored
from dse.exploration.remote.messages import BatchRows
from dse.exploration.work import Batch, Sink
from dse.storage import read_all_waveforms, write_waveforms


@dataclass(slots=True, eq=False)
class Job:
    """A *batch*, of which so many runs are *missing*; the *files* hold the waveforms of those that came."""

    batch: Batch
    missing: int
    kept: list[int] = field(default_factory=list)
    files: list[Path] = field(default_factory=list)

    def take(self, part: Batch, piece: BatchRows, folder: Path, sink: Sink) -> None:
        """Tell *sink* what came of *part*, and that the batch is done when it is; waveforms go into *folder*.

        DseError if they cannot be written.
        """
        with _writing_waveforms():
            for number, content in enumerate(piece.files):
                aside = folder / f"{self.batch.file}.{part.numbers[0]}-{number}.part"
                aside.write_bytes(content)
                self.files.append(aside)
        self.kept += piece.kept
        for block in piece.blocks:
            sink.rows(self.batch, block)
        self.missing -= len(part.requests)
        if not self.missing:
            with _writing_waveforms():
                self._put_together(folder)
            sink.ended(self.batch, tuple(sorted(self.kept)))

    def _put_together(self, folder: Path) -> None:
        if not self.files:
            return
        whole = folder / self.batch.file
        if len(self.files) > 1:
            runs = sorted((run for file in self.files for run in read_all_waveforms(file)), key=lambda run: run[0])
            write_waveforms(whole, runs)
            for file in self.files:
                file.unlink()
        else:
            self.files[0].replace(whole)


@contextmanager
def _writing_waveforms() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise not_stored(f"waveforms cannot be written: {error.strerror or error}") from error


@dataclass(frozen=True, slots=True)
class AssignmentPart:
    """Runs of a *job*, as a *batch*."""

    job: Job
    batch: Batch


@dataclass(slots=True, eq=False)
class Assignment:
    """Parts that one worker is given together.

    *deaths* counts the workers that ended with it, *troubles* those that could not make it for reasons of their own. It
    is to be the only one under way if it has to be *alone*. *configurations* and *entries* are to be sent with it, best
    to the *worker* that asked for them.
    """

    parts: tuple[AssignmentPart, ...]
    deaths: int = 0
    troubles: int = 0
    alone: bool = False
    configurations: tuple[str, ...] = ()
    entries: tuple[str, ...] = ()
    worker: str = ""

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers of its runs."""
        return tuple(number for part in self.parts for number in part.batch.numbers)

    def halves(self) -> Iterator[Assignment]:
        """The load in two; where several runs are left, the next death is enough to go on so."""
        runs = [(part.job, request) for part in self.parts for request in part.batch.requests]
        middle = len(runs) // 2
        for half in (runs[:middle], runs[middle:]):
            jobs = dict.fromkeys(job for job, _ in half)
            chosen = {job: tuple(request for other, request in half if other is job) for job in jobs}
            parts = [AssignmentPart(job, replace(job.batch, requests=requests)) for job, requests in chosen.items()]
            yield Assignment(tuple(parts), deaths=int(len(half) > 1), alone=self.alone)


class BatchSplitter:
    """Takes loads off *batches*, one after the other."""

    def __init__(self, batches: Iterable[Batch]) -> None:
        self._batches = iter(batches)
        self._job: Job | None = None
        self._rest: Batch | None = None

    def load(self, most: int) -> Assignment | None:
        """About *most* runs; None if there are no more. Files of waveforms are cut only where they are long."""
        parts: list[AssignmentPart] = []
        while most > 0:
            if self._job is None or self._rest is None:
                batch = next(self._batches, None)
                if batch is None:
                    break
                self._job, self._rest = Job(batch, len(batch.requests)), batch
            requests = self._rest.requests
            if self._rest.keep and parts and len(requests) > most:
                break
            size = len(requests) if self._rest.keep and len(requests) <= 2 * most else min(most, len(requests))
            parts.append(AssignmentPart(self._job, replace(self._rest, requests=requests[:size])))
            self._rest = replace(self._rest, requests=requests[size:]) if size < len(requests) else None
            most -= size
        return Assignment(tuple(parts)) if parts else None
