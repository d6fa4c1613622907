"""A road as a path passes it: what stands on it and along it, in the direction of travel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np

from dse.world.lane_graph import LaneGraph, LanePlace, lane_at
from dse.world.opendrive.driving import runs_along
from dse.world.opendrive.structure import Cubic, Road, Sign, Signal, TrafficOrder as Ordered
from dse.world.pieces import backwards, from_cubics, steps
from dse.world.tables import Light, Patch, PathOrder, Piecewise

_Standing = TypeVar("_Standing", Signal, Sign, Ordered)


@dataclass(frozen=True, eq=False, slots=True)
class Passage:
    """A road from its station *start* to *end*, all of it if the lane does not end before.

    It is driven *along* its stations or against them.
    """

    road: Road
    places: tuple[LanePlace, ...]
    along: bool
    start: float
    end: float

    @property
    def length(self) -> float:
        """How far it goes, in m."""
        return self.end - self.start

    def from_start(self, s: float) -> float:
        """How far along it a station of its road lies."""
        s = min(s, self.road.length)
        return s - self.start if self.along else self.end - s

    def turned(self, piecewise: Piecewise, sign: float = 1.0) -> Piecewise:
        """What counts from *start* on, in the direction of travel."""
        return piecewise if self.along else backwards(piecewise, self.length, sign)

    def cubics(self, cubics: Sequence[Cubic], sign: float = 1.0) -> Piecewise:
        """The cubics of the road, in the direction of travel; *sign* is what they change there."""
        return self.turned(from_cubics(cubics, self.start, self.end), sign)


def passage_along(graph: LaneGraph, places: tuple[LanePlace, ...]) -> Passage:
    """The road that *places* are in, as far as they reach."""
    road = graph.network.roads[places[0].road]
    sections = sorted(place.section for place in places)
    start, end = road.sections[sections[0]].s, road.sections[sections[-1]].end
    # The first begins at 0, to what is let pass.
    start = start if sections[0] else 0.0
    return Passage(road, places, runs_along(road, lane_at(graph.network, places[0])), start, end)


def speed_limit(passage: Passage) -> Piecewise:
    """The limits along it in m/s; a lane's go before those of the road."""
    road = passage.road
    values: list[tuple[float, float]] = []
    for at in sorted(passage.places, key=lambda at: at.section):
        section = road.sections[at.section]
        own = section.lanes[at.lane].limits
        until = min((limit.s for limit in own), default=section.end)
        before = [limit.speed for limit in road.limits if limit.s <= section.s]
        values.append((section.s, before[-1] if before else 0.0))
        values += [(limit.s, limit.speed) for limit in road.limits if section.s < limit.s < until]
        values += [(limit.s, limit.speed) for limit in own]
    written = passage.turned(steps(values, passage.start, passage.end, 0.0))
    signs = [(passage.from_start(sign.s), sign.speed) for sign in _meant(passage, road.signs)]
    return _with_signs(written, sorted(sign for sign in signs if sign[0] < passage.length))


def _with_signs(written: Piecewise, signs: list[tuple[float, float]]) -> Piecewise:
    """A sign holds until the next one, the next limit that is *written*, or the end of the road; 0 ends it."""
    if not signs:
        return written
    changes = [*zip(written.starts.tolist(), written.coefficients[:, 0].tolist(), strict=True)]
    told = dict(changes)
    for station, speed in signs:
        told[station] = speed or next(value for start, value in reversed(changes) if start <= station)
    starts = sorted(told)
    return Piecewise(np.array(starts), np.array([[told[start]] for start in starts]))


def patches(passage: Passage, begin: float) -> Iterator[Patch]:
    """Its slippery patches, on a path where it begins at *begin*."""
    for slick in passage.road.slicks:
        start, end = max(slick.start, passage.start), min(slick.end, passage.end)
        if end > start and passage.along:
            shift = begin - passage.start
            yield Patch(shift + start, shift + end, slick.right, slick.left, slick.friction)
        elif end > start:
            shift = begin + passage.end
            yield Patch(shift - end, shift - start, -slick.left, -slick.right, slick.friction)


def lights(passage: Passage, begin: float) -> Iterator[Light]:
    """The lights that its lane obeys, by their stations."""
    meant = _meant(passage, passage.road.signals)
    found = [Light(light.id, begin + passage.from_start(light.s), light.phases, light.shift) for light in meant]
    yield from sorted(found, key=lambda light: light.station)


def orders(passage: Passage, begin: float) -> Iterator[PathOrder]:
    """The signs of right of way that are for its lane, by their stations."""
    meant = _meant(passage, passage.road.orders)
    found = [PathOrder(begin + passage.from_start(order.s), order.kind) for order in meant]
    yield from sorted(found, key=lambda order: order.station)


def _meant(passage: Passage, signals: Iterable[_Standing]) -> Iterator[_Standing]:
    """Those that look at who drives here, and are for the lane."""
    sections, facing = passage.road.sections, {"none", "+" if passage.along else "-"}
    for signal in signals:
        s = min(signal.s, passage.road.length)
        lanes = [p.lane for p in passage.places if sections[p.section].s <= s <= sections[p.section].end]
        meant = not signal.lanes or any(min(pair) <= lane <= max(pair) for pair in signal.lanes for lane in lanes)
        if signal.orientation in facing and lanes and meant:
            yield signal
