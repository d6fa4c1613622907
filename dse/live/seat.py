"""A session of a driver among others: the world keeps time, and tells where the others are."""

from __future__ import annotations

import math
import multiprocessing.process
import socket
import time
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from multiprocessing.connection import wait
from pathlib import Path

import numpy as np

from dse.domain.drive import Pace
from dse.domain.run import Run
from dse.live.driver_in_the_loop import DriverInTheLoop
from dse.live.others import State, Users
from dse.live.packet import Flag, Packet
from dse.live.session import OWN_VALUES, TURN, Ended, Patience, Seen, Session, Why
from dse.live.shared_world import Place, SharedWorld
from dse.testbench import PreparedBench

MOTION = ("x", "y", "heading", "speed", "lateral_speed", "acceleration")
"""What others see of a car, by the ports of its ``motion``."""


@dataclass(frozen=True, slots=True)
class Script:
    """What a simulated driver does: from each of *times* (s of its run, ascending) on, the *values* by control, SI."""

    times: tuple[float, ...]
    values: tuple[Mapping[str, float], ...]

    def at(self, time: float) -> Mapping[str, float]:
        """What is done at *time*, rounded to a microsecond."""
        number = bisect_right(self.times, time + 1e-6)
        return self.values[number - 1] if number else {}


@dataclass(frozen=True, slots=True)
class Sights:
    """Where, among the signals that a seat sees, its car's motion is, and its station and offset in its lane: -1 for
    what nothing tells."""

    motion: tuple[int, ...]
    station: int
    offset: int

    @classmethod
    def of(cls, seen: Sequence[str], car: str, road: str) -> Sights:
        """Of the signals *seen*, in their order, where *car* has a motion and *road* knows the lane."""
        places = {name: place for place, name in enumerate(seen)}
        motion = tuple(places.get(f"{car}.motion.{axis}", -1) for axis in MOTION)
        station, offset = (places.get(f"{road}.lane.{name}", -1) for name in ("station", "offset"))
        return cls(motion, station, offset)


class PlacedSession(Session, ABC):
    """A `Session` at *place* of *world*, which keeps its time."""

    def __init__(
        self,
        prepared: PreparedBench,
        driver_in_loop: DriverInTheLoop,
        first: Mapping[str, float],
        patience: Patience | None = None,
        *,
        world: SharedWorld,
        place: Place,
    ) -> None:
        self.world, self.place = world, place
        self.values = OWN_VALUES + len(driver_in_loop.seen)
        self._sent = Packet(0, 0, Flag(0), 0.0, ())
        super().__init__(prepared, driver_in_loop, first, patience)

    @abstractmethod
    def state_of(self, packet: Packet) -> State | Users:
        """What others see of it, from the values of its run."""

    def look(self, packet: Packet, lateness: float, overruns: int) -> None:
        """See what the run shows."""

    def answer(self, packet: Packet, others: Mapping[str, float]) -> Packet:
        """What it puts out next, among *others* by its outputs."""
        self._sent = self._reply(packet, self._sent, others)
        return self._sent

    def _attend(self, line: socket.socket, process: multiprocessing.process.BaseProcess) -> tuple[Why, str] | None:
        began = time.monotonic()
        with self.world.seated(self.place, self, line):
            while process.sentinel not in wait([process.sentinel], TURN):
                if cut := self._overdue(began, self.place.heard):
                    return cut
        return None


class SeatSession(PlacedSession):
    """A `PlacedSession` of a car; a *script* drives in place of a person."""

    def __init__(
        self,
        prepared: PreparedBench,
        driver_in_loop: DriverInTheLoop,
        first: Mapping[str, float],
        patience: Patience | None = None,
        *,
        world: SharedWorld,
        place: Place,
        sights: Sights,
        script: Script | None = None,
    ) -> None:
        self._sights, self._script = sights, script
        self._done: Mapping[str, float] = {}
        super().__init__(prepared, driver_in_loop, first, patience, world=world, place=place)

    def state_of(self, packet: Packet) -> State:
        """How the car moves, as its run tells."""
        values = packet.values[OWN_VALUES:]
        x, y, heading, speed, lateral, acceleration = (
            values[place] if place >= 0 else 0.0 for place in self._sights.motion
        )
        station, offset = self._sights.station, self._sights.offset
        along, aside = (values[station] if station >= 0 else math.nan), (values[offset] if offset >= 0 else 0.0)
        return State(x, y, heading, speed, lateral, acceleration, along, aside)

    def answer(self, packet: Packet, others: Mapping[str, float]) -> Packet:
        """What it puts out next, among *others* by its outputs."""
        if self._script is not None and (due := self._script.at(packet.time)) is not self._done:
            self._done, others = due, {**others, **due}
        return super().answer(packet, others)

    def look(self, packet: Packet, lateness: float, overruns: int) -> None:
        """See what the run shows."""
        self._look(packet)
        seen = self._seen
        assert seen is not None  # noqa: S101  # just looked
        self._seen = Seen(seen.time, lateness, overruns, seen.echo, seen.values)

    def _made(self, folder: Path) -> Ended:
        self.world.await_traffic()
        return super()._made(folder)

    def _pace(self, run: Run) -> Pace:  # noqa: ARG002  # the world has kept time, not the run
        late = np.array(self.place.late or [0.0])
        return Pace(len(self.place.late), self.place.overruns, float(np.median(late)), float(np.quantile(late, 0.99)))
