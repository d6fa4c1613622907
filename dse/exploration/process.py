"""A worker process as its supervisor holds it."""

from __future__ import annotations

import contextlib
import multiprocessing
import sys
import time
from collections import deque
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from pathlib import Path
from types import ModuleType

from dse.exploration.heartbeat import Heartbeat, State
from dse.exploration.job import Batch, Report, Setup
from dse.exploration.worker import work

_TAIL = 2000
_PATIENCE = 5.0


@dataclass(slots=True)
class Assignment:
    """A batch a worker has been given, and the runs of it that have come back."""

    batch: Batch
    received: set[int] = field(default_factory=set)

    def rest(self) -> Batch:
        """What is to be done again if the worker dies: with waveforms all of it, as they were still in the worker."""
        return self.batch if self.batch.keep else self.batch.without(self.received)


class WorkerProcess:
    """One worker: its process, its pipe, its heartbeat, and the batches it has, the one at hand first."""

    def __init__(self, setup: Setup, folder: Path, index: int) -> None:
        heartbeat, self._log = folder / f"worker{index}.beat", folder / f"worker{index}.log"
        Heartbeat.lay_out(heartbeat)
        self._log.touch()
        self._heart = Heartbeat(heartbeat)
        self._beats, self._since = 0, time.monotonic()
        context = multiprocessing.get_context("spawn")
        self.connection: Connection[Batch | None, Report]
        self.connection, far = context.Pipe()
        self._process = context.Process(target=work, args=(far, setup, heartbeat, self._log), daemon=True)
        _start(self._process)
        far.close()
        self.assignments: deque[Assignment] = deque()

    @property
    def sentinel(self) -> int:
        """Ready when the process has ended."""
        return self._process.sentinel

    def give(self, batch: Batch) -> bool:
        """Hand over *batch*; False if the worker is no longer there to take it."""
        if not self.assignments:
            self._since = time.monotonic()
        self.assignments.append(Assignment(batch))
        try:
            self.connection.send(batch)
        except OSError:
            return False
        return True

    def state(self) -> State:
        """What the worker does now, or did when it died."""
        return self._heart.state()

    def progress(self) -> bytes:
        """The simulation's progress block."""
        return self._heart.progress()

    def silence(self) -> float:
        """Seconds since the worker told of something new or was given something to do."""
        beats, now = self.state().beats, time.monotonic()
        if beats != self._beats:
            self._beats, self._since = beats, now
        return now - self._since

    def last_words(self) -> str:
        """The end of what the process printed."""
        return self._log.read_text(encoding="utf-8", errors="replace")[-_TAIL:].strip()

    def dismiss(self) -> None:
        """Tell the worker to end."""
        with contextlib.suppress(OSError):
            self.connection.send(None)

    def kill(self) -> None:
        """End the process whatever it does."""
        self._process.kill()

    def bury(self) -> int:
        """Wait for the process to end, not for long, and free what belongs to it; its exit code, < 0 for a signal."""
        self._process.join(_PATIENCE)
        if self._process.exitcode is None:
            self.kill()
            self._process.join()
        code = self._process.exitcode or 0
        self._process.close()
        self.connection.close()
        self._heart.close()
        return code


def _start(process: SpawnProcess) -> None:
    """Start *process* without the parent's main module, which spawn would otherwise import again in the child.

    A console script would cost each worker the whole command line, and a script without a main guard would start
    an exploration of its own.
    """
    main = sys.modules["__main__"]
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        process.start()
    finally:
        sys.modules["__main__"] = main
