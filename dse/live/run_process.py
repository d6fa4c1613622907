"""The process of a run that somebody outside talks with: one run, within limits, and what came of it in a file."""

from __future__ import annotations

import mmap
import os
import pickle
import signal
import socket
import sys
import threading
from dataclasses import dataclass
from multiprocessing import parent_process
from pathlib import Path

from dse.domain.bench import Judgement, Verdict
from dse.domain.run import Outcome, Run, RunRequest, Waveforms
from dse.errors import DseError
from dse.plain_messages import packed, unpacked
from dse.processes import forget_start
from dse.testbench import PreparedBench, make_runner

PREPARED, PROGRESS, RESULT, LOG = "prepared", "progress", "result", "log"
PROGRESS_BYTES = 64
_SOCKET = "DSE_LIVE_SOCKET"
_LEAST_ROOM = 1 << 30


@dataclass(frozen=True, slots=True)
class Bounds:
    """What a process may take: *processor* s, *memory* bytes of addresses; it is as *nice* as that to others."""

    processor: float
    memory: float
    nice: int = 2


def make_run(end: socket.socket, folder: Path, bounds: Bounds) -> None:
    """Simulate what is prepared in *folder*, whose live component talks through *end*; there it leaves what it gave."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the whole group; who started this ends it
    _print_to(folder / LOG)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    forget_start()
    prepared: PreparedBench = pickle.loads((folder / PREPARED).read_bytes())  # noqa: S301  # who started this wrote it
    _limit(bounds)
    os.environ[_SOCKET] = str(end.fileno())
    with (folder / PROGRESS).open("r+b") as stream:
        progress = memoryview(mmap.mmap(stream.fileno(), PROGRESS_BYTES))
    try:
        run = make_runner(prepared, progress).run(RunRequest(0, prepared.configuration.id, {}), keep=True)
    except DseError as error:
        run = Run(RunRequest(0, prepared.configuration.id, {}), Outcome.FAILED, problem=str(error))
    told = (run.outcome, run.metrics, [(j.requirement, j.verdict, j.margin) for j in run.judgements], run.problem)
    waveforms = (run.waveforms.time, run.waveforms.values) if run.waveforms else None
    aside = folder / f"{RESULT}.new"
    aside.write_bytes(packed((*told, waveforms)))
    aside.rename(folder / RESULT)
    os._exit(0)  # what an FMU's library does at the end of a process is none of a drive


def read_run(folder: Path, configuration: str) -> Run | None:
    """What `make_run` has left in *folder*; None if it did not come to that. Nothing in it can call anything."""
    try:
        outcome, metrics, judged, problem, waveforms = unpacked((folder / RESULT).read_bytes())
        judgements = tuple(Judgement(str(name), Verdict(verdict), float(margin)) for name, verdict, margin in judged)
        kept = None if waveforms is None else Waveforms(waveforms[0], waveforms[1])
        return Run(RunRequest(0, configuration, {}), Outcome(outcome), metrics, judgements, str(problem), kept)
    except (OSError, ValueError, TypeError):
        return None


def _limit(bounds: Bounds) -> None:
    if sys.platform == "win32":
        return
    import resource

    os.nice(bounds.nice)
    seconds, memory = int(bounds.processor) + 1, int(max(bounds.memory, _LEAST_ROOM))
    # A second more before it is killed: it is told apart what ended it.
    wanted = {resource.RLIMIT_CPU: (seconds, seconds + 1), resource.RLIMIT_AS: (memory, memory)}
    for what, (soft, hard) in {**wanted, resource.RLIMIT_CORE: (0, 0)}.items():
        _, most = resource.getrlimit(what)
        allowed = hard if most == resource.RLIM_INFINITY else min(hard, most)
        resource.setrlimit(what, (min(soft, allowed), allowed))


def _leave_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _print_to(log: Path) -> None:
    # Also for C code: what an FMU prints is read if it dies of it.
    handle = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    for standard in (1, 2):
        os.dup2(handle, standard)
    os.close(handle)
