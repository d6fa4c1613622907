"""Where the lanes of a network of SUMO lie along the paths of a road component."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.errors import Location, Problem, fail, raise_if_any
from dse.formats import XmlElement, read_xml
from dse.world.code import along_own_lane
from dse.world.evaluation import lane_middle
from dse.world.in_the_way import LEVEL
from dse.world.pieces import value
from dse.world.tables import Piecewise, RoadPath

Array = NDArray[np.float64]

_SPACING = 1.0  # m between the points from which feet are looked for
_ROUNDS = 12
_NEAR = 1.5  # m from the middle of a lane of ours to that of SUMO's which is the same
_NO_LIMIT = 70.0  # m/s


@dataclass(frozen=True, eq=False)
class SumoLane:
    """A lane of SUMO: its *edge*, and points (n, 2) along its middle with *heights* (n) at *positions* (n), SUMO's way
    of counting."""

    name: str
    edge: str
    points: Array
    heights: Array
    positions: Array

    @property
    def is_inside(self) -> bool:
        """Whether it lies inside a junction."""
        return self.name.startswith(":")


def sumo_lanes(network: bytes) -> list[SumoLane]:
    """All lanes of a network as netconvert writes it, in the coordinates of the roads it was made of."""
    root = read_xml(network, "the network of SUMO")
    shifts = [place.attributes["netOffset"].split(",") for place in root.all("location")]
    shift = np.array([float(number) for number in shifts[0]])
    return [_lane(edge.attributes["id"], lane, shift) for edge in root.all("edge") for lane in edge.all("lane")]


def has_lights(network: bytes) -> bool:
    """Whether something in the network obeys traffic lights."""
    return read_xml(network, "the network of SUMO").child("tlLogic") is not None


def _lane(edge: str, lane: XmlElement, shift: Array) -> SumoLane:
    told = lane.attributes
    # SUMO leaves a height of 0 out, and measures along the slope.
    shape = np.array([[*map(float, point.split(",")), 0.0][:3] for point in told["shape"].split()])
    points = shape[:, :2] - shift
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(shape, axis=0), axis=1))])
    length = float(told["length"])
    # What lies between two roads that touch has a length for SUMO alone.
    positions = along * (length / along[-1]) if along[-1] > 0 else np.linspace(0.0, length, len(along))
    return SumoLane(told["id"], edge, points, shape[:, 2], positions)


def placed_lanes(lanes: Sequence[SumoLane], paths: Sequence[RoadPath], where: Location | None) -> dict[str, Any]:
    """The lanes that lie along *paths*, for the simulation; a lane of several belongs to the first.

    ``lanes``: by name the edge, path, number of the lane, speed limit, and knots: station along the middle of the
    path's own lane, m to the left of the middle of the lane, x and y. ``edges``: by name positions and stations.
    In SUMO all lanes of an edge count alike, however they bend: so the lane that is nearest to the path's own gives the
    stations of all, and who changes lanes stays where it is. ``routes``: the edges along each path. ``laps``: how long
    each path is, 0 if it is not closed. Raises DseError for a path along which SUMO has no way.
    """
    placed: dict[str, Any] = {}
    edges: dict[str, tuple[tuple[int, int, int], list[list[float]]]] = {}
    routes, laps, problems = [], [], []
    for number, path in enumerate(paths):
        own = along_own_lane(path)
        lap = float(value(own, np.array([path.length]))[0])
        laps.append(lap if path.closed else 0.0)
        feet = _Feet(path)
        starts: dict[str, float] = {}
        for lane in lanes:
            found = _along(lane, path, feet, own, lap)
            if found is None:
                continue
            lane_number, knots, limit = found
            entry = {"edge": lane.edge, "path": number, "lane": lane_number, "limit": limit}
            placed.setdefault(lane.name, {**entry, "knots": knots[:, 1:].tolist()})
            rank = number, abs(lane_number), lane_number
            if lane.edge not in edges or rank < edges[lane.edge][0]:
                edges[lane.edge] = rank, knots[:, :2].T.tolist()
            if not lane.is_inside:
                starts[lane.edge] = min(knots[0, 1], starts.get(lane.edge, np.inf))
        if not starts:
            problems.append(Problem(f"SUMO's network of the road has no lanes along the path '{path.name}'", where))
        routes.append(sorted(starts, key=starts.__getitem__))
    raise_if_any(problems)
    counted = {name: entry for name, (_, entry) in edges.items()}
    return {"lanes": placed, "edges": counted, "routes": routes, "laps": laps}


class _Feet:
    """Stations of the reference line next to many points at once."""

    def __init__(self, path: RoadPath) -> None:
        from scipy.spatial import cKDTree

        self._path = path
        self._stations = np.linspace(0.0, path.length, int(path.length / _SPACING) + 2)
        self._tree = cKDTree(np.column_stack([value(path.x, self._stations), value(path.y, self._stations)]))

    def of(self, points: Array) -> tuple[Array, Array, Array]:
        """Stations, m to the left, and headings of the line there."""
        path = self._path
        s = self._stations[self._tree.query(points)[1]]
        for _ in range(_ROUNDS):
            x, dx, ddx = (value(path.x, s, order) for order in range(3))
            y, dy, ddy = (value(path.y, s, order) for order in range(3))
            to_x, to_y = points[:, 0] - x, points[:, 1] - y
            slope = np.maximum(dx * dx + dy * dy - to_x * ddx - to_y * ddy, 1e-3)
            s = np.clip(s + (to_x * dx + to_y * dy) / slope, 0.0, path.length)
        x, dx = (value(path.x, s, order) for order in range(2))
        y, dy = (value(path.y, s, order) for order in range(2))
        aside = ((points[:, 1] - y) * dx - (points[:, 0] - x) * dy) / np.hypot(dx, dy)
        return s, aside, np.arctan2(dy, dx)


def _along(lane: SumoLane, path: RoadPath, feet: _Feet, own: Piecewise, lap: float) -> tuple[int, Array, float] | None:
    """The number of the lane, its knots and its speed limit; None if it does not lie along the path."""
    s, aside, heading = feet.of(lane.points)
    off = np.hypot(*(lane.points - _points(path, s, aside)).T)
    way = np.diff(lane.points, axis=0)
    against = np.abs(np.angle(np.exp(1j * (np.arctan2(way[:, 1], way[:, 0]) - heading[:-1]))))
    length = np.hypot(*way.T)
    apart = lane.heights - value(path.height, s)  # SUMO leaves the bank out
    if off.max() > _NEAR or np.abs(apart).max() >= LEVEL or np.any(against[length > 0.2] > np.pi / 3):
        return None
    best = min(_numbered(path, s, aside), default=None)
    if best is None:
        return None
    _, _, number, offset = best
    station = value(own, s)
    if path.closed:
        station = np.unwrap(station, period=lap)
    knots = np.column_stack([lane.positions, station, offset, lane.points])
    keep = np.concatenate([[True], np.diff(station) > 1e-6])
    knots = knots[keep] if keep.sum() > 1 else knots[[0, -1]]
    limit = float(value(path.speed_limit, s[len(s) // 2 : len(s) // 2 + 1])[0])
    return number, knots, limit or _NO_LIMIT


def _numbered(path: RoadPath, s: Array, aside: Array) -> Iterator[tuple[float, int, int, Array]]:
    """Lanes of ours that are near: how near, the number, and where SUMO's lies in it."""
    for lane in path.lanes:
        offset = aside - lane_middle(path, s, lane.number)
        if np.abs(offset).max() <= _NEAR:
            yield float(np.abs(offset).mean()), abs(lane.number), lane.number, offset


def _points(path: RoadPath, s: Array, aside: Array) -> Array:
    x, dx = (value(path.x, s, order) for order in range(2))
    y, dy = (value(path.y, s, order) for order in range(2))
    pace = np.hypot(dx, dy)
    return np.column_stack([x - aside * dy / pace, y + aside * dx / pace])


def check_way(network: bytes, placed: dict[str, Any], paths: Sequence[RoadPath], where: Location | None) -> None:
    """Raise DseError where SUMO has no connection from an edge along a path to the next."""
    root = read_xml(network, "the network of SUMO")
    known = {(c.attributes["from"], c.attributes["to"]) for c in root.all("connection")}
    for path, edges in zip(paths, placed["routes"], strict=True):
        for one, other in pairwise(edges):
            if (one, other) not in known:
                what = f"SUMO's network has no way along the path '{path.name}' from its edge '{one}' to '{other}'"
                raise fail(what, where, "netconvert reads this junction otherwise: leave the path out, or name another")
