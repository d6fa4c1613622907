"""Worker processes and the one that watches them: no finished run is lost, no dead or hanging worker holds up a study.

Each worker has a pipe of its own, so a worker that dies can only take with it what it had not sent yet. What killed it
is recorded as the result of the run at hand, the rest of its batch goes to a fresh worker. One exception: a worker that
was killed from outside (SIGKILL, as the kernel does when memory runs out) says nothing about the run, which is tried
once more; the second time it is recorded.
"""

from __future__ import annotations

import pickle
import signal
import sys
import tempfile
from collections import deque
from collections.abc import Iterable, Mapping
from contextlib import ExitStack, suppress
from dataclasses import replace
from multiprocessing.connection import wait
from pathlib import Path
from types import TracebackType
from typing import Protocol

from dse.domain.run import RunRequest
from dse.errors import DseError, fail
from dse.exploration.heartbeat import Phase
from dse.exploration.job import Batch, Bench, Report, Setup
from dse.exploration.process import Assignment, WorkerProcess
from dse.exploration.worker import bench_file, failed_run
from dse.results.rows import RowBlock, block_of

START_TIMEOUT = 60.0
"""Seconds a worker may take to start, to load a configuration or to write a file."""

MOST_FRUITLESS_DEATHS = 3
"""Workers that may die in a row outside of any run before the exploration is given up."""

_LOOK_EVERY = 0.05


class Sink(Protocol):
    """Takes the results as they come."""

    def rows(self, batch: Batch, block: RowBlock) -> None:
        """Some runs of *batch* are finished."""

    def ended(self, batch: Batch, kept: tuple[int, ...]) -> None:
        """All of *batch* is; the waveforms of *kept* are in its file."""

    def tick(self) -> None:
        """Called at least some times a second."""


class Supervisor:
    """Works off batches with up to *workers* processes. Leaving its with block ends them, on an exception at once."""

    def __init__(self, setup: Setup, benches: Mapping[str, Bench], sink: Sink, workers: int) -> None:
        self._benches = benches
        self._sink = sink
        self._most = workers
        self._folder = tempfile.TemporaryDirectory(prefix="dse-", ignore_cleanup_errors=True)
        self._setup = replace(setup, benches=Path(self._folder.name))
        self._workers: list[WorkerProcess] = []
        self._pending: deque[Batch] = deque()
        self._hired = 0
        self._fruitless = 0
        self._retried: set[int] = set()

    @property
    def retried(self) -> int:
        """Runs that were tried again because their worker was killed from outside."""
        return len(self._retried)

    def work_off(self, batches: Iterable[Batch]) -> None:
        """Carry out *batches*; returns when each of their runs has been given to the sink.

        DseError if workers die one after the other without getting as far as a run, or cannot store waveforms.
        """
        self._pending.extend(batches)
        while self._pending or any(worker.assignments for worker in self._workers):
            self._hire()
            self._assign()
            self._listen()
            self._look_for_hanging()
            self._sink.tick()

    def __enter__(self) -> Supervisor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with ExitStack() as last:
            last.callback(self._folder.cleanup)
            for worker in self._workers:
                last.callback(worker.bury)
                if error is None:
                    worker.dismiss()
                else:
                    last.callback(worker.kill)
            if error is not None:
                for worker in self._workers:
                    with suppress(DseError):  # one reason to stop is told already
                        self._receive(worker)

    def _hire(self) -> None:
        busy = sum(bool(worker.assignments) for worker in self._workers)
        while len(self._workers) < min(self._most, busy + len(self._pending)):
            self._workers.append(WorkerProcess(self._setup, Path(self._folder.name), self._hired))
            self._hired += 1

    def _assign(self) -> None:
        # A second batch in the pipe spares a worker the wait for the next one; at the end it would leave others idle.
        depth = 2 if len(self._pending) > len(self._workers) else 1
        for turn in range(depth):
            for worker in list(self._workers):
                if self._pending and len(worker.assignments) == turn:
                    batch = self._pending.popleft()
                    self._store_bench(batch.configuration)
                    if not worker.give(batch):
                        self._bury(worker)

    def _store_bench(self, configuration: str) -> None:
        file = bench_file(self._setup, configuration)
        if not file.exists():
            file.write_bytes(pickle.dumps(self._benches[configuration], protocol=pickle.HIGHEST_PROTOCOL))

    def _listen(self) -> None:
        ends = {worker.connection: worker for worker in self._workers}
        ready = wait([*ends, *(worker.sentinel for worker in self._workers)], _LOOK_EVERY)
        for worker in list(self._workers):
            # Dead is dead, even if something the worker started still holds the far end of its pipe.
            if not self._receive(worker) or worker.sentinel in ready:
                self._bury(worker)

    def _receive(self, worker: WorkerProcess) -> bool:
        """Take all that *worker* has sent; False if it is dead."""
        try:
            while worker.connection.poll():
                self._take(worker, worker.connection.recv())
        except (EOFError, OSError):
            return False
        return True

    def _take(self, worker: WorkerProcess, report: Report) -> None:
        if report.broken:
            worker.assignments.popleft()  # what it sends next is of the batch after
            raise fail(report.broken, hint="finished runs are stored: the same command goes on when there is room")
        assignment = worker.assignments[0]
        if report.block is not None:
            assignment.received.update(report.block.numbers.tolist())
            self._sink.rows(assignment.batch, report.block)
        if report.ended:
            worker.assignments.popleft()
            self._fruitless = 0
            self._sink.ended(assignment.batch, report.kept)

    def _look_for_hanging(self) -> None:
        for worker in [worker for worker in self._workers if worker.assignments]:
            running = worker.state().phase is Phase.RUNNING
            limit = self._benches[worker.assignments[0].batch.configuration].timeout if running else START_TIMEOUT
            if worker.silence() > limit and self._receive(worker) and worker.silence() > limit:
                self._bury(worker, f"no answer for {limit:g} s")

    def _bury(self, worker: WorkerProcess, hanging: str = "") -> None:
        """Part with a dead or hanging worker: record the run at hand, put the rest back at the front of the queue."""
        self._workers.remove(worker)
        state, progress, words = worker.state(), worker.progress(), worker.last_words()
        if hanging:
            worker.kill()
        code = worker.bury()
        cause = hanging or _cause(code)
        at_hand = next((a for a in worker.assignments if a.batch.identity == state.batch), None)
        in_run = at_hand is not None and state.phase is Phase.RUNNING and state.number not in at_hand.received
        self._fruitless = 0 if in_run else self._fruitless + 1
        if self._fruitless >= MOST_FRUITLESS_DEATHS:
            raise _given_up(cause, state.phase, words)
        for assignment in reversed(worker.assignments):
            rest = assignment.rest()
            if in_run and assignment is at_hand and not self._is_worth_another_try(state.number, code, hanging):
                self._record(assignment, state.number, cause, progress)
                rest = rest.without({state.number})
            if rest.numbers:
                self._pending.appendleft(rest)
            else:
                self._sink.ended(assignment.batch, ())

    def _is_worth_another_try(self, number: int, code: int, hanging: str) -> bool:
        if hanging or sys.platform == "win32" or code != -signal.SIGKILL or number in self._retried:
            return False
        self._retried.add(number)
        return True

    def _record(self, assignment: Assignment, number: int, cause: str, progress: bytes) -> None:
        batch = assignment.batch
        place = self._benches[batch.configuration].describe_progress(progress)
        if number in self._retried:
            cause += " for the second time"
        request = RunRequest(number, batch.configuration, dict(zip(batch.names, batch.point(number), strict=True)))
        run = failed_run(request, f"{cause} in {place}" if place else cause)
        self._sink.rows(batch, block_of((run,), (float("nan"),), self._setup.metrics, self._setup.requirements))


def _given_up(cause: str, phase: Phase, words: str) -> DseError:
    doing = {
        Phase.STARTING: "while starting",
        Phase.LOADING: "while loading a configuration",
        Phase.WRITING: "while writing waveforms",
    }
    where = doing.get(phase, "between two")
    return fail(
        f"{MOST_FRUITLESS_DEATHS} workers in a row ended outside of any run, the last {where}: {cause}"
        + (f"\n{words}" if words else ""),
        hint="finished runs are stored: mend what the workers say and give the same command again",
    )


def _cause(code: int) -> str:
    if code == -9:
        return "killed from outside (signal 9)"
    if code < 0:
        return f"crashed (signal {-code})"
    # Windows gives the exception that ended a process as a large exit code.
    return f"crashed (exit code {code:#x})" if code > 255 else f"ended by itself (exit code {code})"
