"""The world's half of a bench as a process: one session after another, each a fresh run."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum
from multiprocessing.connection import Connection
from multiprocessing.sharedctypes import RawArray
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.errors import DseError, fail
from dse.processes import forget_start, start_process
from dse.scratch import ScratchFolder

if TYPE_CHECKING:
    from dse.testbench import PreparedBench

_LOOK_EVERY = 0.05
_TELL_EVERY = 2.0
_END_WITHIN = 5.0
_ASKED = "asked to end the simulation"
"""What every session ends with; what is told behind it, of packets that were ignored, is worth telling."""


class What(StrEnum):
    """What there is to tell of a world."""

    CONNECTED = "connected"
    GOING = "going"
    ENDED = "ended"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class News:
    """*time* is simulated, in s, *steps* as many as exchanges, *rate* exchanges in a second of the wall clock."""

    what: What
    session: int
    steps: int = 0
    time: float = 0.0
    rate: float = 0.0
    why: str = ""

    @property
    def is_failed(self) -> bool:
        """Whether the session is over, and not as it should."""
        return self.what is What.FAILED

    @property
    def is_over(self) -> bool:
        """Whether this is the last of its session."""
        return self.what in (What.ENDED, What.FAILED)


def serve_world(prepared: PreparedBench) -> Iterator[News]:
    """Serve sessions until nobody asks for more news; *prepared* is a world's half (`dse.testbench.prepare_world`).

    A session whose simulation fails, crashes or hangs is told as failed, and the next one is served. Raises DseError
    if the simulation cannot even start.
    """
    with ScratchFolder() as scratch:
        number = 0
        while True:
            with _Process(prepared, Path(scratch) / "said") as process:
                for news in _watched(process, number):
                    number = news.session
                    yield news


class _Process:
    """The process that simulates; ended with this."""

    def __init__(self, prepared: PreparedBench, log: Path) -> None:
        from dse.cosim import PROGRESS_BYTES

        context = multiprocessing.get_context("spawn")
        self.prepared, self.log = prepared, log
        self.block: Any = RawArray("b", PROGRESS_BYTES)
        self.line, theirs = context.Pipe(duplex=False)
        self._process = context.Process(target=_simulate, args=(prepared, theirs, self.block, log), daemon=True)
        start_process(self._process, log)
        theirs.close()

    @property
    def progress(self) -> tuple[int, int]:
        """The number of the run, and the communication step it is in, -1 before the first."""
        from dse.cosim import run_and_step

        return run_and_step(bytes(self.block))

    @property
    def place(self) -> str:
        """The FMU, the call and the time."""
        return self.prepared.describe_progress(bytes(self.block))

    @property
    def said(self) -> str:
        """The last line it printed."""
        lines = self.log.read_text("utf-8", "replace").split("\n") if self.log.is_file() else []
        return next((line.strip() for line in reversed(lines) if line.strip()), "")

    def __enter__(self) -> _Process:
        return self

    def __exit__(self, *_: object) -> None:
        self._process.kill()
        self._process.join(_END_WITHIN)
        self.line.close()


def _watched(process: _Process, number: int) -> Iterator[News]:
    """What happens in *process*, until it has to be renewed; *number* is that of the last session."""
    step, patience = process.prepared.simulation.step, process.prepared.simulation.timeout
    seen, first, told = (0, -1), 0, 0
    began = moved = said = time.monotonic()
    is_on = False
    while True:
        came = _message(process)
        now = time.monotonic()
        run, steps = process.progress if came is None else came[:2]
        if (run, steps) != seen:
            seen, moved = (run, steps), now
        if steps >= 1 and not is_on:
            is_on, number, first, began, told, said = True, number + 1, steps, now, steps, now
            yield News(What.CONNECTED, number)
        if came is None and is_on and now - said >= _TELL_EVERY:
            yield News(What.GOING, number, steps, steps * step, (steps - told) / (now - said))
            told, said = steps, now
        if came is not None:
            _, _, why, is_good, is_over = came
            took = now - began if is_on else 0.0
            # A start that was made anew has no steps: the car found its first values, and asked with those.
            if is_on or not is_good:
                what, whole = (What.ENDED, took and (steps - first) / took) if is_good else (What.FAILED, 0.0)
                yield News(what, number, max(steps, 0), max(steps, 0) * step, whole, why)
            is_on, first = False, 0
            if is_over:
                return
        elif is_on and now - moved > patience:
            why = f"{process.place} does not come back"
            yield News(What.FAILED, number, steps, steps * step, 0.0, why)
            return


_Message = tuple[int, int, str, bool, bool]
"""Run, steps, why it ended, whether regularly, and whether this was the last of the process."""


def _message(process: _Process) -> _Message | None:
    """What came from *process* in a moment; what it died of is a message, too."""
    try:
        if not process.line.poll(_LOOK_EVERY):
            return None
        message: _Message | DseError = process.line.recv()
    except (EOFError, OSError):
        run, steps = process.progress
        said = f": {process.said}" if process.said else ""
        if run == 0:
            raise fail(f"the simulation of the world cannot start{said}") from None
        return run, steps, f"the process of the simulation has died, {process.place}{said}", False, True
    if isinstance(message, DseError):
        raise message
    return message


def _simulate(prepared: PreparedBench, line: Connection, block: Any, log: Path) -> None:
    """*In the process:* run after run, each of which waits for a session."""
    from dse.cosim import RunFailed, Simulator, run_and_step

    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    _print_to(log)
    forget_start()
    simulation, progress = prepared.simulation, memoryview(block).cast("B")
    try:
        simulator = Simulator(prepared.system, (), method=simulation.method, progress=progress, facts=prepared.facts)
    except DseError as error:
        line.send(error)
        return
    # The proof of a reset makes a run twice: nobody outside would know of it.
    simulator.reset_is_trusted = False
    # Of one more step the first call tells the last answer, and hears that it was the last.
    stop = (simulation.steps + 1) * simulation.step
    is_over = False
    while not is_over:
        why, is_good = "", True
        try:
            simulator.run(stop=stop, step=simulation.step)
            why = simulator.ended.partition(_ASKED)[2].lstrip(": ")
        except RunFailed as failure:
            why, is_good, is_over = str(failure), False, failure.fatal
            time.sleep(_LOOK_EVERY)  # what fails before there is a session fails again at once
        is_over |= simulator.runs_left is not None and simulator.runs_left <= 0
        line.send((*run_and_step(bytes(block)), why, is_good, is_over))


def _leave_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _print_to(log: Path) -> None:
    handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    for standard in (1, 2):
        os.dup2(handle, standard)
    os.close(handle)
    sys.stdout = open(1, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good
    sys.stderr = open(2, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good


def require_free(listen: str, port: int) -> None:
    """Raise DseError if nobody can listen at *listen* and *port*."""
    import socket

    family = socket.AF_INET6 if ":" in listen else socket.AF_INET
    try:
        with socket.socket(family, socket.SOCK_DGRAM) as line:
            line.bind((listen, port))
    except OSError as error:
        hint = "another program listens there: choose another --port" if error.errno == 98 else ""
        raise fail(f"cannot listen at {listen}:{port}: {error.strerror}", hint=hint) from error
