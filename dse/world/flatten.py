"""A way through a network → the path along it, in its direction of travel."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from dse.errors import Problem, raise_if_any
from dse.world.cross_section import Band, bands_of, overlaps
from dse.world.in_the_way import ALL_USERS
from dse.world.joints import STRICT, Joint, Tolerance, joined_up, with_hint
from dse.world.lane_graph import LaneGraph, lane_at, lane_graph
from dse.world.opendrive.curves import Reals, curve_of
from dse.world.opendrive.driving import DRIVEN, runs_along
from dse.world.opendrive.reading import read_network
from dse.world.opendrive.structure import Fault, Network
from dse.world.passages import Passage, lights, orders, passage_along, patches, speed_limit
from dse.world.pieces import in_a_row, joined, quintics, steps, value
from dse.world.right_of_way import conflicts
from dse.world.routes import Route, way_of
from dse.world.tables import LaneBand, Leg, Piecewise, RoadPath, RoadTables
from dse.world.ways import Way

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


def path_along(
    graph: LaneGraph, way: Way, name: str, *, every_lane: bool = False, tolerance: Tolerance = STRICT
) -> RoadPath:
    """The path along *way*, with its lanes for vehicles or *every_lane*.

    Raises DseError where something along it is not supported, or does not fit together beyond the *tolerance*.
    """
    passages = [passage_along(graph, places) for places in way.passages]
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
        along(speed_limit(p) for p in passages),
        lanes,
        tuple(patch for p, begin in zip(passages, begins, strict=False) for patch in patches(p, begin)),
        tuple(light for p, begin in zip(passages, begins, strict=False) for light in lights(p, begin)),
        tuple(order for p, begin in zip(passages, begins, strict=False) for order in orders(p, begin)),
        tuple(_leg(p, begin) for p, begin in zip(passages, begins, strict=False)),
        leftmost,
        rightmost,
    )
    path = joined_up(path, list(_joints(passages, begins, tolerance)), tolerance)
    told = {problem.where for problem in path.smoothed}
    tolerated = (fault.problem for fault in faults if fault.problem.where not in told)
    ignored = (Problem(f"tolerated: {problem.what}", problem.where) for problem in tolerated)
    return replace(path, smoothed=(*ignored, *path.smoothed))


def _joints(passages: Sequence[Passage], begins: Sequence[float], tolerance: Tolerance) -> Iterator[Joint]:
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


def _faults(graph: LaneGraph, passage: Passage) -> Iterator[Fault]:
    yield from passage.road.faults
    for at in passage.places:
        yield from lane_at(graph.network, at).faults


def _refused(graph: LaneGraph, passage: Passage) -> Iterator[Problem]:
    road = passage.road
    yield from road.refused
    junction = graph.network.junctions.get(road.junction)
    if junction is not None and junction.kind not in {"default", "direct"}:
        yield Problem(f"a road in a {junction.kind} junction is not supported on a path", junction.where)
    for at in passage.places:
        yield from lane_at(graph.network, at).refused
        yield from overlaps(road, at)


def _line(passage: Passage) -> tuple[Piecewise, Piecewise]:
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


def _lanes(passages: Sequence[Passage], *, every_lane: bool) -> Iterator[LaneBand]:
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


def _common_users(passages: Sequence[Passage], rows: Sequence[Sequence[Band]]) -> int:
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


def _along_sections(passages: Sequence[Passage], parts: Sequence[Sequence[Piecewise]]) -> Piecewise:
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


def _leg(passage: Passage, begin: float) -> Leg:
    return Leg(begin, passage.road.id, passage.road.junction, passage.road.left_hand)


def _same_direction(passage: Passage, lanes: Sequence[LaneBand]) -> tuple[int, int]:
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
