"""An experiment in a process of its own: one that crashes, hangs or eats memory is an outcome like any other."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import psutil

from dse.cosim.failure.run_failed import RunFailed
from dse.cosim.probing.journal import Journal
from dse.errors import DseError
from dse.plain_messages import packed, unpacked
from dse.processes import Family, forget_start, start_process
from dse.sandbox import Sandbox, protect_parent
from dse.scratch import ScratchFolder

_LOOK_EVERY = 0.02
_TO_START = 60.0
_SILENT = "no answer"


@dataclass(frozen=True, slots=True)
class ProbeLimits:
    """What an experiment may use: wall time in seconds, resident memory in bytes."""

    time: float = 30.0
    memory: float = 2e9


@dataclass(frozen=True, slots=True)
class ExperimentOutcome:
    """What came of an experiment: its *result*, or the *failure* that ended it, in words.

    *unclear* tells that it was not the FMU's doing, *hung* that it took too long; *count* is what the experiment had
    counted.
    """

    result: Any = None
    failure: str = ""
    unclear: bool = False
    hung: bool = False
    count: int = 0


Experiment = Callable[..., Any]
"""A function that can be imported by name; its first argument is the `Journal`."""


def attempt(
    experiment: Experiment, *arguments: object, limits: ProbeLimits, anew: bool = False, sandboxed: bool = False
) -> ExperimentOutcome:
    """Carry out ``experiment(journal, *arguments)`` in a process of its own; arguments are pickled, the result packed.

    Processes come from one that has done nothing but imports, where the system can do that. One started *anew* has
    another layout of memory besides.
    """
    with ScratchFolder() as folder:
        file = Path(folder) / "journal"
        Journal.lay_out(file)
        journal = Journal(file)
        # Of a process that is started by another one, nobody can say what it may do.
        context = _context(anew=anew or sandboxed)
        near, far = context.Pipe(duplex=False)
        sandbox = Sandbox((Path(folder) / "scratch",)) if sandboxed else None
        process = context.Process(target=_carry_out, args=(far, experiment, file, sandbox, arguments), daemon=True)
        if sandbox is None:
            start_process(process)
        else:
            sandbox.start(process, file)
        far.close()
        try:
            offence, report = _watch(near, process.pid or 0, limits, journal)
            if report is not None:
                return ExperimentOutcome(*report, count=journal.counted)
            if offence:
                process.kill()
            process.join()
            cause = offence or _cause(process.exitcode or 0)
            where = f" while {journal.doing}" if journal.doing else ""
            return ExperimentOutcome(failure=f"{cause}{where}", hung=offence.startswith(_SILENT), count=journal.counted)
        finally:
            process.kill()
            process.join()
            process.close()
            near.close()
            journal.close()


def _context(*, anew: bool) -> Any:  # the stubs have no word for both kinds
    if anew or sys.platform == "win32":
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["dse.cosim.probing.experiments", "dse.cosim.probing.stress"])
    return context


def _watch(
    connection: Connection, pid: int, limits: ProbeLimits, journal: Journal
) -> tuple[str, tuple[Any, str, bool] | None]:
    """Wait for the child's report; what it has to be killed for, if anything."""
    deadline = time.monotonic() + _TO_START + limits.time
    under_way = False
    try:
        family = Family(pid)
    except psutil.Error:
        family = None
    while True:
        try:
            if connection.poll(_LOOK_EVERY):
                result, failure, unclear = unpacked(connection.recv_bytes())
                return "", (result, str(failure), bool(unclear))
        except (EOFError, OSError, TypeError, ValueError):
            return "", None
        if not under_way and journal.doing:
            under_way, deadline = True, time.monotonic() + limits.time
        if time.monotonic() > deadline:
            return f"{_SILENT} for {limits.time:g} s", None
        with contextlib.suppress(psutil.Error):
            if family is not None and family.resident() > limits.memory:
                return f"grew beyond {limits.memory / 1e9:.3g} GB of memory", None


def _carry_out(
    connection: Connection, experiment: Experiment, file: Path, sandbox: Sandbox | None, arguments: tuple[object, ...]
) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # whoever watches it decides
    forget_start()
    protect_parent()
    if sandbox is not None:
        sandbox.move_in()
    # What an FMU prints must not garble what the probe prints.
    nowhere = os.open(os.devnull, os.O_RDWR)
    for standard in (0, 1, 2):
        os.dup2(nowhere, standard)
    sys.stdout = sys.stderr = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115  # for good
    try:
        report: tuple[Any, str, bool] = experiment(Journal(file), *arguments), "", False
    except (RunFailed, DseError) as error:
        report = None, str(error), False
    except MemoryError:
        report = None, "ran out of memory", False
    except Exception as error:  # noqa: BLE001  # whatever it is, it is the outcome of this experiment and no other's
        report = None, f"the experiment went wrong: {type(error).__name__}: {error}", True
    connection.send_bytes(packed(report))
    # What the library does at the end of a process is no part of the experiment.
    os._exit(0)


def _cause(code: int) -> str:
    if code < 0:
        return f"crashed (signal {-code})"
    return f"crashed (exit code {code:#x})" if code > 255 else f"ended the process (exit code {code})"
