"""A worker process as its supervisor holds it."""

from __future__ import annotations

import multiprocessing
import os
import socket
import time
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from dse.exploration.supervision.channel import Channel
from dse.exploration.supervision.heartbeat import Heartbeat, Phase, State
from dse.exploration.supervision.messages import FROM_WORKERS, Report, Setup
from dse.exploration.supervision.worker import serve
from dse.exploration.work import Batch
from dse.processes import start_process

_TAIL = 2000
_LARGEST_LOG = 4_000_000
_PATIENCE = 5.0
_TURN = 1e-3


@dataclass(slots=True)
class Assignment:
    """A batch a worker has been given, and the runs of it that have come back, of which some *failed*."""

    batch: Batch
    received: set[int] = field(default_factory=set)
    failed: set[int] = field(default_factory=set)

    def rest(self) -> Batch:
        """What is to be done again if the worker dies: with waveforms all of it, as they were still in the worker."""
        return self.batch.without(self.failed if self.batch.keep else self.received)


class WorkerProcess:
    """One worker: its process, its channel, its heartbeats, and the batches it has, the one at hand first.

    *useful* tells that it has finished a run, *retired* that it has taken its leave. *offence* says why it has to
    die for what one of its runs did, nobody knows which; *worn* that it may be what several did together.
    """

    def __init__(self, setup: Setup, folder: Path, index: int) -> None:
        heartbeat, self._log = folder / f"worker{index}.beat", folder / f"worker{index}.log"
        Heartbeat.lay_out(heartbeat, setup.threads)
        self._log.touch()
        self._hearts = [Heartbeat(heartbeat, thread) for thread in range(setup.threads)]
        self._beats, self._since = [0] * setup.threads, [time.monotonic()] * setup.threads
        context = multiprocessing.get_context("spawn")
        near, far = socket.socketpair()
        self._channel = Channel(near, *FROM_WORKERS)
        self._process = context.Process(target=serve, args=(far, setup, heartbeat, self._log), daemon=True)
        if setup.sandbox is None:
            start_process(self._process)
        else:
            setup.sandbox.start(self._process, heartbeat, self._log)
        far.close()
        self._memory = psutil.Process(self._process.pid)
        self.assignments: deque[Assignment] = deque()
        self.useful = self.retired = self.worn = False
        self.offence = ""

    @property
    def sentinel(self) -> int:
        """Ready when the process has ended, or has written where it must not."""
        return self._process.sentinel

    @property
    def channel(self) -> socket.socket:
        """Ready when the worker has sent something."""
        return self._channel.end

    @property
    def has_ended(self) -> bool:
        """Whether the process is no more."""
        return self._process.exitcode is not None

    def ends_within(self, patience: float) -> bool:
        """Whether the process ends in so many seconds."""
        # Not by what `sentinel` is: the worker can write into it, and `Process.join` would then wait for ever.
        until = time.monotonic() + patience
        while not self.has_ended and time.monotonic() < until:
            time.sleep(_TURN)
        return self.has_ended

    def give(self, batch: Batch) -> None:
        """Hand over *batch*. If the worker is no longer there to take it, `reports` tells."""
        if not self.assignments:
            self._since = [time.monotonic()] * len(self._hearts)
        self.assignments.append(Assignment(batch))
        self._channel.send(batch)

    def reports(self) -> Iterator[Report]:
        """What it has sent, one by one; also sends what it has not been sent yet. Never waits.

        Raises EOFError or OSError if the worker is dead, GarbledError where something else was sent.
        """
        self._channel.flush()
        return self._channel.arrived()

    def states(self) -> list[State]:
        """What each thread of the worker does now, or did when it died."""
        return [heart.state() for heart in self._hearts]

    def progress(self, thread: int) -> bytes:
        """The progress block of the simulation in a thread."""
        return self._hearts[thread].progress()

    def silence(self) -> dict[Phase, float]:
        """Longest time in seconds that a thread has been in a phase without telling of anything new.

        Waiting counts only if all do, from when the last began to or the worker was given something to do.
        """
        now = time.monotonic()
        longest: dict[Phase, float] = {}
        states = self.states()
        for thread, state in enumerate(states):
            if state.beats != self._beats[thread]:
                self._beats[thread], self._since[thread] = state.beats, now
            if state.phase is not Phase.WAITING:
                longest[state.phase] = max(longest.get(state.phase, 0.0), now - self._since[thread])
        return longest or {Phase.WAITING: now - max(self._since)}

    def resident(self) -> int:
        """Bytes of memory the process holds; 0 if it is no more."""
        try:
            return self._memory.memory_info().rss
        except psutil.Error:
            return 0

    def last_words(self, since: int = 0) -> str:
        """The end of what the process printed, after so many bytes."""
        with self._log.open("rb") as log:
            size = log.seek(0, os.SEEK_END)
            # A log that was cut in the meantime is new from its beginning on.
            log.seek(max(size - _TAIL, since if since <= size else 0))
            return log.read().decode("utf-8", errors="replace").strip()

    def shorten_log(self) -> None:
        """Forget what the process printed, if that is a lot."""
        if self._log.stat().st_size > _LARGEST_LOG:
            os.truncate(self._log, 0)

    def dismiss(self) -> None:
        """Tell the worker to end."""
        self._channel.send(None)

    def kill(self) -> None:
        """End the process whatever it does."""
        self._process.kill()

    def reap(self) -> int:
        """Wait for the process to end, not for long, and free what belongs to it; its exit code, < 0 for a signal."""
        if not self.ends_within(_PATIENCE):
            self.kill()
            self._process.join()
        code = self._process.exitcode or 0
        self._process.close()
        self._channel.close()
        for heart in self._hearts:
            heart.close()
        return code
