"""Worker processes and the one that watches them: no finished run is lost, no dead or hanging worker holds up a study.

Each worker has a channel of its own, so a worker that dies can only take with it what it had not sent yet. What it died
of may be the fault of the run at hand, of one before, or of nobody here: the run is tried once more, alone in a fresh
process, and what comes of that is its result; so it does not depend on how runs fell to workers. The rest of its batch
goes to another worker. The same holds for a configuration that was being loaded. A death outside of any run is counted:
with a few in a row that no run came back before, the exploration is given up. Nothing is tried without end.

Example: a batch has the runs 1, 2, 3 and 4, and its worker dies in run 2.

    run 1 was sent, or is read from what the worker had spooled: it is stored
    run 2 is repeated alone in a fresh process: a result, or a second death, which makes it a failed run with its cause
    runs 3 and 4 go back to the front of the queue, as a batch of their own
    five workers in a row that die outside of a run, before any of them made one, end the exploration with an error

Cost: one look at the workers each 0.05 s, and one process start for each run that is repeated
(0.3 s). Why processes with a pipe each: docs/decisions/0006-study-folder.md; memory and threads: 0011-trust.md.
"""

from __future__ import annotations

import math
import shutil
import tempfile
import time
from collections.abc import Iterable
from contextlib import ExitStack, suppress
from dataclasses import replace
from multiprocessing.connection import wait
from pathlib import Path
from types import TracebackType

import numpy as np

from dse.errors import DseError, fail
from dse.exploration.failures import not_stored
from dse.exploration.packed_configuration import Packer
from dse.exploration.supervision.channel import GarbledError
from dse.exploration.supervision.heartbeat import Phase, states_in
from dse.exploration.supervision.messages import Report, Setup, in_sandbox
from dse.exploration.supervision.post_mortem import Traces, cause_of, outside_of_runs, told, traces_of
from dse.exploration.supervision.work_queue import WorkQueue
from dse.exploration.supervision.worker import CHANNEL_CLOSED
from dse.exploration.supervision.worker_process import Assignment, WorkerProcess
from dse.exploration.work import Batch, Sink, Work
from dse.scratch import ScratchFolder
from dse.storage import STOPPED, Attempt, RowBlock, logged_names, made_by, read_log, write_logged

START_TIMEOUT = 60.0
"""Seconds a worker may take to start, to load a configuration or to write a file."""

MOST_FRUITLESS_DEATHS = 5
"""Workers that may die in a row outside of any run, none of which had made one, before the exploration is given up."""

_FOLDER = "workers-"

_LOOK_EVERY = 0.05

_LONGEST_LOOK = 0.1
"""Seconds that count at most between two looks at the workers."""

_CLOSED = "closed files that are not its own: the line to the study"

_UNTIL_GONE = 2.0
"""Seconds a process needs at most to be gone when its files are closed already."""

_SCRIBBLED = "wrote into a file that is not its own: the line to the study"


class Supervisor:
    """Works off batches with up to *workers* processes. Leaving its with block ends them, on an exception at once.

    With several *threads* in a worker, configurations that do not bear them have as many more workers instead.
    """

    remarks: tuple[str, ...] = ()

    def __init__(
        self, work: Work, sink: Sink, workers: int, threads: int = 1, *, sandboxed: bool = False, copied: bool = False
    ) -> None:
        self._configurations = work.configurations
        self._packer = Packer()
        self._sink = sink
        self._workers_wanted = self._most = workers
        log_folder, waveforms = work.log_folder.absolute(), work.waveforms.absolute()
        log_folder.mkdir(parents=True, exist_ok=True)
        # In a sandbox the write-ahead log can be written, and what this process reads again must not be.
        self._folder = ScratchFolder() if sandboxed else _beside(log_folder)
        place = Path(self._folder.name)
        self._setup = Setup(work.make_runner, place, waveforms, log_folder, work.measures, work.study, threads)
        if sandboxed:
            self._setup = in_sandbox(self._setup)
        elif copied:
            self._setup = replace(self._setup, copied=True)
        self._workers: list[WorkerProcess] = []
        self._queue = WorkQueue(sink, work.measures)
        self._started = 0
        self._fruitless = 0
        self._looked = time.monotonic()

    @property
    def retried(self) -> int:
        """How many runs were tried twice, as the first time need not have been their fault."""
        return self._queue.retried

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
        logged = logged_names(self._setup.log_folder)
        self._queue.fill(self._less_logged(batch) if batch.name in logged else batch for batch in batches)
        self._report_interrupted()
        while len(self._queue) or any(worker.assignments for worker in self._workers):
            self._start_workers()
            self._assign()
            self._listen()
            self._look_after_workers()
            self._sink.tick()

    def _less_logged(self, batch: Batch) -> Batch:
        """*batch* without the runs whose waveforms are in the write-ahead log, as their rows are in the folder, from
        before."""
        setup = self._setup
        logged = read_log(setup.log_folder, setup.measures, setup.study, batch.name) if batch.keep else []
        return batch.after({number for each in logged for number in each.kept}.intersection(batch.numbers))

    def _report_interrupted(self) -> None:
        """Tell of runs that were begun when a supervisor before this one was killed with its workers."""
        for folder in self._setup.log_folder.glob(f"{_FOLDER}*"):
            if folder != self._setup.configurations:
                asked = self._queue.numbers()
                for state in (state for file in folder.glob("*.beat") for state in states_in(file)):
                    if state.phase is Phase.RUNNING and state.number in asked:
                        attempt = Attempt(state.number, made_by(state.process), STOPPED, math.nan)
                        self._sink.tried([attempt])
                shutil.rmtree(folder, ignore_errors=True)

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
                    worker.kill()
            if error is not None:
                for worker in self._workers:
                    with suppress(DseError):  # one reason to stop is told already
                        self._take_last(worker)

    def _take_last(self, worker: WorkerProcess) -> None:
        """Take what there is of a *worker* that was killed, and tell of the runs it was in."""
        worker.end()
        self._receive(worker)
        self._recover(worker)
        traces = traces_of(worker)
        tries = [Attempt(number, worker.maker, STOPPED, traces.seconds) for number in traces.unfinished]
        self._sink.tried(tries)

    def _start_workers(self) -> None:
        busy = sum(bool(worker.assignments) for worker in self._workers)
        wanted = min(self._most, busy + len(self._queue))
        if self._queue.wants_fresh and len(self._workers) >= wanted and all(worker.used for worker in self._workers):
            idle = next((worker for worker in self._workers if not worker.assignments), None)
            if idle is not None:
                self._workers.remove(idle)
                idle.kill()
                idle.reap()
        while len(self._workers) < wanted:
            self._workers.append(WorkerProcess(self._setup, Path(self._folder.name), self._started))
            self._started += 1

    def _assign(self) -> None:
        # A second batch on the line spares a worker the wait for the next one; at the end it would leave others idle.
        depth = 2 if len(self._queue) > len(self._workers) else 1
        is_choice = len(self._workers) > 1
        for turn in range(depth):
            for worker in list(self._workers):
                if len(worker.assignments) == turn and not worker.offence:
                    batch = self._queue.take(
                        fresh=not worker.used,
                        maker=worker.maker if is_choice else None,
                        loaded=worker.configuration,
                        others={other.configuration for other in self._workers if other is not worker},
                    )
                    if batch is not None:
                        self._store(batch.configuration)
                        worker.give(batch)

    def _store(self, configuration: str) -> None:
        file = self._setup.file(configuration)
        if not file.exists():
            file.write_bytes(self._packer.pack(self._configurations[configuration]).content)

    def _listen(self) -> None:
        heard = [worker for worker in self._workers if not worker.offence]
        ready = wait([end for worker in heard for end in (worker.channel, worker.sentinel)], _LOOK_EVERY)
        for worker in heard:
            # Dead is dead, even if something the worker started still holds the far end of its pipe.
            if not self._receive(worker):
                self._part_with(worker)
            elif worker.sentinel in ready and not worker.offence:
                is_gone = worker.ends_within(_UNTIL_GONE)
                self._receive(worker)
                if is_gone:
                    self._part_with(worker)
                else:
                    worker.cut_off(_SCRIBBLED)

    def _receive(self, worker: WorkerProcess) -> bool:
        """Take all that *worker* has sent; False if it is dead.

        One that sends anything else is not listened to any more: what it makes is in the write-ahead log.
        """
        try:
            for report in worker.reports():
                if not _is_expected(worker, report):
                    raise GarbledError
                self._take(worker, report)
        except GarbledError:
            worker.cut_off(_SCRIBBLED)
        except (EOFError, OSError):
            if worker.ends_within(_UNTIL_GONE):
                return False
            worker.cut_off(_CLOSED)
        return True

    def _take(self, worker: WorkerProcess, report: Report) -> None:
        assignment = worker.assignments[0]
        if report.logged:
            self._write_logged(assignment.batch, report.logged)
        if report.block is not None:
            self._take_rows(worker, assignment, report.block)
        if report.broken:
            worker.assignments.popleft()  # what it sends next is of the batch after
            raise not_stored(report.broken)
        if report.ended:
            worker.assignments.popleft()
            worker.useful, self._fruitless = True, 0
            self._queue.end(assignment.batch, report.kept)
        worker.retired, worker.fault = report.retired, report.fault

    def _write_logged(self, batch: Batch, content: bytes) -> None:
        try:
            write_logged(self._setup.log_folder, batch.name, content)
        except OSError as error:
            raise not_stored(f"results cannot be written: {error.strerror or error}") from error

    def _take_rows(self, worker: WorkerProcess, assignment: Assignment, block: RowBlock) -> None:
        worker.useful, self._fruitless = True, 0
        assignment.received.update(block.numbers.tolist())
        self._queue.is_loaded(assignment.batch.configuration)
        self._sink.rows(assignment.batch, block)

    def _recover(self, worker: WorkerProcess) -> None:
        """Take what a dead *worker* had spooled and not sent."""
        setup = self._setup
        for assignment in worker.assignments:
            for logged in read_log(setup.log_folder, setup.measures, setup.study, assignment.batch.name):
                if logged.block.maker != worker.maker:
                    continue  # a batch before it had the same name: what is repeated must not be taken from there
                missing = assignment.missing
                rows = [row for row, number in enumerate(logged.block.numbers.tolist()) if number in missing]
                if rows:
                    self._take_rows(worker, assignment, logged.block.part(np.array(rows, np.intp)))

    def _look_after_workers(self) -> None:
        now = time.monotonic()
        if now - self._looked < _LOOK_EVERY:
            return
        # Where it was longer, this process was stopped or had no processor, and so may the workers.
        passed, self._looked = min(now - self._looked, _LONGEST_LOOK), now
        for worker in [worker for worker in self._workers if worker.assignments or worker.offence]:
            worker.shorten_log()
            worker.pass_time(passed)
            if worker.has_ended:
                # What it has started may hold on to what tells of its end.
                self._receive(worker)
                self._part_with(worker)
            elif self._offence_of(worker) and self._receive(worker) and (offence := self._offence_of(worker)):
                self._part_with(worker, offence)

    def _offence_of(self, worker: WorkerProcess) -> str:
        """Why *worker* has to be ended, "" if it has not."""
        if not worker.assignments:
            return worker.offence
        configuration = self._configurations[worker.assignments[0].batch.configuration]
        if worker.resident() > configuration.memory:
            return f"grew beyond {configuration.memory / 1e9:.3g} GB of memory"
        for phase, silence in worker.silence().items():
            limit = configuration.timeout if phase is Phase.RUNNING else START_TIMEOUT
            if silence > limit:
                is_slow = phase is Phase.RUNNING and worker.standstill < limit / 2
                return f"took longer than its limit of {limit:g} s" if is_slow else f"no answer for {limit:g} s"
            if worker.stopped > limit:
                return f"stopped by a signal for {limit:g} s"
        return ""

    def _part_with(self, worker: WorkerProcess, offence: str = "") -> None:
        """Part with a worker that is dead, has left or, for an *offence*, is to die: charge it to who may be at fault.

        What was not at hand goes back to the front of the queue.
        """
        self._workers.remove(worker)
        if offence:
            worker.kill()
        code = worker.end()
        self._recover(worker)
        traces = traces_of(worker)
        worker.free()
        if code == CHANNEL_CLOSED:
            worker.offence = worker.offence or _CLOSED
        cause = offence or (worker.offence if code in (0, CHANNEL_CLOSED) else "") or cause_of(code)
        at_hand = self._charge(worker, traces, cause)
        for assignment in reversed(worker.assignments):
            if assignment is not at_hand:
                self._queue.pass_on(assignment.rest())

    def _charge(self, worker: WorkerProcess, traces: Traces, cause: str) -> Assignment | None:
        """Have somebody answer for the end of *worker*; the assignment that is taken care of with that."""
        at_hand = worker.assignments[0] if worker.assignments else None
        fault = worker.fault
        if at_hand and fault and fault.number is not None:
            self._queue.try_again(at_hand.rest(), {fault.number: fault.cause}, worker.maker, fault.seconds)
        elif at_hand and fault:
            self._queue.load_again(at_hand.rest(), fault.cause, worker.maker, fault.seconds)
        elif traces.at_hand and traces.unfinished and not worker.retired:
            first, *others = traces.unfinished
            place = "" if cause == worker.offence else self._place(traces.at_hand, traces)
            causes = {first: told(cause, place, traces.words), **dict.fromkeys(others, cause)}
            self._queue.try_again(traces.at_hand.rest(), causes, worker.maker, traces.seconds)
            return traces.at_hand
        elif traces.loading and not worker.retired:
            place = self._place(traces.loading, traces) or "while its FMUs were loaded"
            words = told(cause, place, traces.words)
            self._queue.load_again(traces.loading.rest(), words, worker.maker, traces.seconds)
            return traces.loading
        else:
            self._fruitless = 0 if worker.useful else self._fruitless + 1
            if self._fruitless >= MOST_FRUITLESS_DEATHS:
                raise _given_up(cause, traces)
            return None
        return at_hand

    def _place(self, assignment: Assignment, traces: Traces) -> str:
        return self._configurations[assignment.batch.configuration].describe_progress(traces.progress)


def _beside(log_folder: Path) -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix=_FOLDER, dir=log_folder, ignore_cleanup_errors=True)


def _given_up(cause: str, traces: Traces) -> DseError:
    where = outside_of_runs(traces)
    return fail(
        told(
            f"{MOST_FRUITLESS_DEATHS} workers in a row ended outside of any run, the last {where}: {cause}",
            "",
            traces.words,
        ),
        hint="finished runs are stored: mend what the workers report and give the same command again",
    )


def _is_expected(worker: WorkerProcess, report: object) -> bool:
    """Whether *report* is of the batch at hand, and of runs that have not come yet."""
    if not isinstance(report, Report) or not worker.assignments:
        return False
    at_hand = worker.assignments[0]
    numbers = [] if report.block is None else report.block.numbers.tolist()
    is_new = len(numbers) == len({*numbers}) and at_hand.missing.issuperset(numbers)
    return report.identity == at_hand.batch.identity and is_new
