"""A worker process as its supervisor holds it."""

from __future__ import annotations

import multiprocessing
import os
import socket
import time
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from multiprocessing.process import BaseProcess
from pathlib import Path

import psutil

from dse.exploration.supervision.channel import Channel
from dse.exploration.supervision.heartbeat import Heartbeat, Phase, State
from dse.exploration.supervision.messages import FROM_WORKERS, Fault, Report, Setup
from dse.exploration.supervision.worker import serve_copied, serve_spawned
from dse.exploration.work import Batch
from dse.processes import Family, can_be_copied, open_files, start_copy, start_process
from dse.storage import made_by

_TAIL = 2000
_LARGEST_LOG = 4_000_000
_PATIENCE = 5.0
_TURN = 1e-3


@dataclass(slots=True)
class Assignment:
    """A batch a worker has been given, and the runs of it that have come back."""

    batch: Batch
    received: set[int] = field(default_factory=set)

    @property
    def missing(self) -> set[int]:
        """The runs that are to come back."""
        return {request.number for request in self.batch.todo} - self.received

    def rest(self) -> Batch:
        """What is to be done yet if the worker dies."""
        return self.batch.after(self.received)


class WorkerProcess:
    """One worker: its process, its channel, its heartbeats, and the batches it has, the one at hand first.

    *used* tells that it has been given work, the last of *configuration*, *useful* that it has finished a run,
    *retired* that it has taken its leave, after a *fault* if there was one. *offence* says why it was cut off.
    *stopped* is how many seconds it is stopped by now.

    Its time is the one it had: as long as it, or the supervisor with it, is stopped, it stands still.
    """

    def __init__(self, setup: Setup, folder: Path, index: int) -> None:
        heartbeat, self._log = folder / f"worker{index}.beat", folder / f"worker{index}.log"
        Heartbeat.lay_out(heartbeat, setup.threads)
        self._log.touch()
        self._hearts = [Heartbeat(heartbeat, thread) for thread in range(setup.threads)]
        self._ran = self.stopped = 0.0
        self._beats, self._since = [0] * setup.threads, [0.0] * setup.threads
        self._progress, self._moved = [b""] * setup.threads, 0.0
        near, far = socket.socketpair()
        self._channel = Channel(near, *FROM_WORKERS)
        self._process = _started(far, setup, heartbeat, self._log)
        far.close()
        self._seen = psutil.Process(self._process.pid)
        self._family = Family(self._seen.pid)
        self.maker = made_by(self._process.pid or 0)
        self.assignments: deque[Assignment] = deque()
        self.used = self.useful = self.retired = False
        self.fault: Fault | None = None
        self.offence = self.configuration = ""

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
            self._since = [self._ran] * len(self._hearts)
        self.used, self.configuration = True, batch.configuration
        self.assignments.append(Assignment(batch))
        self._channel.send(batch)

    def reports(self) -> Iterator[Report]:
        """What it has sent, one by one; also sends what it has not been sent yet. Never waits.

        Raises EOFError or OSError if the worker is dead, GarbledError where something else was sent.
        """
        if self.offence:
            return iter(())
        self._channel.flush()
        return self._channel.arrived()

    def cut_off(self, offence: str) -> None:
        """Listen no more: it ends by itself when it has something to say, and what it has made is in the spool."""
        self.offence = offence
        self._channel.close()

    def states(self) -> list[State]:
        """What each thread of the worker does now, or did when it died."""
        return [heart.state() for heart in self._hearts]

    def progress(self, thread: int) -> bytes:
        """The progress block of the simulation in a thread."""
        return self._hearts[thread].progress()

    def pass_time(self, seconds: float) -> None:
        """So many have passed since this was called last."""
        try:
            stands = self._seen.status() in (psutil.STATUS_STOPPED, psutil.STATUS_TRACING_STOP)
        except psutil.Error:
            stands = False
        self.stopped = self.stopped + seconds if stands else 0.0
        self._ran += 0.0 if stands else seconds
        progress = [heart.progress() for heart in self._hearts]
        if progress != self._progress:
            self._progress, self._moved = progress, self._ran

    @property
    def standstill(self) -> float:
        """Seconds since a simulation in it got on."""
        return self._ran - self._moved

    def silence(self) -> dict[Phase, float]:
        """Longest time in seconds that a thread has been in a phase without telling of anything new.

        Waiting counts only if all do, from when the last began to or the worker was given something to do.
        """
        now = self._ran
        longest: dict[Phase, float] = {}
        states = self.states()
        for thread, state in enumerate(states):
            if state.beats != self._beats[thread]:
                self._beats[thread], self._since[thread] = state.beats, now
            if state.phase is not Phase.WAITING:
                longest[state.phase] = max(longest.get(state.phase, 0.0), now - self._since[thread])
        return longest or {Phase.WAITING: now - max(self._since)}

    def resident(self) -> int:
        """Bytes of memory the process holds, and what it has started; 0 if it is no more."""
        try:
            return self._family.resident()
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

    def end(self) -> int:
        """Wait for the process to end, not for long; its exit code, < 0 for a signal."""
        if not self.ends_within(_PATIENCE):
            self.kill()
            self._process.join()
        return self._process.exitcode or 0

    def free(self) -> None:
        """Free what belongs to the process, which has ended."""
        self._process.close()
        self._channel.close()
        for heart in self._hearts:
            heart.close()

    def reap(self) -> None:
        """Both."""
        self.end()
        self.free()


def _started(channel: socket.socket, setup: Setup, heartbeat: Path, log: Path) -> BaseProcess:
    if setup.copied and setup.sandbox is None and can_be_copied():
        foreign = [number for number in open_files() if number != channel.fileno()]
        copy = multiprocessing.get_context("fork").Process(
            target=serve_copied, args=(channel, setup, heartbeat, log, foreign), daemon=True
        )
        start_copy(copy)
        return copy
    process = multiprocessing.get_context("spawn").Process(
        target=serve_spawned, args=(channel, setup, heartbeat, log), daemon=True
    )
    if setup.sandbox is None:
        start_process(process, log)
    else:
        setup.sandbox.start(process, heartbeat, log)
    return process
