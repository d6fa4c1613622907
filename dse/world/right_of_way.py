"""Who gives way where paths meet."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate

import numpy as np

from dse.world.conflict_areas import ConflictArea, find_conflict_areas
from dse.world.evaluation import lane_middle, place
from dse.world.opendrive.structure import Network
from dse.world.tables import Conflict, Leg, Light, RoadPath

_SAME = 0.1  # rad: who turns by that much more turns more
_BEHIND = 1.0  # m that a sign or light may stand behind the line where a junction begins
_GOES = {"green", "yellow"}


def conflicts(network: Network, paths: Sequence[RoadPath]) -> Iterator[Conflict]:
    """All conflicts between *paths*, each seen from both: those of the first path first, by their entries."""
    found = []
    for i, one in enumerate(paths):
        for j, other in enumerate(paths[:i]):
            for met in find_conflict_areas(one, other):
                turned = ConflictArea(met.other_entry, met.other_exit, met.entry, met.exit)
                first = _goes_first(network, _Approach(one, met), _Approach(other, turned))
                found.append(_conflict(i, j, met, first < 0))
                found.append(_conflict(j, i, turned, first > 0))
    yield from sorted(found, key=lambda each: (each.path, each.entry, each.other_path))


def _conflict(path: int, other: int, met: ConflictArea, gives_way: bool) -> Conflict:
    return Conflict(path, met.entry, met.exit, other, met.other_entry, met.other_exit, gives_way)


@dataclass(frozen=True)
class _Approach:
    """A path that comes to a meeting."""

    path: RoadPath
    met: ConflictArea

    @cached_property
    def leg(self) -> int:
        """The first leg in a junction that reaches into the meeting, else the one where it begins."""
        legs, length = self.path.legs, self.path.length
        first = max(bisect_right([leg.start for leg in legs], self.met.entry % length) - 1, 0)
        for i in range(first, len(legs)):
            if legs[i].start >= self.met.exit:
                break
            if legs[i].junction:
                return i
        return first

    @cached_property
    def _here(self) -> Leg:
        return self.path.legs[self.leg]

    @property
    def junction(self) -> str:
        return self._here.junction

    @cached_property
    def roads(self) -> set[str]:
        """The road in the junction and the one that leads there."""
        return {self._here.road, self.incoming}

    @property
    def incoming(self) -> str:
        """The road that leads to the junction; on a closed path that may be its last one."""
        return self.path.legs[self.leg - 1].road if self.leg or self.path.closed else ""

    @property
    def left_hand(self) -> bool:
        return self._here.left_hand

    @cached_property
    def start(self) -> float:
        """Where one comes to the junction, or to the meeting if there is none."""
        return self._here.start if self.junction else self.met.entry

    @cached_property
    def since(self) -> float:
        """Where the junction before ends: what stands from there on is meant for this one."""
        before = [i for i in range(self.leg) if self.path.legs[i].junction]
        return self.path.legs[before[-1] + 1].start if before else 0.0

    @cached_property
    def heading(self) -> float:
        return _heading(self.path, self.start)

    @cached_property
    def turn(self) -> float:
        """How far it turns to the left in the junction."""
        ends = [leg.start for leg in self.path.legs[self.leg + 1 :]][:1] or [self.path.length]
        end = ends[0] if self.junction else min(self.met.exit, self.path.length)
        return math.remainder(_heading(self.path, end) - self.heading, math.tau)

    @property
    def light(self) -> Light | None:
        """The light that is obeyed here."""
        here = [x for x in self.path.lights if self.since <= x.station <= self.start + _BEHIND]
        return here[-1] if here else None

    @cached_property
    def rank(self) -> int:
        """What signs say: 1 for the right of way, -1 for giving way, 0 for nothing."""
        rank = 0
        for order in self.path.orders:
            if order.station > self.start + _BEHIND:
                break
            if order.kind in {"306", "307"}:
                rank = int(order.kind == "306")
            elif order.station >= self.since:
                rank = 1 if order.kind == "301" else -1
        return rank

    def side(self, other: _Approach) -> float:
        """How far to the left of it the other one comes."""
        (here, there) = (_point(a.path, a.start) for a in (self, other))
        return float(((there - here) * complex(math.cos(self.heading), -math.sin(self.heading))).imag)


def _goes_first(network: Network, one: _Approach, other: _Approach) -> int:
    """1 if *one* goes first, -1 if the *other* does, 0 if lights see to it or nothing says.

    In this order: lights that are never green together; priorities of the junction; signs; in a roundabout who is on
    it; of those who come from ahead who does not cut across the other's side; of those who come side by side who turns
    less, else who is on the right; right before left.
    """
    if _lights_see_to_it(one.light, other.light):
        return 0
    if one.junction and one.junction == other.junction:
        junction = network.junctions[one.junction]
        for high, low in junction.priorities:
            if high in one.roads and low in other.roads:
                return 1
            if high in other.roads and low in one.roads:
                return -1
    if one.rank != other.rank:
        return 1 if one.rank > other.rank else -1
    ring = next((group for group in network.roundabouts if one.junction in group), frozenset[str]())
    on = [_is_within(network, each.incoming, ring) for each in (one, other)]
    if on[0] != on[1]:
        return 1 if on[0] else -1
    between = math.remainder(other.heading - one.heading, math.tau)
    if abs(between) > 0.75 * math.pi:
        more = (one.turn - other.turn) * (-1 if one.left_hand else 1)
        return 0 if abs(more) < _SAME else -1 if more > 0 else 1
    if abs(between) < 0.25 * math.pi:
        more = abs(one.turn) - abs(other.turn)
        if abs(more) >= _SAME:
            return -1 if more > 0 else 1
        return 1 if one.side(other) > 0 else -1
    return -1 if between > 0 else 1


def _is_within(network: Network, road: str, junctions: frozenset[str]) -> bool:
    """Whether a road leads from one of the *junctions* to another of them."""
    if road not in network.roads or not junctions:
        return False
    links = network.roads[road].links.values()
    return len(links) == 2 and all(link.element == "junction" and link.id in junctions for link in links)


def _lights_see_to_it(one: Light | None, other: Light | None) -> bool:
    """Whether both obey lights of one cycle that are on, and never let both go."""
    if one is None or other is None or not one.phases or not other.phases:
        return False
    colours = {colour for light in (one, other) for colour, _ in light.phases}
    cycles = [sum(seconds for _, seconds in light.phases) for light in (one, other)]
    if "off" in colours or abs(cycles[0] - cycles[1]) > 1e-9:
        return False
    changes = sorted({t % cycles[0] for light in (one, other) for t in _changes(light)})
    return not any(_shown(one, t) in _GOES and _shown(other, t) in _GOES for t in _between(changes, cycles[0]))


def _changes(light: Light) -> Iterator[float]:
    return accumulate((seconds for _, seconds in light.phases), initial=light.shift)


def _between(changes: Sequence[float], cycle: float) -> Iterator[float]:
    """A moment in each time between two changes that is not only what rounding makes of none."""
    for a, b in zip(changes, [*changes[1:], changes[0] + cycle], strict=True):
        if b - a > 1e-9:
            yield (a + b) / 2


def _shown(light: Light, time: float) -> str:
    ends = list(_changes(light))
    into = light.shift + (time - light.shift) % (ends[-1] - light.shift)
    return light.phases[min(bisect_right(ends, into) - 1, len(light.phases) - 1)][0]


def _heading(path: RoadPath, s: float) -> float:
    return float(place(path, np.array([s])).heading[0])


def _point(path: RoadPath, s: float) -> complex:
    station = np.array([s])
    placed = place(path, station, lane_middle(path, station))
    return complex(placed.x[0], placed.y[0])
