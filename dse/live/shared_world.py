"""One world with several cars, each simulated by a process of its own: the clock that all follow, and who sees whom.

Each step of each car asks for its next values and waits. The world answers all at once when the step is over by the
clock, with the cars of the others as they were one step before, moved on by their speed. It waits for a car that is
late, but not long (*grace*): then the others go on, and see that car stopped. So no car holds up the others, and on a
machine that keeps up, every car sees the others one step after they act, whatever the scheduler does.
"""

from __future__ import annotations

import math
import selectors
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import cache
from typing import Protocol

import numpy as np

from dse.errors import fail
from dse.live.others import Car, State, Users, host_of, mover_of, nearest
from dse.live.packet import Flag, Packet, PacketError, pack, unpack

MOST_SEATS = 64
_GIVEN_UP = 0.1
"""Seconds: a longer delay is not caught up."""
_SLEPT, _LOOK = 0.001, 0.02
_LARGEST = 1 << 17
_MOST_AT_ONCE = 64
_SPACING, _CLEAR, _MOST_PLACES = 20.0, 60.0, 100
_JOINING = 4
"""Steps after which the traffic has made room for a car that joins."""


class Seat(Protocol):
    """Who sits in a car: what the world asks of it, always from the thread of the world."""

    values: int
    """Numbers in a packet of its run."""

    def state_of(self, packet: Packet) -> State | Users:
        """How the car moves, as its run tells; of the traffic, its road users."""

    def answer(self, packet: Packet, others: Mapping[str, float]) -> Packet:
        """What it puts out next, among *others* by its outputs."""

    def look(self, packet: Packet, lateness: float, overruns: int) -> None:
        """See what the run shows."""


@dataclass(slots=True, eq=False)
class Place:
    """A car in a world under its *number*. *start* is its station at the start, *shown* are the numbers of the cars
    that it sees, 0 where it sees none, and *late* by how many s each step ended too late. One that *has_clock* is told
    how far the world's time is ahead of the *time* of its run."""

    number: int
    car: Car
    start: float
    fields: tuple[str, ...]
    shown: list[int]
    seat: Seat | None = None
    line: socket.socket | None = None
    state: State | None = None
    request: Packet | None = None
    heard: float = 0.0
    was_answered: bool = False
    is_lost: bool = False
    is_overdue: bool = False
    overruns: int = 0
    late: list[float] = field(default_factory=list)
    opening: Mapping[str, float] | None = None
    time: float = 0.0
    has_clock: bool = False

    @property
    def station(self) -> float:
        """Where it is along its lane."""
        known = self.state.station if self.state else math.nan
        return self.start if math.isnan(known) else known


class SharedWorld:
    """The clock of all cars in it, with *step* s; *most* cars at once; a late one is waited for *grace* s.

    Its traffic is a run of its own, which begins with the first car and ends with the last one. All may be called from
    any thread.
    """

    def __init__(self, step: float, *, most: int = 16, grace: float = 0.05) -> None:
        self.step, self.most, self.grace = step, min(most, MOST_SEATS), grace
        self._places: dict[int, Place] = {}
        self._numbers = self._steps = 0
        self._zero = math.nan
        self._traffic: Place | None = None
        self._users: Users | None = None
        self._open: Callable[[Place], Callable[[], None]] | None = None
        self._end: Callable[[], None] = _nothing
        self.problem = ""
        """Why its traffic has ended."""
        self._lock = threading.RLock()
        self._closed = False
        self._near, self._far = socket.socketpair()
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._near, selectors.EVENT_READ, None)
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()

    @property
    def time(self) -> float:
        """Seconds for which somebody has driven."""
        return self._steps * self.step

    @property
    def places(self) -> tuple[Place, ...]:
        """The cars in it, by number."""
        with self._lock:
            return tuple(self._places.values())

    def admit(self, car: Car, start: float, fields: tuple[str, ...], seen: int) -> Place:
        """A place for *car*, at the first free station from *start* on. It sees *seen* others, of each these *fields*.

        Raises DseError if there is none.
        """
        with self._lock:
            if len(self._places) >= self.most:
                raise fail(f"all {self.most} seats of this world are taken", hint="wait until one is free, or watch")
            taken = [each.station for each in self._places.values()]
            stations = (start + _SPACING * number for number in range(_MOST_PLACES))
            free = next((s for s in stations if all(abs(s - other) >= _CLEAR for other in taken)), None)
            if free is None:
                raise fail("there is no free place on the road to start from", hint="wait until the others drive on")
            self._numbers += 1
            place = self._places[self._numbers] = Place(self._numbers, car, free, fields, [0] * seen)
            return place

    def have_traffic(self, hosts: int, fields: tuple[str, ...], begin: Callable[[Place], Callable[[], None]]) -> None:
        """From the first car on there is traffic, which sees *hosts* cars, of each these *fields*. *begin* begins its
        run, and gives what ends it."""
        with self._lock:
            self.most = min(self.most, hosts)

            def opened(place: Place) -> Callable[[], None]:
                place.shown, place.fields, place.has_clock = [0] * hosts, fields, True
                return begin(place)

            self._open = self._open or opened

    @property
    def has_traffic(self) -> bool:
        """Whether it has been told of traffic."""
        return self._open is not None

    @contextmanager
    def seated(self, place: Place, seat: Seat, line: socket.socket) -> Iterator[None]:
        """Within the block, the run at the other end of *line* is answered by *seat*."""
        with self._lock:
            place.seat, place.line = seat, line
            self._selector.register(line, selectors.EVENT_READ, place)
            if place.number:
                self._begin_traffic()
            self._wake()
        try:
            yield
        finally:
            with self._lock:
                self._selector.unregister(line)
                self.leave(place)
                is_last = not any(each.line for each in self._places.values())
            if place.number and is_last:
                self._end_traffic()

    def await_traffic(self) -> None:
        """Wait until the traffic, if there is any, is ready for the first step, or has ended."""
        with self._lock:
            self._begin_traffic()
            place = self._traffic
        while place and place is self._traffic and not (place.request or place.was_answered):
            time.sleep(_LOOK)

    def _begin_traffic(self) -> None:
        if self._open and self._traffic is None and not self._closed:
            self._traffic = Place(0, Car(), 0.0, (), [])
            self._end = self._open(self._traffic)

    def _end_traffic(self) -> None:
        with self._lock:
            end, self._end = self._end, _nothing
        end()

    def leave(self, place: Place) -> None:
        """Take the car, or the traffic, out of the world."""
        with self._lock:
            if place is self._traffic:
                self._traffic = self._users = None
            if self._places.pop(place.number, None) or not place.number:
                place.line = None
                self._wake()

    def close(self) -> None:
        """Stop the clock."""
        self._end_traffic()
        with self._lock:
            self._closed = True
            self._wake()
        self._thread.join()
        self._selector.close()
        self._near.close()
        self._far.close()

    def _all(self) -> list[Place]:
        return [*self._places.values(), *([self._traffic] if self._traffic else [])]

    def _wake(self) -> None:
        with suppress(OSError):
            self._far.send(b".")

    def _run(self) -> None:
        while not self._closed:
            ready = self._selector.select(self._pause())
            with self._lock:
                if self._closed:
                    return
                for key, _ in ready:
                    if key.data is None:
                        self._near.recv(4096)
                    elif key.data.line is not None:
                        self._hear(key.data)
                if time.monotonic() >= self._until():
                    self._advance()

    def _pause(self) -> float | None:
        """Seconds to wait for packets. The last of them are slept here, as a selector counts whole milliseconds."""
        left = self._until() - time.monotonic()
        if left > 2 * _SLEPT:
            return None if math.isinf(left) else left - _SLEPT
        time.sleep(max(left, 0.0))
        return 0.0

    def _until(self) -> float:
        """When the present step is over at the latest, as known now."""
        with self._lock:
            if not any(place.request or place.was_answered for place in self._places.values()):
                self._zero = math.nan
                return math.inf
            if math.isnan(self._zero):
                self._zero = time.monotonic() - self.time
            deadline = self._zero + self.time + self.step
            is_waiting = any(p.was_answered and not p.request and not p.is_lost for p in self._all())
            return deadline + (self.grace if is_waiting else 0.0)

    def _hear(self, place: Place) -> None:
        """Take what a run has sent. Nothing that it sends can be more than dropped."""
        line, seat = place.line, place.seat
        for _ in range(_MOST_AT_ONCE):
            try:
                data = line.recv(_LARGEST) if line else b""
            except OSError:
                return
            try:
                packet = unpack(data, seat.values if seat else 0)
            except PacketError:
                continue
            if seat is None or packet.flags & Flag.END:
                continue  # of a start that is made again, or of the run: then its process ends
            now = place.heard = time.monotonic()
            found, place.time = seat.state_of(packet), packet.time
            if isinstance(found, Users):
                self._users = found
            else:
                place.state = found
            if packet.flags & Flag.START:
                # A start may be made several times, and has to get the same each time.
                place.opening = place.opening or self._others(place)
                self._send(place, seat.answer(packet, place.opening))
                continue
            place.is_overdue = place.was_answered and now > self._zero + self.time + self.step + _SLEPT
            place.request, place.is_lost = packet, False

    def _advance(self) -> None:
        """A step of all that have asked for it; the others are late."""
        late = time.monotonic() - (self._zero + self.time + self.step)
        asking = [place for place in self._all() if place.request]
        for place in self._all():
            place.is_lost = place.was_answered and not place.request
        told = [(place, self._others(place)) for place in asking]
        for place, others in told:
            packet, seat = place.request, place.seat
            if packet is None or seat is None:
                continue
            place.overruns += place.is_overdue
            if place.number:
                place.late.append(late)
            seat.look(packet, late, place.overruns)
            self._send(place, seat.answer(packet, others))
            place.request, place.was_answered = None, True
        self._steps += 1
        if late > _GIVEN_UP:
            self._zero += late

    def _others(self, place: Place) -> dict[str, float]:
        """What the run in *place* is told of the others, in as many places as it has for them."""
        self._choose(place)
        values: dict[str, float] = {"clock": round(self.time - (place.time or 0.0), 9)} if place.has_clock else {}
        for slot, number in enumerate(place.shown, 1):
            told = self._seen(place, number)
            values |= {label: told.get(name, 0.0) for name, label in _labels(place.fields, slot)}
        return values

    def _seen(self, place: Place, number: int) -> dict[str, float]:
        """What *place* is told of that *number*, a step ahead of what is known of it."""
        other = self._places.get(number)
        if other and other.state:
            # One whose simulation does not answer stops for the others.
            state = other.state.stopped() if other.is_lost else other.state
            ahead = self.step if other.was_answered else 0.0
            is_traffic = place is self._traffic
            return host_of(other.car, state, ahead) if is_traffic else mover_of(number, other.car, state, ahead)
        if self._users is None or self._traffic is None:
            return {}
        moves = self._traffic.was_answered and not self._traffic.is_lost
        return self._users.mover(number, self.step if moves else 0.0)

    def _choose(self, place: Place) -> None:
        """Have *place* see the nearest ones. A car keeps its slot; a slot is empty before another car takes it."""
        here = place.state
        known = {n: other.state for n, other in self._places.items() if other is not place and other.state}
        wanted = [*known]
        users = None if place is self._traffic else self._users
        if users:
            hidden = users.near(place.station, _CLEAR) if len(place.late) < _JOINING else set()
            wanted += [number for number in users.numbers if number not in hidden]
        most = len(place.shown)
        if here and len(wanted) > most:
            x, y = (np.array([getattr(each, axis) for each in known.values()]) for axis in "xy")
            if users:
                is_seen = [number not in hidden for number in users.numbers]
                x, y = np.concatenate([x, users.x[is_seen]]), np.concatenate([y, users.y[is_seen]])
            wanted = nearest(here, wanted, x, y, place.shown, most)
        free = [slot for slot, number in enumerate(place.shown) if not number]
        new = iter([number for number in wanted if number not in place.shown])
        place.shown = [number if number in wanted else 0 for number in place.shown]
        for slot in free:
            place.shown[slot] = next(new, 0)

    def _send(self, place: Place, packet: Packet) -> None:
        with suppress(OSError):  # nobody takes it: its process ends
            if place.line:
                place.line.send(pack(packet))


@cache
def _labels(fields: tuple[str, ...], slot: int) -> tuple[tuple[str, str], ...]:
    return tuple((name, f"other{slot}.{name}") for name in fields)


def _nothing() -> None:
    """What ends a traffic that there is not."""
