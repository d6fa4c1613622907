"""The worker process: takes batches from its channel, simulates, sends arrays of results back.

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
from dse.exploration.supervision.channel import receive, send
from dse.exploration.supervision.guarded_runner import GuardedRunner
from dse.exploration.supervision.heartbeat import Heartbeat, Phase
from dse.exploration.supervision.messages import Report, Setup
from dse.exploration.supervision.open_files import OUT_OF_FILES, SpareFiles
from dse.exploration.supervision.worker_threads import are_spent, simulate
from dse.exploration.work import Batch
from dse.storage import RowBlock, block_of, write_waveforms

_SEND_EVERY = 0.1
_TURN = 1e-4

CHANNEL_CLOSED = 117
"""Exit code of a worker whose channel was closed behind its back."""

_HARMED = OUT_OF_FILES | {errno.EFBIG}
"""What another process would not be told when it writes a file: a run has used up or changed the limits of this one."""


def serve(channel: socket.socket, setup: Setup, heartbeat: Path, log: Path) -> None:
    """Serve batches until None comes or the supervisor is gone. What simulations print goes to *log*."""
    # Ctrl-C reaches the whole terminal group; it is the supervisor that decides what to do about it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    _print_to(log)
    if setup.sandbox is not None:
        setup.sandbox.move_in()
    _let_go_of_the_tracker()
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
                _retire(channel, Report(batch.identity, retired=True))
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
    runners[0].load(batch)
    left = runners[0].runs_left
    return left is not None and left < len(batch.requests)


def _carry_out(
    batch: Batch,
    runners: Sequence[GuardedRunner],
    channel: socket.socket,
    setup: Setup,
    heart: Heartbeat,
    spare: SpareFiles,
) -> None:
    is_fresh = not any(runner.runs for runner in runners)
    finished: list[tuple[Run, float]] = []
    kept: list[tuple[int, Waveforms]] = []
    done = 0
    sent = time.perf_counter()
    for run, seconds in simulate(batch, runners):
        finished.append((run, seconds))
        done += 1
        if batch.keep and run.waveforms is not None:
            kept.append((run.request.number, run.waveforms))
        if time.perf_counter() - sent > _SEND_EVERY:
            send(channel, Report(batch.identity, _block(finished, setup)))
            finished, sent = [], time.perf_counter()
    hurt = next((runner.hurt for runner in runners if runner.hurt), "")
    if done < len(batch.requests) and batch.keep and is_fresh and any(runner.has_many_open for runner in runners):
        # No other process would come to the end of it either.
        hurt = hurt or "too many open files"
    block = _block(finished, setup) if finished else None
    if done < len(batch.requests) or hurt:
        _retire(channel, Report(batch.identity, block, retired=not hurt, hurt=hurt))
    # Threads finish in any order.
    kept.sort(key=lambda entry: entry[0])
    if kept:
        heart.beat(Phase.WRITING, batch.identity)
        spare.give()
        try:
            write_waveforms(setup.waveforms / batch.file, kept)
        except OSError as error:
            problem = f"waveforms cannot be written: {error.strerror or error}"
            if error.errno in _HARMED:
                _retire(channel, Report(batch.identity, hurt=problem))
            send(channel, Report(batch.identity, broken=problem))
            return
        spare.take()
    retired = are_spent(runners)
    report = Report(batch.identity, block, ended=True, kept=tuple(number for number, _ in kept), retired=retired)
    if retired:
        _retire(channel, report)
    send(channel, report)


def _block(finished: Sequence[tuple[Run, float]], setup: Setup) -> RowBlock:
    return block_of([run for run, _ in finished], setup.measures, [seconds for _, seconds in finished])


def _retire(channel: socket.socket, report: Report) -> NoReturn:
    send(channel, report)
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
