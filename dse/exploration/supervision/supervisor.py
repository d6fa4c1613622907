"""Worker processes and the one that watches them: no finished run is lost, no dead or hanging worker holds up a study.

Each worker has a channel of its own, so a worker that dies can only take with it what it had not sent yet. What killed
it is recorded as the result of the run at hand, the rest of its batch goes to a fresh worker. Exceptions: a worker that
was killed from outside (SIGKILL, as the kernel does when memory runs out), or that grew too large over several runs,
says nothing about the run at hand, which is tried once more; the second time it is recorded. And where several runs
were at hand, in threads, nobody knows which of them it was: they are made again, one at a time. So are all runs of a
batch in which something was done to the worker that showed only later.
"""

from __future__ import annotations

import signal
import sys
import tempfile
import time
from collections import deque
from collections.abc import Iterable
from contextlib import ExitStack, suppress
from dataclasses import replace
from itertools import count
from multiprocessing.connection import wait
from pathlib import Path
from types import TracebackType

from dse.errors import DseError, fail
from dse.exploration.failures import failed_run
from dse.exploration.packing import packed
from dse.exploration.supervision.channel import GarbledError
from dse.exploration.supervision.heartbeat import Phase
from dse.exploration.supervision.messages import Report, Setup
from dse.exploration.supervision.post_mortem import Traces, cause_of, outside_of_runs, told, traces_of
from dse.exploration.supervision.worker import CHANNEL_CLOSED
from dse.exploration.supervision.worker_process import Assignment, WorkerProcess
from dse.exploration.work import Batch, Sink, Work
from dse.storage import block_of, waveform_file

START_TIMEOUT = 60.0
"""Seconds a worker may take to start, to load a configuration or to write a file."""

MOST_DEATHS_LOADING = 2
"""Workers that may die of loading one configuration before its runs are given up; the first may have been unlucky."""

MOST_FRUITLESS_DEATHS = 3
"""Workers that may die in a row outside of any run before the exploration is given up."""

_LOOK_EVERY = 0.05

_CLOSED = "closed files that are not its own: the line to the study"

_UNTIL_GONE = 2.0
"""Seconds a process needs at most to be gone when its files are closed already."""

_SCRIBBLED = "wrote into a file that is not its own: the line to the study"


class Supervisor:
    """Works off batches with up to *workers* processes. Leaving its with block ends them, on an exception at once.

    With several *threads* in a worker, configurations that do not bear them have as many more workers instead.
    """

    remarks: tuple[str, ...] = ()

    def __init__(self, work: Work, sink: Sink, workers: int, threads: int = 1) -> None:
        self._configurations = work.configurations
        self._sink = sink
        self._workers_wanted = self._most = workers
        self._folder = tempfile.TemporaryDirectory(prefix="dse-", ignore_cleanup_errors=True)
        self._setup = Setup(work.make_runner, Path(self._folder.name), work.waveforms, work.measures, threads)
        self._workers: list[WorkerProcess] = []
        self._pending: deque[Batch] = deque()
        self._started = 0
        self._fruitless = 0
        self._retried: set[int] = set()
        self._deaths_loading: dict[str, list[str]] = {}
        self._looked = 0.0
        self._spare = count(1 << 40)

    @property
    def retried(self) -> int:
        """Runs that were tried again because their worker was killed from outside or had grown too large before."""
        return len(self._retried)

    def work_off(self, batches: Iterable[Batch]) -> None:
        """Carry out *batches*; returns when each of their runs has been given to the sink.

        DseError if workers die one after the other without getting as far as a run, or cannot store waveforms.
        """
        threads = self._setup.threads
        if threads == 1:
            self._work_off(batches, self._workers_wanted)
            return
        every = list(batches)
        self._work_off([b for b in every if self._configurations[b.configuration].thread_safe], self._workers_wanted)
        others = [replace(b, alone=True) for b in every if not self._configurations[b.configuration].thread_safe]
        self._work_off(others, self._workers_wanted * threads)

    def _work_off(self, batches: Iterable[Batch], workers: int) -> None:
        self._most = workers
        self._pending.extend(batches)
        while self._pending or any(worker.assignments for worker in self._workers):
            self._start_workers()
            self._assign()
            self._listen()
            self._look_for_hanging()
            self._look_for_growth()
            self._sink.tick()

    def __enter__(self) -> Supervisor:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with ExitStack() as last:
            last.callback(self._folder.cleanup)
            for worker in self._workers:
                last.callback(worker.reap)
                if error is None:
                    worker.dismiss()
                else:
                    last.callback(worker.kill)
            if error is not None:
                for worker in self._workers:
                    with suppress(DseError):  # one reason to stop is told already
                        self._receive(worker)

    def _start_workers(self) -> None:
        busy = sum(bool(worker.assignments) for worker in self._workers)
        while len(self._workers) < min(self._most, busy + len(self._pending)):
            self._workers.append(WorkerProcess(self._setup, Path(self._folder.name), self._started))
            self._started += 1

    def _assign(self) -> None:
        # A second batch on the line spares a worker the wait for the next one; at the end it would leave others idle.
        depth = 2 if len(self._pending) > len(self._workers) else 1
        for turn in range(depth):
            for worker in list(self._workers):
                if self._pending and len(worker.assignments) == turn:
                    batch = self._pending.popleft()
                    if self._cannot_be_loaded(batch):
                        continue
                    self._store(batch.configuration)
                    worker.give(batch)

    def _cannot_be_loaded(self, batch: Batch) -> bool:
        """Whether workers died of the configuration before they got to a run of it; then its runs are failures."""
        causes = self._deaths_loading.get(batch.configuration, [])
        if len(causes) < MOST_DEATHS_LOADING:
            return False
        self._fail(batch, causes[-1])
        self._sink.ended(batch, ())
        return True

    def _store(self, configuration: str) -> None:
        file = self._setup.file(configuration)
        if not file.exists():
            file.write_bytes(packed(self._configurations[configuration]).content)

    def _listen(self) -> None:
        channels = [worker.channel for worker in self._workers]
        ready = wait([*channels, *(worker.sentinel for worker in self._workers)], _LOOK_EVERY)
        for worker in list(self._workers):
            # Dead is dead, even if something the worker started still holds the far end of its pipe.
            if not self._receive(worker):
                self._part_with(worker)
            elif worker.sentinel in ready:
                if not worker.ends_within(_UNTIL_GONE):
                    worker.offence = _SCRIBBLED
                self._receive(worker)
                self._part_with(worker)

    def _receive(self, worker: WorkerProcess) -> bool:
        """Take all that *worker* has sent; False if it is dead, or has to die for its offence."""
        if worker.offence:
            return False
        try:
            for report in worker.reports():
                if not _is_expected(worker, report):
                    raise GarbledError
                self._take(worker, report)
                if worker.offence:
                    return False
        except GarbledError:
            worker.offence = _SCRIBBLED
            return False
        except (EOFError, OSError):
            return False
        return True

    def _take(self, worker: WorkerProcess, report: Report) -> None:
        if report.broken:
            worker.assignments.popleft()  # what it sends next is of the batch after
            raise fail(report.broken, hint="finished runs are stored: the same command goes on when there is room")
        assignment = worker.assignments[0]
        if report.block is not None:
            worker.useful = True
            assignment.received.update(report.block.numbers.tolist())
            assignment.failed.update(report.block.numbers[~report.block.done].tolist())
            self._sink.rows(assignment.batch, report.block)
        if report.ended:
            worker.assignments.popleft()
            self._fruitless = 0
            self._sink.ended(assignment.batch, report.kept)
        worker.retired = report.retired
        if report.hurt:
            worker.offence, worker.worn = report.hurt, worker.useful

    def _look_for_hanging(self) -> None:
        for worker in [worker for worker in self._workers if worker.assignments]:
            timeout = self._configurations[worker.assignments[0].batch.configuration].timeout
            for phase, silence in worker.silence().items():
                limit = timeout if phase is Phase.RUNNING else START_TIMEOUT
                if silence > limit and self._receive(worker) and worker.silence().get(phase, 0.0) > limit:
                    self._part_with(worker, f"no answer for {limit:g} s")
                    break

    def _look_for_growth(self) -> None:
        now = time.monotonic()
        if now - self._looked < _LOOK_EVERY:
            return
        self._looked = now
        for worker in [worker for worker in self._workers if worker.assignments]:
            worker.shorten_log()
            limit = self._configurations[worker.assignments[0].batch.configuration].memory
            if worker.resident() > limit:
                self._receive(worker)
                self._part_with(worker, f"grew beyond {limit / 1e9:.3g} GB of memory", again=worker.useful)
            elif worker.has_ended:
                # What it has started may hold on to what tells of its end.
                self._receive(worker)
                self._part_with(worker)

    def _part_with(self, worker: WorkerProcess, offence: str = "", *, again: bool = False) -> None:
        """Part with a worker that is dead or, for an *offence*, is to die: record what is its run's fault.

        The rest goes back to the front of the queue; with *again* also the run at hand if it was tried only once.
        """
        self._workers.remove(worker)
        traces = traces_of(worker)
        if offence or worker.offence:
            worker.kill()
        code = worker.reap()
        if code == CHANNEL_CLOSED:
            worker.offence = worker.offence or _CLOSED
        suspect = worker.assignments[0] if worker.offence and worker.assignments else None
        offence = worker.offence or offence
        cause = offence or cause_of(code)
        if traces.loading and not suspect:
            place = self._configurations[traces.loading].describe_progress(traces.progress)
            deaths = self._deaths_loading.setdefault(traces.loading, [])
            deaths.append(told(cause, place or "while its FMUs were loaded", traces.words))
        fruitful = suspect or traces.unfinished or traces.loading or (worker.useful and (worker.retired or again))
        self._fruitless = 0 if fruitful else self._fruitless + 1
        if self._fruitless >= MOST_FRUITLESS_DEATHS:
            raise _given_up(cause, traces)
        again = again or (not offence and sys.platform != "win32" and code == -signal.SIGKILL)
        for assignment in reversed(worker.assignments):
            rest = assignment.rest()
            if assignment is suspect:
                self._examine(assignment, offence, again=worker.worn)
                continue
            if not suspect and traces.unfinished and assignment is traces.at_hand and not worker.retired:
                rest = self._judge(rest, traces, cause, again=again)
            if rest.numbers:
                self._pending.appendleft(rest)
            else:
                self._sink.ended(assignment.batch, ())

    def _judge(self, rest: Batch, traces: Traces, cause: str, *, again: bool) -> Batch:
        """Record the run at hand if it is at fault; what of *rest* is to be made."""
        number = traces.unfinished[0]
        if self._in_threads(rest):
            return replace(rest, alone=True)
        if again and number not in self._retried:
            self._retried.add(number)
            return rest
        place = self._configurations[rest.configuration].describe_progress(traces.progress)
        # The same words whether it was tried again: that depends on how runs fall to workers, results must not.
        self._fail(rest, told(cause, place, traces.words), number)
        return rest.without({number})

    def _examine(self, suspect: Assignment, offence: str, *, again: bool) -> None:
        """Have the runs of *suspect* made in batches of their own; a single one is at fault."""
        rest = suspect.rest()
        if len(rest.numbers) > 1:
            self._pending.extendleft(self._single(rest, number) for number in reversed(rest.numbers))
            return
        number = next(iter(rest.numbers), None)
        if number is not None and again and number not in self._retried:
            self._retried.add(number)
            self._pending.appendleft(rest)
            return
        if number is not None and number not in suspect.received:
            self._fail(rest, offence)
        self._sink.ended(suspect.batch, ())

    def _single(self, batch: Batch, number: int) -> Batch:
        file = waveform_file(number, number) if batch.keep else ""
        single = batch.without({*batch.numbers} - {number})
        return replace(single, identity=next(self._spare), file=file)

    def _in_threads(self, batch: Batch) -> bool:
        return self._setup.threads > 1 and not batch.alone and len(batch.requests) > 1

    def _fail(self, batch: Batch, problem: str, number: int | None = None) -> None:
        """Tell the sink that the runs of *batch*, or the one with *number*, came to nothing."""
        runs = [failed_run(request, problem) for request in batch.requests if number in (None, request.number)]
        self._sink.rows(batch, block_of(runs, self._setup.measures))


def _given_up(cause: str, traces: Traces) -> DseError:
    where = outside_of_runs(traces)
    return fail(
        f"{MOST_FRUITLESS_DEATHS} workers in a row ended outside of any run, the last {where}: {cause}"
        + (f"\n{traces.words}" if traces.words else ""),
        hint="finished runs are stored: mend what the workers say and give the same command again",
    )


def _is_expected(worker: WorkerProcess, report: object) -> bool:
    """Whether *report* is of the batch at hand, and of runs that have not come yet."""
    if not isinstance(report, Report) or not worker.assignments:
        return False
    at_hand = worker.assignments[0]
    numbers = [] if report.block is None else report.block.numbers.tolist()
    fresh = {*at_hand.batch.numbers} - at_hand.received
    return report.identity == at_hand.batch.identity and len(numbers) == len({*numbers}) and fresh.issuperset(numbers)
