"""The worker process: takes batches from its line, simulates, sends arrays of results back.

It imports only what simulating needs, so that a new one is there in a fraction of a second.
"""

from __future__ import annotations

import errno
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Sequence
from multiprocessing import parent_process, resource_tracker
from pathlib import Path
from typing import NoReturn

from dse.domain.run import Run, Waveforms
from dse.exploration.crew import are_spent, simulate
from dse.exploration.heartbeat import Heartbeat, Phase
from dse.exploration.job import Batch, Report, Setup
from dse.exploration.line import receive, send
from dse.exploration.open_files import OUT_OF_FILES, SpareFiles
from dse.exploration.seat import Seat
from dse.storage.rows import block_of
from dse.storage.waveforms import write_waveforms

_SEND_EVERY = 0.1
_TURN = 1e-4

LINE_CLOSED = 117
"""Exit code of a worker whose line was closed behind its back."""

_HARMED = OUT_OF_FILES | {errno.EFBIG}
"""What another process would not be told when it writes a file: a run has used up or changed the limits of this one."""


def work(line: socket.socket, setup: Setup, heartbeat: Path, log: Path) -> None:
    """Serve batches until None comes or the supervisor is gone. What simulations print goes to *log*."""
    # Ctrl-C reaches the whole terminal group; it is the supervisor that decides what to do about it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    _print_to(log)
    _let_go_of_the_tracker()
    spare = SpareFiles()
    hearts = [Heartbeat(heartbeat, seat) for seat in range(setup.threads)]
    seats = [Seat(setup, heart) for heart in hearts]
    if setup.threads > 1:
        # A thread that comes back from its simulation would wait for the interpreter's lock longer than a run takes.
        sys.setswitchinterval(_TURN)
    for heart in hearts:
        heart.beat(Phase.WAITING)
    try:
        while (batch := receive(line)) is not None:
            if _is_too_much(batch, seats):
                _retire(line, Report(batch.identity, retired=True))
            _carry_out(batch, seats, line, setup, hearts[0], spare)
            hearts[0].beat(Phase.WAITING)
        for seat in seats:
            seat.clear()
    except (EOFError, BrokenPipeError, ConnectionResetError):
        return
    except OSError as error:
        if error.errno not in (errno.EBADF, errno.ENOTSOCK):
            raise
        os._exit(LINE_CLOSED)


def _is_too_much(batch: Batch, seats: Sequence[Seat]) -> bool:
    """Whether a fresh process is to be left the batch, as this one cannot make all of its runs any more."""
    if not any(seat.runs for seat in seats):
        return False
    seats[0].load(batch)
    left = seats[0].runs_left
    return left is not None and left < len(batch.numbers)


def _carry_out(
    batch: Batch, seats: Sequence[Seat], line: socket.socket, setup: Setup, heart: Heartbeat, spare: SpareFiles
) -> None:
    is_fresh = not any(seat.runs for seat in seats)
    runs: list[Run] = []
    wall: list[float] = []
    kept: list[tuple[int, Waveforms]] = []
    done = 0
    sent = time.perf_counter()
    for run, seconds in simulate(batch, seats):
        runs.append(run)
        wall.append(seconds)
        done += 1
        if batch.keep and run.waveforms is not None:
            kept.append((run.request.number, run.waveforms))
        if time.perf_counter() - sent > _SEND_EVERY:
            send(line, Report(batch.identity, block_of(runs, wall, setup.metrics, setup.requirements)))
            runs, wall, sent = [], [], time.perf_counter()
    hurt = next((seat.hurt for seat in seats if seat.hurt), "")
    if done < len(batch.numbers) and batch.keep and is_fresh and any(seat.has_many_open for seat in seats):
        # No other process would come to the end of it either.
        hurt = hurt or "too many open files"
    if done < len(batch.numbers) or hurt:
        block = block_of(runs, wall, setup.metrics, setup.requirements) if runs else None
        _retire(line, Report(batch.identity, block, retired=not hurt, hurt=hurt))
    if kept:
        heart.beat(Phase.WRITING, batch.identity)
        spare.give()
        try:
            # Threads finish in any order.
            write_waveforms(setup.waveforms / batch.file, sorted(kept, key=lambda entry: entry[0]))
        except OSError as error:
            problem = f"waveforms cannot be written: {error.strerror or error}"
            if error.errno in _HARMED:
                _retire(line, Report(batch.identity, hurt=problem))
            send(line, Report(batch.identity, broken=problem))
            return
        spare.take()
    block = block_of(runs, wall, setup.metrics, setup.requirements) if runs else None
    report = Report(batch.identity, block, ended=True, kept=tuple(sorted(n for n, _ in kept)), retired=are_spent(seats))
    if report.retired:
        _retire(line, report)
    send(line, report)


def _retire(line: socket.socket, report: Report) -> NoReturn:
    send(line, report)
    # At once: an FMU that must not be called any more could be, by what its library does at the end of a process.
    os._exit(0)


def _let_go_of_the_tracker() -> None:
    # A helper process of multiprocessing, of no use here: whatever an FMU wrote to it would appear on the terminal.
    if sys.platform != "win32":
        tracker = resource_tracker.getfd()
        nowhere = os.open(os.devnull, os.O_WRONLY)
        if tracker is not None:
            os.dup2(nowhere, tracker)
        os.close(nowhere)


def _leave_with_parent() -> None:
    # A simulation that hangs never comes back to the line to learn that nobody listens any more.
    parent = parent_process()
    if parent is not None:
        before = os.getppid()
        parent.join()
        os._exit(1 if os.getppid() != before or sys.platform == "win32" else LINE_CLOSED)


def _print_to(log: Path) -> None:
    # Also for C code: what an FMU prints must neither garble a progress bar nor the output a program reads.
    # Appending lets the supervisor cut the file while it is in use.
    handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    for standard in (1, 2):
        os.dup2(handle, standard)
    os.close(handle)
    sys.stdout = open(1, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good
    sys.stderr = open(2, "w", encoding="utf-8", errors="replace", buffering=1, closefd=False)  # noqa: SIM115  # for good
