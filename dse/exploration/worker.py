"""The worker process: takes batches from its pipe, simulates, sends arrays of results back.

It imports only what simulating needs, so that a new one is there in a fraction of a second.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import time
import traceback
from multiprocessing import parent_process
from multiprocessing.connection import Connection
from pathlib import Path

from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.errors import DseError
from dse.exploration.heartbeat import Heartbeat, Phase
from dse.exploration.job import Batch, Executor, Report, Setup
from dse.results.rows import block_of
from dse.results.waveforms import write_waveforms

_SEND_EVERY = 0.1
_LARGEST_LOG = 4_000_000


def work(connection: Connection[Report, Batch | None], setup: Setup, heartbeat: Path, log: Path) -> None:
    """Serve batches until None comes or the supervisor is gone. What simulations print goes to *log*."""
    # Ctrl-C reaches the whole terminal group; it is the supervisor that decides what to do about it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    _print_to(log)
    heart = Heartbeat(heartbeat)
    bench = _Seat(setup, heart)
    heart.beat(Phase.WAITING)
    try:
        while (batch := connection.recv()) is not None:
            _carry_out(batch, bench, connection, setup, heart)
            heart.beat(Phase.WAITING)
            _shorten_log()
        bench.clear()
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return


def failed_run(request: RunRequest, problem: str) -> Run:
    """A run that came to nothing because of *problem*."""
    return Run(request, Outcome.FAILED, problem=problem)


def bench_file(setup: Setup, configuration: str) -> Path:
    """Where the pickled bench of *configuration* lies; an id may hold what a file name may not."""
    return setup.benches / f"{configuration.encode().hex()[:200]}.bench"


class _Seat:
    """The executor of the configuration at hand; the one before is closed."""

    def __init__(self, setup: Setup, heart: Heartbeat) -> None:
        self._setup = setup
        self._heart = heart
        self._progress = heart.block
        self._configuration = ""
        self._executor: Executor | None = None
        self._problem = ""

    def run(self, batch: Batch, request: RunRequest) -> Run:
        """Simulate *request*; whatever is raised becomes a failed run."""
        if self._configuration != request.configuration:
            self._heart.beat(Phase.LOADING, batch.identity, request.number)
            self._load(request.configuration)
        if self._executor is None:
            return failed_run(request, self._problem)
        self._progress[:] = bytes(len(self._progress))
        self._heart.beat(Phase.RUNNING, batch.identity, request.number)
        try:
            return _complete(self._executor.run(request, keep=batch.keep), self._setup)
        except Exception as error:  # noqa: BLE001  # a failed run is a row, not the end of the study
            # What state the simulation is in now is anyone's guess: the next run starts with a new one.
            self.clear()
            return failed_run(request, _in_words(error))

    def clear(self) -> None:
        """Close the executor, if there is one."""
        executor, self._executor, self._configuration = self._executor, None, ""
        if executor is not None:
            try:
                executor.close()
            except Exception:  # noqa: BLE001  # its runs are done and stored; all that is lost is the tidying up
                traceback.print_exc()

    def _load(self, configuration: str) -> None:
        self.clear()
        try:
            bench = pickle.loads(bench_file(self._setup, configuration).read_bytes())  # noqa: S301  # our supervisor's
            self._executor = self._setup.make_executor(bench, self._progress)
        except Exception as error:  # noqa: BLE001  # each of its runs fails, other configurations go on
            self._problem = _in_words(error)
        self._configuration = configuration


def _complete(run: Run, setup: Setup) -> Run:
    if run.outcome is Outcome.DONE:
        missing = {*setup.metrics} - {*run.metrics} or {*setup.requirements} - {j.requirement for j in run.judgements}
        if missing:
            raise LookupError(f"the simulation gave no {', '.join(sorted(missing))}")
    return run


def _carry_out(
    batch: Batch, bench: _Seat, connection: Connection[Report, Batch | None], setup: Setup, heart: Heartbeat
) -> None:
    runs: list[Run] = []
    wall: list[float] = []
    kept: list[tuple[int, Waveforms]] = []
    sent = end = time.perf_counter()
    for number, point in zip(batch.numbers, batch.points, strict=True):
        start = end
        request = RunRequest(number, batch.configuration, dict(zip(batch.names, point, strict=True)))
        run = bench.run(batch, request)
        end = time.perf_counter()
        runs.append(run)
        wall.append(end - start)
        if batch.keep and run.waveforms is not None:
            kept.append((number, run.waveforms))
        if end - sent > _SEND_EVERY:
            connection.send(Report(batch.identity, block_of(runs, wall, setup.metrics, setup.requirements)))
            runs, wall, sent = [], [], end
    if kept:
        heart.beat(Phase.WRITING, batch.identity)
        try:
            write_waveforms(setup.waveforms / batch.file, kept)
        except OSError as error:
            connection.send(Report(batch.identity, broken=f"waveforms cannot be written: {error.strerror or error}"))
            return
    block = block_of(runs, wall, setup.metrics, setup.requirements) if runs else None
    connection.send(Report(batch.identity, block, ended=True, kept=tuple(number for number, _ in kept)))


def _in_words(error: Exception) -> str:
    if isinstance(error, DseError):
        return str(error)
    traceback.print_exception(error)
    frame = traceback.extract_tb(error.__traceback__)[-1]
    return f"unexpected {type(error).__name__} at {Path(frame.filename).name}:{frame.lineno}: {error}".rstrip(": ")


def _leave_with_parent() -> None:
    # A simulation that hangs never comes back to the pipe to learn that nobody listens any more.
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _print_to(log: Path) -> None:
    # Also for C code: what an FMU prints must neither garble a progress bar nor the output a program reads.
    # Appending lets `_shorten_log` cut the file while it is in use.
    handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    for standard in (1, 2):
        os.dup2(handle, standard)
    os.close(handle)
    sys.stdout = open(1, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good
    sys.stderr = open(2, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good


def _shorten_log() -> None:
    if os.fstat(2).st_size > _LARGEST_LOG:
        os.ftruncate(2, 0)
