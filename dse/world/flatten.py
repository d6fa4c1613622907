"""A way through a network → the path along it, in its direction of travel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import TypeVar

import numpy as np

from dse.errors import Problem, raise_if_any
from dse.world.cross_section import Band, bands_of, overlaps
from dse.world.in_the_way import ALL_USERS
from dse.world.joints import STRICT, Joint, Tolerance, joined_up, with_hint
from dse.world.lane_graph import LaneGraph, LanePlace, lane_at, lane_graph
from dse.world.opendrive.curves import Reals, curve_of
from dse.world.opendrive.driving import DRIVEN, runs_along
from dse.world.opendrive.reading import read_network
from dse.world.opendrive.structure import Cubic, Fault, Network, Road, Sign, Signal, TrafficOrder as Ordered
from dse.world.pieces import backwards, from_cubics, in_a_row, joined, quintics, steps, value
from dse.world.right_of_way import conflicts
from dse.world.routes import Route, Way, way_of
from dse.world.tables import LaneBand, Leg, Light, Patch, PathOrder, Piecewise, RoadPath, RoadTables

_Standing = TypeVar("_Standing", Signal, Sign, Ordered)
_NO_LANE = 1e-3  # m: a lane that is narrower is not there yet


def read_road_tables(path: Path, file: str, routes: Sequence[Route] = ()) -> RoadTables:
    """The paths of *routes* through the OpenDRIVE file at *path*, which is called *file* in messages.

    Without routes it is the longest way straight on. Raises DseError with all that is wrong, where it stands.
    """
    return road_tables(read_network(path, file), routes)


def road_tables(network: Network, routes: Sequence[Route] = (), tolerance: Tolerance = STRICT) -> RoadTables:
    """The paths of *routes*, in their order; without routes, the longest way straight on.

    Raises DseError with all that keeps a path from being followed, where it stands.
    """
    graph = lane_graph(network)
    ways = [(way_of(graph, route), route.name) for route in routes or (Route(),)]
    paths = tuple(path_along(graph, way, name, tolerance=tolerance) for way, name in ways)
    return RoadTables(paths, tuple(conflicts(network, paths)))


@dataclass(frozen=True, eq=False, slots=True)
class _Passage:
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


def path_along(
    graph: LaneGraph, way: Way, name: str, *, every_lane: bool = False, tolerance: Tolerance = STRICT
) -> RoadPath:
    """The path along *way*, with its lanes for vehicles or *every_lane*.

    Raises DseError where something along it is not supported, or does not fit together beyond the *tolerance*.
    """
    passages = [_passage(graph, places) for places in way.passages]
    faults = [fault for passage in passages for fault in _faults(graph, passage)]
    refused = [problem for passage in passages for problem in _refused(graph, passage)]
    larger = [with_hint(fault.problem) for fault in faults if not tolerance.covers(fault.step, fault.kink)]
    raise_if_any([*refused, *larger])
    lengths = [passage.length for passage in passages]
    begins = [float(begin) for begin in np.cumsum([0.0, *lengths])]
    lines = [_line(passage) for passage in passages]

    def along(parts: Iterable[Piecewise]) -> Piecewise:
        return joined(list(zip(parts, lengths, strict=True)))

    lanes = tuple(_lanes(passages, every_lane=every_lane))
    leftmost, rightmost = _same_direction(passages[0], lanes)
    path = RoadPath(
        name,
        begins[-1],
        way.closed,
        in_a_row([(x, length) for (x, _), length in zip(lines, lengths, strict=True)]),
        in_a_row([(y, length) for (_, y), length in zip(lines, lengths, strict=True)]),
        along(p.cubics(p.road.elevation) for p in passages),
        along(p.cubics(p.road.superelevation, -1.0) for p in passages),
        along(_speed_limit(p) for p in passages),
        lanes,
        tuple(patch for p, begin in zip(passages, begins, strict=False) for patch in _patches(p, begin)),
        tuple(light for p, begin in zip(passages, begins, strict=False) for light in _lights(p, begin)),
        tuple(order for p, begin in zip(passages, begins, strict=False) for order in _orders(p, begin)),
        tuple(_leg(p, begin) for p, begin in zip(passages, begins, strict=False)),
        leftmost,
        rightmost,
    )
    path = joined_up(path, list(_joints(passages, begins, tolerance)), tolerance)
    told = {problem.where for problem in path.smoothed}
    tolerated = (fault.problem for fault in faults if fault.problem.where not in told)
    ignored = (Problem(f"tolerated: {problem.what}", problem.where) for problem in tolerated)
    return replace(path, smoothed=(*ignored, *path.smoothed))


def _joints(passages: Sequence[_Passage], begins: Sequence[float], tolerance: Tolerance) -> Iterator[Joint]:
    """Where roads meet along a path, and with a tolerance also where the pieces of their lines do."""
    for number, (passage, begin) in enumerate(zip(passages, begins, strict=False)):
        if number:
            yield Joint(begin, passage.road.where, "the lane of the path", "in this road")
        for piece in passage.road.geometries[1:] if tolerance != STRICT else ():
            if passage.start < piece.s < passage.end:
                yield Joint(
                    begin + passage.from_start(piece.s), piece.where, "the reference line", "in this <geometry>"
                )
    yield Joint(begins[-1], passages[0].road.where, "the lane of the path", "in this road")


def _passage(graph: LaneGraph, places: tuple[LanePlace, ...]) -> _Passage:
    road = graph.network.roads[places[0].road]
    sections = sorted(place.section for place in places)
    start, end = road.sections[sections[0]].s, road.sections[sections[-1]].end
    # The first begins at 0, to what is let pass.
    start = start if sections[0] else 0.0
    return _Passage(road, places, runs_along(road, lane_at(graph.network, places[0])), start, end)


def _faults(graph: LaneGraph, passage: _Passage) -> Iterator[Fault]:
    yield from passage.road.faults
    for at in passage.places:
        yield from lane_at(graph.network, at).faults


def _refused(graph: LaneGraph, passage: _Passage) -> Iterator[Problem]:
    road = passage.road
    yield from road.refused
    junction = graph.network.junctions.get(road.junction)
    if junction is not None and junction.kind not in {"default", "direct"}:
        yield Problem(f"a road in a {junction.kind} junction is not supported on a path", junction.where)
    for at in passage.places:
        yield from lane_at(graph.network, at).refused
        yield from overlaps(road, at)


def _line(passage: _Passage) -> tuple[Piecewise, Piecewise]:
    pieces = passage.road.geometries
    bounds = np.clip([0.0, *(piece.s for piece in pieces[1:]), passage.road.length], passage.start, passage.end)
    parts = [
        (quintics(curve_of(piece), float(start - piece.s), float(end - piece.s)), float(end - start))
        for piece, (start, end) in zip(pieces, pairwise(bounds), strict=True)
        if end > start
    ]
    x = in_a_row([(x, length) for (x, _), length in parts])
    y = in_a_row([(y, length) for (_, y), length in parts])
    return passage.turned(x), passage.turned(y)


def _lanes(passages: Sequence[_Passage], *, every_lane: bool) -> Iterator[LaneBand]:
    """The bands beside the path, its own first; each all along it."""
    sections = [[bands_of(p.road, place, along=p.along, every_lane=every_lane) for place in p.places] for p in passages]
    numbers = {number for passage in sections for bands in passage for number in bands}
    for number in sorted(numbers, key=lambda number: (abs(number), -number)):
        rows = [[_band(bands, number) for bands in passage] for passage in sections]
        yield LaneBand(
            number,
            _along_sections(passages, [[band.left for band in row] for row in rows]),
            _along_sections(passages, [[band.right for band in row] for row in rows]),
            _along_sections(passages, [[band.friction for band in row] for row in rows]),
            _common_users(passages, rows),
        )


def _common_users(passages: Sequence[_Passage], rows: Sequence[Sequence[Band]]) -> int:
    """The bits of who may drive on a lane wherever it is there."""
    users = ALL_USERS
    for passage, row in zip(passages, rows, strict=True):
        for at, band in zip(passage.places, row, strict=True):
            section = passage.road.sections[at.section]
            if np.any(np.abs(_widths(band, section.end - section.s)) > _NO_LANE):
                users &= band.users
    return users


def _widths(band: Band, length: float) -> Reals:
    stations = np.linspace(0.0, length, 5)
    return value(band.left, stations) - value(band.right, stations)


def _along_sections(passages: Sequence[_Passage], parts: Sequence[Sequence[Piecewise]]) -> Piecewise:
    """The parts of all sections in a row; roads begin where they do for all else of the path, to the last bit."""
    roads = []
    for passage, row in zip(passages, parts, strict=True):
        sections = [passage.road.sections[place.section] for place in passage.places]
        lengths = [section.end - section.s for section in sections]
        roads.append((joined(list(zip(row, lengths, strict=True))), passage.length))
    return joined(roads)


def _band(bands: dict[int, Band], number: int) -> Band:
    """The band of a section; an empty one at the edge of those that are there if it has none of that number."""
    if number in bands:
        return bands[number]
    edge = bands[max(bands)].left if number > 0 else bands[min(bands)].right
    return Band(edge, edge, steps((), 0.0, 1.0, 1.0), ALL_USERS)


def _speed_limit(passage: _Passage) -> Piecewise:
    """A lane's limits go before those of the road."""
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


def _patches(passage: _Passage, begin: float) -> Iterator[Patch]:
    for slick in passage.road.slicks:
        start, end = max(slick.start, passage.start), min(slick.end, passage.end)
        if end > start and passage.along:
            shift = begin - passage.start
            yield Patch(shift + start, shift + end, slick.right, slick.left, slick.friction)
        elif end > start:
            shift = begin + passage.end
            yield Patch(shift - end, shift - start, -slick.left, -slick.right, slick.friction)


def _lights(passage: _Passage, begin: float) -> Iterator[Light]:
    lights = _meant(passage, passage.road.signals)
    found = [Light(light.id, begin + passage.from_start(light.s), light.phases, light.shift) for light in lights]
    yield from sorted(found, key=lambda light: light.station)


def _orders(passage: _Passage, begin: float) -> Iterator[PathOrder]:
    orders = _meant(passage, passage.road.orders)
    found = [PathOrder(begin + passage.from_start(order.s), order.kind) for order in orders]
    yield from sorted(found, key=lambda order: order.station)


def _leg(passage: _Passage, begin: float) -> Leg:
    return Leg(begin, passage.road.id, passage.road.junction, passage.road.left_hand)


def _same_direction(passage: _Passage, lanes: Sequence[LaneBand]) -> tuple[int, int]:
    """The leftmost and rightmost of the lanes beside the path's own that are driven with it where it begins."""
    road, place = passage.road, passage.places[0]
    section = road.sections[place.section]
    ids = sorted(i for i, lane in section.lanes.items() if i == place.lane or lane.type in DRIVEN)
    own, sign = ids.index(place.lane), 1 if passage.along else -1
    along = {sign * (i - own) for i, id_ in enumerate(ids) if runs_along(road, section.lanes[id_]) == passage.along}
    wide = {lane.number for lane in lanes if float(np.subtract(*_edges_at_start(lane))) > _NO_LANE}
    found = [0, 0]
    for i, step in enumerate((1, -1)):
        while found[i] + step in along & wide:
            found[i] += step
    return found[0], found[1]


def _edges_at_start(lane: LaneBand) -> tuple[float, float]:
    return float(lane.left.coefficients[0, 0]), float(lane.right.coefficients[0, 0])


def _meant(passage: _Passage, signals: Iterable[_Standing]) -> Iterator[_Standing]:
    """Those that look at who drives here, and are for the lane."""
    sections, facing = passage.road.sections, {"none", "+" if passage.along else "-"}
    for signal in signals:
        s = min(signal.s, passage.road.length)
        lanes = [p.lane for p in passage.places if sections[p.section].s <= s <= sections[p.section].end]
        meant = not signal.lanes or any(min(pair) <= lane <= max(pair) for pair in signal.lanes for lane in lanes)
        if signal.orientation in facing and lanes and meant:
            yield signal
