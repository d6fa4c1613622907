"""A session: one run in real time in a process of its own, and the thread here that talks with it."""

from __future__ import annotations

import multiprocessing
import pickle
import signal
import socket
import threading
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from enum import StrEnum
from multiprocessing.connection import wait
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from dse.domain.drive import Pace
from dse.domain.run import Outcome, Run
from dse.live.driver_in_the_loop import LATENESS, OVERRUNS, DriverInTheLoop
from dse.live.packet import Flag, Packet, PacketError, pack, unpack
from dse.live.run_process import LOG, PREPARED, PROGRESS, PROGRESS_BYTES, Bounds, make_run, read_run
from dse.processes import start_process
from dse.scratch import ScratchFolder
from dse.testbench import PreparedBench

TURN = 0.25
"""Seconds between two looks for a run that does not go on."""
_MOST_ASKED = 100
_LARGEST = 1 << 17
_LAST_WORDS = 2000
OWN_VALUES = 3
"""Values ahead of the signals that a driver in the loop sees: echo, overruns, lateness."""


class Why(StrEnum):
    """Why a session has ended."""

    FINISHED = "finished"
    CRASHED = "crashed"
    LIMIT = "limit"


@dataclass(frozen=True, slots=True, eq=False)
class Seen:
    """What the run shows at *time* (s): the newest, as the driver in the loop sees it. *echo* is the number of the
    last command that
    the run has used, *lateness* by how many s the last step ended too late, *overruns* counts missed deadlines."""

    time: float
    lateness: float
    overruns: int
    echo: int
    values: NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Ended:
    """*text* tells *why* in words. A *run* that came to an end has results, also if it ended early."""

    why: Why
    text: str
    run: Run | None = None
    pace: Pace | None = None


@dataclass(frozen=True, slots=True)
class Patience:
    """Seconds: for the process to load the FMUs and begin (*start*), for a step that does not come to its end (*step*),
    and for the whole drive besides its own length (*slack*)."""

    start: float = 60.0
    step: float = 10.0
    slack: float = 60.0


class Session:
    """Makes the run of *prepared* and is who sits in its *driver_in_loop*, until `ended` says why it is over.

    *first* are what the driver in the loop puts out at first, by its ports. What is told from any thread is used from
    the next step on; nothing waits. No two sessions share anything.
    """

    def __init__(
        self,
        prepared: PreparedBench,
        driver_in_loop: DriverInTheLoop,
        first: Mapping[str, float],
        patience: Patience | None = None,
    ) -> None:
        self.driver_in_loop = driver_in_loop
        self._prepared = prepared
        self._patience = patience or Patience()
        self._values = {name: first.get(name, 0.0) for name in driver_in_loop.inputs}
        self._number = 0
        self._lock = threading.Lock()
        self._wants_end = threading.Event()
        self._over = threading.Event()
        self._seen: Seen | None = None
        self._ended: Ended | None = None
        self.delays: list[float] = []
        """Seconds from a command to the first that the run showed after it had used it."""
        self._asked: dict[int, float] = {}
        self._thread = threading.Thread(target=self._talk, daemon=True)
        self._thread.start()

    @property
    def newest(self) -> Seen | None:
        """The newest that the run has shown; None before its first step."""
        return self._seen

    @property
    def ended(self) -> Ended | None:
        """Why it is over; None as long as it is not."""
        return self._ended if self._over.is_set() else None

    def command(self, values: Mapping[str, float], number: int = 0) -> None:
        """Have the driver in the loop put out *values* by its ports, in SI, from the next step on; *number* is echoed
        then."""
        with self._lock:
            self._values.update(values)
            self._number = number or self._number + 1
            self._asked[self._number] = time.monotonic()
            while len(self._asked) > _MOST_ASKED:
                del self._asked[next(iter(self._asked))]

    def finish(self) -> None:
        """Ask the run to end here; it has results up to there."""
        self._wants_end.set()

    def wait(self, seconds: float | None = None) -> Ended | None:
        """Wait for the end."""
        self._over.wait(seconds)
        return self.ended

    def close(self) -> None:
        """End it, whatever it does, and wait until it is gone."""
        self._wants_end.set()
        self._patience = Patience(0.0, 0.0, -self._prepared.simulation.stop)
        self._thread.join()

    def _talk(self) -> None:
        try:
            with ScratchFolder() as scratch:
                self._ended = self._made(Path(scratch))
        except Exception as error:  # noqa: BLE001  # whoever waits must not wait for ever
            self._ended = Ended(Why.CRASHED, f"the drive could not be started: {error}")
        finally:
            self._over.set()

    def _made(self, folder: Path) -> Ended:
        (folder / PROGRESS).write_bytes(bytes(PROGRESS_BYTES))
        # Not as an argument: a child that dies of its imports would leave who writes a long one waiting for ever.
        (folder / PREPARED).write_bytes(pickle.dumps(self._prepared))
        (folder / LOG).touch()
        near, far = socket.socketpair(socket.AF_UNIX, socket.SOCK_DGRAM)
        stop = self._prepared.simulation.stop
        bounds = Bounds(2 * stop + self._patience.start, self._prepared.memory)
        context = multiprocessing.get_context("spawn")
        process = context.Process(target=make_run, args=(far, folder, bounds), daemon=True)
        with near, far:
            near.setblocking(False)
            start_process(process, folder / LOG)
            far.close()
            cut = self._attend(near, process)
        if cut:
            process.kill()
        process.join()
        ended = self._end(folder, process.exitcode or 0, cut)
        process.close()
        return ended

    def _attend(self, line: socket.socket, process: multiprocessing.process.BaseProcess) -> tuple[Why, str] | None:
        """Answer the run until its process ends; why it has to be ended if it does not by itself."""
        sent, began, heard = Packet(0, 0, Flag(0), 0.0, ()), time.monotonic(), 0.0
        while True:
            ready = wait([line, process.sentinel], TURN)
            for packet in _arrived(line, OWN_VALUES + len(self.driver_in_loop.seen)):
                if packet.flags & Flag.END:
                    continue  # of a start that is made again, or of the run: then its process ends
                heard = time.monotonic()
                sent = self._reply(packet, sent)
                with suppress(OSError):  # nobody takes it: the next will be newer
                    line.send(pack(sent))
                if not packet.flags & Flag.START:
                    self._look(packet)
            if process.sentinel in ready:
                return None
            if cut := self._overdue(began, heard):
                return cut

    def _overdue(self, began: float, heard: float) -> tuple[Why, str] | None:
        now, patience, stop = time.monotonic(), self._patience, self._prepared.simulation.stop
        if heard and now - began > patience.start + stop + patience.slack:
            return Why.LIMIT, f"the drive of {stop:g} s took more than {now - began:.0f} s"
        if heard and now - heard > patience.step + (patience.start if self._wants_end.is_set() else 0.0):
            return Why.CRASHED, f"no progress for {now - heard:.0f} s"
        if not heard and now - began > patience.start:
            return Why.CRASHED, f"it did not begin within {patience.start:g} s"
        return None

    def _reply(self, packet: Packet, before: Packet, also: Mapping[str, float] | None = None) -> Packet:
        with self._lock:
            self._values.update(also or {})
            values = (*self._values.values(), float(self._number))
        is_start = bool(packet.flags & Flag.START)
        flags = Flag.ANSWER | (Flag.START if is_start else Flag(0))
        if self._wants_end.is_set() and not is_start:
            flags |= Flag.END
        return Packet(packet.session, 0 if is_start else before.sequence + 1, flags, packet.time, values)

    def _look(self, packet: Packet) -> None:
        echo, overruns, lateness, *_ = packet.values
        self._seen = Seen(packet.time, lateness, int(overruns), int(echo), np.array(packet.values[OWN_VALUES:]))
        if self._asked:
            now = time.monotonic()
            with self._lock:
                if int(echo) in self._asked:
                    self.delays.append(now - self._asked[int(echo)])
                    while next(iter(self._asked)) != int(echo):
                        del self._asked[next(iter(self._asked))]
                    del self._asked[int(echo)]

    def _end(self, folder: Path, exit_code: int, cut: tuple[Why, str] | None) -> Ended:
        run = read_run(folder, self.driver_in_loop.configuration.id)
        if run is not None and run.outcome is Outcome.DONE:
            stop = self._prepared.simulation.stop
            at = run.waveforms.time[-1] if run.waveforms is not None and len(run.waveforms.time) else 0.0
            return Ended(Why.FINISHED, f"driven for {at:.4g} s of {stop:.4g} s", run, self._pace(run))
        if run is not None:
            return Ended(Why.CRASHED, run.problem, run)
        place = self._prepared.describe_progress((folder / PROGRESS).read_bytes())
        if cut:
            return Ended(cut[0], f"{place}: {cut[1]}")
        if exit_code == -getattr(signal, "SIGXCPU", 0):
            return Ended(Why.LIMIT, f"{place}: the drive has used up its processor time")
        words = (folder / LOG).read_text("utf-8", "replace")[-_LAST_WORDS:].strip().splitlines()[-1:]
        return Ended(Why.CRASHED, "; ".join([f"{place}: {_death(exit_code)}", *words]))

    def _pace(self, run: Run) -> Pace:
        waveforms = run.waveforms
        late = np.empty(0) if waveforms is None else waveforms.values[f"{self.driver_in_loop.part}.{LATENESS}"][1:]
        if waveforms is None or not len(late):
            return Pace(0, 0, 0.0, 0.0)
        overruns = waveforms.values[f"{self.driver_in_loop.part}.{OVERRUNS}"][-1]
        return Pace(len(late), int(overruns), float(np.median(late)), float(np.quantile(late, 0.99)))


def _arrived(line: socket.socket, count: int) -> list[Packet]:
    """The packets that are there; what is none of *count* values is no packet of ours."""
    found: list[Packet] = []
    while True:
        try:
            data = line.recv(_LARGEST)
        except OSError:
            return found
        with suppress(PacketError):
            found.append(unpack(data, count))


def _death(exit_code: int) -> str:
    if exit_code >= 0:
        return f"its process ended with {exit_code}"
    with suppress(ValueError):
        return f"its process ended by {signal.Signals(-exit_code).name}"
    return f"its process ended by signal {-exit_code}"
