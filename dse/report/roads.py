"""What a picture of a road network shows, as values."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from dse.report.content.data import Floats
from dse.report.drawing.road_picture import Along, AlongBand, Area, Driven, RoadPicture, StandingLight, Strip
from dse.world import (
    DRIVEN,
    Curve,
    Lane,
    Network,
    Road,
    RoadPath,
    Signal,
    borders_of,
    curve_of,
    from_cubics,
    lane_middle,
    place,
    road_tables,
    runs_along,
    value,
)

_TURN = 0.05
"""Between points that are drawn, a road turns by no more than that, in rad."""
_MOST_DRIVEN = 2000
_PROFILE = 2001


def road_picture(network: Network, title: str) -> RoadPicture:
    """What is drawn of *network*. Raises DseError if no path leads through it."""
    lines = [RoadLine(road) for road in network.roads.values()]
    strips = tuple(strip for line in lines for strip in line.strips())
    areas = tuple(area for line in lines for area in line.areas())
    lights = [light.place[:2] for line in lines for light in line.lights()]
    return RoadPicture(title, strips, areas, np.reshape(lights, (-1, 2)), _along(road_tables(network).paths[0]))


def standing_lights(network: Network) -> tuple[StandingLight, ...]:
    """The traffic lights of *network*; one that several roads name is there once for each."""
    return tuple(light for road in network.roads.values() for light in RoadLine(road).lights())


def with_driven(picture: RoadPicture, network: Network, label: str, x: Floats, y: Floats) -> RoadPicture:
    """*picture* with a path that was driven on *network*: at most 2000 of its points."""
    path = road_tables(network).paths[0]
    kept = np.unique(np.linspace(0, len(x) - 1, min(len(x), _MOST_DRIVEN)).astype(int))
    station, left = _feet(path, x[kept], y[kept])
    offset = left - lane_middle(path, station)
    return replace(picture, driven=(*picture.driven, Driven(label, x[kept], y[kept], station, offset)))


def _feet(path: RoadPath, x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Stations, and m to the left of the reference line, of points: from the nearest of many places on by Newton."""
    from scipy.spatial import KDTree

    tried = np.linspace(0.0, path.length, int(path.length) + 100)
    places = place(path, tried)
    station = tried[KDTree(np.stack([places.x, places.y], axis=1)).query(np.stack([x, y], axis=1))[1]]
    left = np.zeros_like(station)
    for _ in range(10):
        on = place(path, station)
        dx, dy, cosine, sine = x - on.x, y - on.y, np.cos(on.heading), np.sin(on.heading)
        left = dy * cosine - dx * sine
        ahead = (dx * cosine + dy * sine) / np.maximum(1 - on.curvature * left, 0.2)
        station = np.clip(station + ahead, 0.0, path.length)
    return station, left


class RoadLine:
    """A road whose reference line is sampled where it turns and where its lanes change."""

    def __init__(self, road: Road) -> None:
        self._road = road
        self._curves = [curve_of(geometry) for geometry in road.geometries]
        self._starts = np.array([geometry.s for geometry in road.geometries])
        self._bends = np.concatenate([_bends(curve) for curve in self._curves])

    def strips(self) -> Iterator[Strip]:
        """All lanes, section by section, in the direction in which they are driven."""
        for section in self._road.sections:
            borders = borders_of(self._road, section)
            stations = self.between(section.s, section.end)
            for id_, lane in section.lanes.items():
                ts = [value(border, stations - section.s) for border in borders[id_]]
                right, left = (self.along(stations, t) for t in ts)
                if not runs_along(self._road, lane):
                    right, left = left[::-1], right[::-1]
                if lane.type != "none":
                    sides = left[:, :2], right[:, :2], left[:, 2], right[:, 2]
                    yield Strip(*sides, lane.type in DRIVEN, bool(self._road.junction), lane.type)

    def areas(self) -> Iterator[Area]:
        """What is not as dry asphalt: lanes, and patches upon them."""
        for section in self._road.sections:
            borders = borders_of(self._road, section)
            for id_, lane in section.lanes.items():
                ends = [*(s for s, _ in lane.frictions[1:]), section.end]
                for (start, friction), end in zip(lane.frictions, ends, strict=False):
                    if friction != 1.0 and start < end:
                        stations = self.between(start, end)
                        right, left = (value(border, stations - section.s) for border in borders[id_])
                        yield self._area(stations, right, left, friction)
        for slick in self._road.slicks:
            stations = self.between(slick.start, min(slick.end, self._road.length))
            ones = np.ones_like(stations)
            yield self._area(stations, slick.right * ones, slick.left * ones, slick.friction)

    def lights(self) -> Iterator[StandingLight]:
        """Traffic lights, and the lines before them."""
        for signal in self._road.signals:
            section = next(each for each in reversed(self._road.sections) if each.s <= signal.s)
            at = np.array([min(signal.s, self._road.length)])
            is_back = signal.orientation == "-"
            borders = borders_of(self._road, section)
            sides = {id_: [float(value(side, at - section.s)[0]) for side in borders[id_]] for id_ in section.lanes}
            every = [t for pair in sides.values() for t in pair]
            # Where none of the lanes is driven that way, the line is across all that are there.
            driven = [t for id_, pair in sides.items() if self._obeys(signal, section.lanes[id_], id_) for t in pair]
            right, left = min(driven or every), max(driven or every)
            beside = max(every) + 1.0 if is_back else min(every) - 1.0
            along = self.heading_at(float(at[0]))
            yield StandingLight(
                signal.id,
                self.point(at, beside),
                along + np.pi if is_back else along,
                np.stack([self.point(at, t) for t in ((right, left) if is_back else (left, right))]),
            )

    def _obeys(self, signal: Signal, lane: Lane, id_: int) -> bool:
        """Whether who drives on *lane* obeys *signal*."""
        is_meant = not signal.lanes or any(min(pair) <= id_ <= max(pair) for pair in signal.lanes)
        is_faced = signal.orientation == "none" or runs_along(self._road, lane) == (signal.orientation == "+")
        return lane.type in DRIVEN and is_meant and is_faced

    def heading_at(self, station: float) -> float:
        """The heading of the reference line."""
        piece = min(max(int(np.searchsorted(self._starts, station, side="right")) - 1, 0), len(self._starts) - 1)
        curve = self._curves[piece]
        along = np.array([min(station - curve.geometry.s, curve.geometry.length)])
        return float(curve.at(along).heading[0])

    def point(self, at: Floats, t: float) -> Floats:
        """(3) *t* to the left of the line at the one station *at*."""
        left = np.array([t])
        return np.append(self._xy(at, left)[0], self._z(at, left))

    def _area(self, stations: Floats, right: Floats, left: Floats, friction: float) -> Area:
        return Area(np.concatenate([self._xy(stations, right), self._xy(stations, left)[::-1]]), friction)

    def between(self, start: float, end: float) -> Floats:
        """Stations from *start* to *end*, between which straight lines are drawn."""
        inner = self._bends[(self._bends > start) & (self._bends < end)]
        return np.unique(np.concatenate([np.linspace(start, end, 17), inner]))

    def along(self, stations: Floats, t: Floats) -> Floats:
        """Points (n, 3) at *stations*, *t* to the left of the line."""
        return np.column_stack([self._xy(stations, t), self._z(stations, t)])

    def _z(self, stations: Floats, t: Floats) -> Floats:
        """Heights at *stations*, *t* to the left of the line."""
        end = self._road.length
        height, bank = (from_cubics(cubics, 0.0, end) for cubics in (self._road.elevation, self._road.superelevation))
        return value(height, stations) + t * np.tan(value(bank, stations))

    def _xy(self, stations: Floats, t: Floats) -> Floats:
        """Points (n, 2) at *stations*, *t* to the left of the line."""
        found = np.empty((len(stations), 2))
        piece = np.clip(np.searchsorted(self._starts, stations, side="right") - 1, 0, len(self._starts) - 1)
        for number in np.unique(piece):
            curve, chosen = self._curves[number], piece == number
            frames = curve.at(np.minimum(stations[chosen] - curve.geometry.s, curve.geometry.length))
            found[chosen, 0] = curve.geometry.x + frames.x - t[chosen] * np.sin(frames.heading)
            found[chosen, 1] = curve.geometry.y + frames.y + t[chosen] * np.cos(frames.heading)
        return found


def _bends(curve: Curve) -> Floats:
    """Stations of the road along *curve*, so close that it turns little between them."""
    geometry = curve.geometry
    heading = np.unwrap(curve.at(np.linspace(0.0, geometry.length, 33)).heading)
    count = int(np.sum(np.abs(np.diff(heading))) / _TURN) + 2
    return geometry.s + np.linspace(0.0, geometry.length, count)


def _along(path: RoadPath) -> Along:
    stations = np.linspace(0.0, path.length, _PROFILE)
    # A closed path's end is its start.
    inside = np.minimum(stations, np.nextafter(path.length, 0.0))
    middle = lane_middle(path, inside)
    line, lane = place(path, inside), place(path, inside, middle)
    bands = []
    for band in path.lanes:
        right, left = (value(side, inside) - middle for side in (band.right, band.left))
        there = left - right > 1e-6
        bands.append(AlongBand(np.where(there, right, np.nan), np.where(there, left, np.nan), band.number == 0))
    limits = zip(path.speed_limit.starts.tolist(), path.speed_limit.coefficients[:, 0].tolist(), strict=True)
    return Along(
        stations,
        lane.x,
        lane.y,
        line.z,
        np.tan(line.bank),
        line.curvature,
        tuple(bands),
        tuple(_areas_along(path)),
        np.array([light.station for light in path.lights]),
        tuple(limits),
    )


def _areas_along(path: RoadPath) -> Iterator[Area]:
    for band in path.lanes:
        ends = np.append(band.friction.starts[1:], path.length)
        for start, end, friction in zip(band.friction.starts, ends, band.friction.coefficients[:, 0], strict=True):
            if friction != 1.0:
                stations = np.linspace(start, np.nextafter(end, start), 33)
                yield _beside(path, stations, value(band.right, stations), value(band.left, stations), float(friction))
    for patch in path.patches:
        stations = np.linspace(patch.start, patch.end, 33)
        ones = np.ones_like(stations)
        yield _beside(path, stations, patch.right * ones, patch.left * ones, patch.friction)


def _beside(path: RoadPath, stations: Floats, right: Floats, left: Floats, friction: float) -> Area:
    middle = lane_middle(path, stations)
    there, back = np.stack([stations, right - middle], axis=1), np.stack([stations, left - middle], axis=1)[::-1]
    return Area(np.concatenate([there, back]), friction)
