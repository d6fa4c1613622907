"""The worker process: takes batches from its channel, simulates, sends arrays of results back.

It imports only what simulating needs, so that a new one is there in a fraction of a second.
"""

from __future__ import annotations

import errno
import gc
import os
import signal
import socket
import sys
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import suppress
from multiprocessing import parent_process, resource_tracker
from pathlib import Path
from queue import SimpleQueue
from typing import NoReturn

from dse.domain.run import Run
from dse.exploration.supervision.channel import receive, send
from dse.exploration.supervision.guarded_runner import GuardedRunner
from dse.exploration.supervision.heartbeat import Heartbeat, Phase
from dse.exploration.supervision.messages import Report, Setup
from dse.exploration.supervision.open_files import SpareFiles
from dse.exploration.work import Batch
from dse.processes import forget_start
from dse.sandbox import protect_parent
from dse.storage import LogWriter, RowBlock, assemble, block_of, read_log, this_process

_SEND_EVERY = 0.1
_TURN = 1e-4

CHANNEL_CLOSED = 117
"""Exit code of a worker whose channel was closed behind its back."""


def serve_spawned(channel: socket.socket, setup: Setup, heartbeat: Path, log: Path) -> None:
    """Serve batches until None comes or the supervisor is gone. What simulations print goes to *log*."""
    _let_go_of_the_tracker()
    _serve(channel, setup, heartbeat, log)


def serve_copied(channel: socket.socket, setup: Setup, heartbeat: Path, log: Path, foreign: Sequence[int]) -> None:
    """As `serve_spawned`, in a copy of the supervisor's process, whose files are *foreign*."""
    for number in foreign:
        with suppress(OSError):
            os.close(number)
    _serve(channel, setup, heartbeat, log)


def _serve(channel: socket.socket, setup: Setup, heartbeat: Path, log: Path) -> None:
    _leave_signals_to_the_supervisor()
    protect_parent()
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    _print_to(log)
    if setup.sandbox is not None:
        setup.sandbox.move_in()
    forget_start()
    gc.freeze()  # what was imported stays: it is not looked through again and again, nor at the end of the process
    gc.set_threshold(50_000, 20, 20)  # configurations are trees of thousands of nouns without circles
    spare = SpareFiles()
    hearts = [Heartbeat(heartbeat, thread) for thread in range(setup.threads)]
    runners = [GuardedRunner(setup, heart) for heart in hearts]
    if setup.threads > 1:
        # A thread that comes back from its simulation would wait for the interpreter's lock longer than a run takes.
        sys.setswitchinterval(_TURN)
    for heart in hearts:
        heart.beat(Phase.WAITING)
    try:
        while (batch := receive(channel)) is not None:
            if _is_too_much(batch, runners):
                _retire(channel, Report(batch.identity, retired=True, fault=runners[0].fault))
            _carry_out(batch, runners, channel, setup, hearts[0], spare)
            hearts[0].beat(Phase.WAITING)
        for runner in runners:
            runner.clear()
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
    except OSError as error:
        if error.errno not in (errno.EBADF, errno.ENOTSOCK):
            raise
        os._exit(CHANNEL_CLOSED)


def _is_too_much(batch: Batch, runners: Sequence[GuardedRunner]) -> bool:
    """Whether a fresh process is to be left the batch, as this one cannot make all of its runs any more."""
    if not any(runner.runs for runner in runners):
        return False
    if not batch.todo:
        return False
    runners[0].load(batch)
    left = runners[0].runs_left
    return left is not None and left < len(batch.todo)


def _carry_out(
    batch: Batch,
    runners: Sequence[GuardedRunner],
    channel: socket.socket,
    setup: Setup,
    heart: Heartbeat,
    spare: SpareFiles,
) -> None:
    finished: list[tuple[Run, float]] = []
    done = 0
    sent = time.perf_counter()
    log = _Spool(batch, setup, runners, channel, spare)
    for run, seconds in simulate(batch, runners):
        log.add(run, seconds)
        finished.append((run, seconds))
        done += 1
        if time.perf_counter() - sent > _SEND_EVERY:
            send(channel, Report(batch.identity, _block(finished, setup)))
            finished, sent = [], time.perf_counter()
    log.close()
    block = _block(finished, setup) if finished else None
    if done < len(batch.todo):
        fault = next((runner.fault for runner in runners if runner.fault), None)
        _retire(channel, Report(batch.identity, block, retired=True, fault=fault))
    kept: tuple[int, ...] = ()
    if batch.makes_file:
        if not log.is_whole:  # and the supervisor may not have written the rest yet
            _retire(channel, Report(batch.identity, block, retired=True))
        heart.beat(Phase.WRITING, batch.identity)
        for runner in runners:
            runner.put_back()
        spare.give()
        try:
            logged = read_log(setup.log_folder, setup.measures, setup.study, batch.name)
            kept = assemble(setup.waveforms / batch.file, logged, batch.numbers)
        except (OSError, MemoryError, ImportError) as error:
            # Where FMUs have run, whatever fails may be their doing: it is for a fresh process to say.
            is_harmed = any(runner.runs for runner in runners)
            broken = "" if is_harmed else f"waveforms cannot be written: {getattr(error, 'strerror', None) or error}"
            _retire(channel, Report(batch.identity, block, retired=True, broken=broken))
        spare.take()
    retired = are_spent(runners)
    report = Report(batch.identity, block, ended=True, kept=kept, retired=retired)
    if retired:
        _retire(channel, report)
    send(channel, report)


class _Spool:
    """Appends the runs of *batch* to the write-ahead log, for which a run may have left neither room nor files.

    What cannot be written here is sent to the supervisor, which no FMU has harmed: *is_whole*: nothing was.
    """

    def __init__(
        self,
        batch: Batch,
        setup: Setup,
        runners: Sequence[GuardedRunner],
        channel: socket.socket,
        spare: SpareFiles,
    ) -> None:
        self._batch, self._setup, self._runners, self._spare = batch, setup, runners, spare
        self._channel = channel
        self.is_whole = True
        self._writer = self._new()

    def add(self, run: Run, seconds: float) -> None:
        """Append *run*."""
        try:
            self._writer.add(run, seconds)
        except OSError:
            self._add_again(run, seconds)

    def close(self) -> None:
        """No more runs come."""
        with suppress(OSError):
            self._writer.close()

    def _add_again(self, run: Run, seconds: float) -> None:
        for runner in self._runners:
            runner.put_back()
        self._spare.give()
        self.close()
        self._writer = self._new()
        try:
            self._writer.add(run, seconds)
        except OSError:
            self.is_whole = False
            send(self._channel, Report(self._batch.identity, logged=self._writer.alone(run, seconds)))
        self._spare.take()

    def _new(self) -> LogWriter:
        setup = self._setup
        return LogWriter(setup.log_folder, self._batch.name, this_process(), setup.measures, setup.study)


def _block(finished: Sequence[tuple[Run, float]], setup: Setup) -> RowBlock:
    return block_of([run for run, _ in finished], setup.measures, [seconds for _, seconds in finished])


def _retire(channel: socket.socket, report: Report) -> NoReturn:
    send(channel, report)
    # At once: an FMU that must not be called any more could be, by what its library does at the end of a process.
    os._exit(0)


def _leave_signals_to_the_supervisor() -> None:
    # Ctrl-C reaches the whole terminal group, and so may the others; it is the supervisor that decides what to do.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if sys.platform != "win32":
        for number in (signal.SIGTERM, signal.SIGHUP):
            # Unlike one that is ignored, such a signal still ends a program that an FMU starts.
            signal.signal(number, lambda *_: None)
            signal.siginterrupt(number, False)


def _let_go_of_the_tracker() -> None:
    # A helper process of multiprocessing, of no use here: whatever an FMU wrote to it would appear on the terminal.
    if sys.platform != "win32":
        tracker = resource_tracker.getfd()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        if tracker is not None:
            os.dup2(nowhere, tracker)
        os.close(nowhere)


def _leave_with_parent() -> None:
    # A simulation that hangs never comes back to the channel to learn that nobody listens any more.
    parent = parent_process()
    if parent is not None:
        before = os.getppid()
        parent.join()
        os._exit(1 if os.getppid() != before or sys.platform == "win32" else CHANNEL_CLOSED)


def _print_to(log: Path) -> None:
    # Also for C code: what an FMU prints must neither garble a progress bar nor the output a program reads.
    # Appending lets the supervisor cut the file while it is in use.
    handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    for standard in (1, 2):
        os.dup2(handle, standard)
    os.close(handle)
    sys.stdout = open(1, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good
    sys.stderr = open(2, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good


# The runs of a batch in one worker: one after the other, or several at once in threads.
#
# Threads help where simulating leaves the interpreter's lock alone, as calls into C do.


def simulate(batch: Batch, runners: Sequence[GuardedRunner]) -> Iterator[tuple[Run, float]]:
    """The runs of *batch* as they are finished, each with the seconds it took.

    Ends early if the process must not make another run.
    """
    if len(runners) == 1 or batch.alone or len(batch.todo) == 1:
        return _in_turn(batch, runners[0])
    return _side_by_side(batch, runners)


def are_spent(runners: Sequence[GuardedRunner]) -> bool:
    """Whether the process must not make another run."""
    return any(runner.runs_left == 0 for runner in runners)


def _in_turn(batch: Batch, runner: GuardedRunner) -> Iterator[tuple[Run, float]]:
    end = time.perf_counter()
    for request in batch.todo:
        if are_spent((runner,)):
            return
        start = end
        run = runner.run(batch, request)
        if run is None:
            return
        end = time.perf_counter()
        yield run, end - start


def _side_by_side(batch: Batch, runners: Sequence[GuardedRunner]) -> Iterator[tuple[Run, float]]:
    todo = deque(batch.todo)
    finished: SimpleQueue[tuple[Run, float] | None] = SimpleQueue()

    def serve(runner: GuardedRunner) -> None:
        try:
            while not are_spent(runners):
                try:
                    request = todo.popleft()
                except IndexError:
                    break
                start = time.perf_counter()
                run = runner.run(batch, request)
                if run is None:
                    break
                finished.put((run, time.perf_counter() - start))
        finally:
            runner.rest()
            finished.put(None)

    threads = [threading.Thread(target=serve, args=(runner,), daemon=True) for runner in runners]
    for thread in threads:
        thread.start()
    at_work = len(threads)
    while at_work:
        result = finished.get()
        if result is None:
            at_work -= 1
        else:
            yield result
    for thread in threads:
        thread.join()
