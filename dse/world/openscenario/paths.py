"""The paths that the road users of a scenario take, with every lane beside them.

A path is a way through the network: upstream as far as the lanes before a place go straight on, along the roads of a
route, and then straight on. A road user keeps a lane of its path and an offset, so that it may leave the path's own
lane, and drive against the path in a lane for the oncoming traffic.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dse.errors import DseError, Location, fail
from dse.world.cross_section import borders_of
from dse.world.flatten import path_along
from dse.world.in_the_way import on_one_level
from dse.world.lane_graph import LaneGraph, LanePlace, lane_at, lane_graph, next_places
from dse.world.opendrive.curves import curve_of
from dse.world.opendrive.driving import runs_along
from dse.world.opendrive.structure import Network, Road, Section
from dse.world.pieces import from_cubics, value
from dse.world.routes import Route, way_of
from dse.world.tables import RoadPath
from dse.world.ways import Onward, Way, straight_on, way_in

_MOST_PATHS = 40
_OTHER_LEVEL = 1e6
_UPSTREAM = 1000.0
"""How far a path reaches back before the place that it was made for, in m, if the lanes there go straight on."""


@dataclass(frozen=True, slots=True)
class LaneRow:
    """From station *start* of a path on, the lane *id* of its road is its number *number*.

    *sense* 1: it is driven along the path; *road* 1: the stations of the road increase along the path.
    """

    start: float
    id: int
    number: int
    sense: int
    road: int


@dataclass(frozen=True, slots=True)
class Stretch:
    """A road on a path: its station s is the path's *base* + *sense* s; the path has it from *start* to *end*."""

    road: str
    base: float
    sense: int
    start: float
    end: float


@dataclass(frozen=True, eq=False, slots=True)
class ScenarioPath:
    """A path with the roads and lanes that it passes."""

    way: Way
    path: RoadPath
    stretches: tuple[Stretch, ...]
    rows: tuple[LaneRow, ...]

    def stretch(self, road: str, s: float) -> Stretch | None:
        """The part of the path that has station *s* of a road, or else any part on the road."""
        found = [each for each in self.stretches if each.road == road]
        inside = [each for each in found if each.start - 1e-6 <= each.base + each.sense * s <= each.end + 1e-6]
        return next(iter(inside or found), None)


class Paths:
    """All paths of a scenario through a *network*; each is made once."""

    def __init__(self, network: Network) -> None:
        self.network = network
        self.made: list[ScenarioPath] = []
        self._graph: LaneGraph = lane_graph(network)
        self._onward = Onward(self._graph)
        self._ways: dict[Way, int] = {}
        self._before: dict[LanePlace, list[LanePlace]] | None = None

    def road(self, id_: str, where: Location) -> Road:
        """A road of the network. Raises DseError located at *where* if there is none."""
        if id_ not in self.network.roads:
            raise fail(f"there is no road '{id_}' in the road network", where)
        return self.network.roads[id_]

    def through(self, road: str, lane: int, s: float, where: Location) -> int:
        """The number of a path along the lane at *s* of a road, or the nearest lane that vehicles drive there."""
        self.road(road, where)
        place = self._place(road, lane, s)
        return self._number(self._with_upstream(place, straight_on(self._onward, place)), where)

    def along_route(self, roads: Sequence[str], lane: int, where: Location) -> int:
        """The number of a path along *roads*, which may leave out those between, and then straight on."""
        full = [roads[0]]
        for one, other in pairwise(roads):
            full += self._between(one, other, where)
        # A way that starts in the lane, or else in one beside it.
        for start in (lane, 0):
            try:
                way = way_of(self._graph, Route(tuple(full), start, "route", where))
            except DseError:
                if start == 0:
                    raise
                continue
            places = [*_places(way)]
            rest = straight_on(self._onward, places[-1])
            following = [*_places(rest)][1:]
            seen = set(places)
            whole = way_in(self._graph, (*places, *(place for place in following if place not in seen)))
            return self._number(self._with_upstream(places[0], whole), where)
        raise fail("the route leads nowhere", where)

    def branches(self) -> list[Branch]:
        """Where lanes beside the paths lead elsewhere: exits, and turns of a crossing; with the paths made for them."""
        found: list[Branch] = []
        for number in itertools.count():
            if number >= len(self.made):
                return found
            way = next(way for way, made in self._ways.items() if made == number)
            ends = [
                (place, stretch.base + stretch.sense * self._end(place))
                for passage, stretch in zip(way.passages, self.made[number].stretches, strict=True)
                for place in passage
            ]
            following: list[LanePlace | None] = [place for place, _ in ends[1:]]
            for (place, station), after in zip(ends, [*following, None], strict=True):
                numbers = {(after.road, row.id): row.number for row in self._beside(after)} if after else {}
                for row in self._beside(place):
                    here = LanePlace(place.road, place.section, row.id)
                    leads = self._onward.from_(here) if row.number != 0 and row.sense > 0 else ()
                    goes_on = any(numbers.get((p.road, p.lane)) == row.number for p in leads)
                    if not leads or goes_on or lane_at(self.network, here).type != "driving":
                        continue
                    if len(self.made) >= _MOST_PATHS:
                        return found
                    section = self.network.roads[here.road].sections[here.section]
                    where = self.network.roads[here.road].where
                    to = self.through(here.road, here.lane, (section.s + section.end) / 2, where)
                    found.append(Branch(number, station, row.number, to))
        return found

    def _beside(self, place: LanePlace) -> Iterator[LaneRow]:
        road = self.network.roads[place.road]
        along = self._along(place)
        return _rows(road, place, road.sections[place.section], 0.0, along=along)

    def _end(self, place: LanePlace) -> float:
        """The station of its road at which a place is left."""
        road = self.network.roads[place.road]
        section = road.sections[place.section]
        return section.end if self._along(place) else section.s

    def nearest(self, x: float, y: float, z: float | None = None) -> tuple[str, int, float, float] | None:
        """The road, lane, station and distance to that lane's middle of the lane that is nearest to a point, in m.

        With *z*, roads on its level go before all others.
        """
        best: tuple[float, str, int, float, float] | None = None
        for road in self.network.roads.values():
            s, t, off = _foot(road, x, y)
            if best is not None and off > best[0] + 60.0 and best[0] < _OTHER_LEVEL:
                continue
            section = _section_at(road, s)
            if z is not None and not on_one_level(z - height_at(road, s, t)):
                off += _OTHER_LEVEL
            for id_, (right, left) in borders_of(road, section).items():
                u = s - section.s
                low, high = float(value(right, np.array(u))), float(value(left, np.array(u)))
                outside = max(low - t, t - high, 0.0) + 1e-3 * abs(t - (low + high) / 2) + off
                if high - low > 0.1 and (best is None or outside < best[0]):
                    best = outside, road.id, id_, s, t - (low + high) / 2
        return None if best is None else best[1:]

    def _number(self, way: Way, where: Location) -> int:
        if way not in self._ways and (known := self._parallel(way)) is not None:
            self._ways[way] = known
        if way not in self._ways:
            try:
                self.made.append(_scenario_path(self._graph, way))
            except DseError as error:
                raise fail(f"the path of a road user: {error.problems[0]}", where) from error
            self._ways[way] = len(self.made) - 1
        return self._ways[way]

    def _parallel(self, way: Way) -> int | None:
        """The number of a path that was made and is as far aside all along: its lanes do for *way*, too."""
        for number, made in enumerate(self.made):
            pairs = [*zip(_places(way), _places(made.way), strict=False)]
            same = all((a.road, a.section) == (b.road, b.section) for a, b in pairs)
            if not same or [len(p) for p in way.passages] != [len(p) for p in made.way.passages]:
                continue
            apart = {(self._index(a) - self._index(b), self._along(a) == self._along(b)) for a, b in pairs}
            if len(apart) == 1 and next(iter(apart))[1] and way.closed == made.way.closed:
                return number
        return None

    def _index(self, place: LanePlace) -> int:
        """How many lanes are to its right, from left to right along the path."""
        ids = sorted(id_ for id_ in self.network.roads[place.road].sections[place.section].lanes if id_ != 0)
        return ids.index(place.lane) * (1 if self._along(place) else -1)

    def _along(self, place: LanePlace) -> bool:
        return runs_along(self.network.roads[place.road], lane_at(self.network, place))

    def _place(self, road: str, lane: int, s: float) -> LanePlace:
        """The lane there, or the nearest one of its side that leads somewhere."""
        network = self.network
        sections = network.roads[road].sections
        number = next((i for i, each in enumerate(sections) if s < each.end), len(sections) - 1)
        lanes = sections[number].lanes
        ids = [id_ for id_ in lanes if id_ != 0] or [0]
        same = [id_ for id_ in ids if (id_ > 0) == (lane > 0)] or ids
        driven = [id_ for id_ in same if lanes[id_].type == "driving"] or same
        best = min(driven if lane not in driven else [lane], key=lambda id_: abs(id_ - lane))
        return LanePlace(road, number, best)

    def _with_upstream(self, place: LanePlace, way: Way) -> Way:
        """*way*, which starts at *place*, with what leads straight to it."""
        if way.closed:
            return way
        if self._before is None:
            self._before = {}
            for each in _all_places(self.network):
                for after in self._onward.from_(each):
                    self._before.setdefault(after, []).append(each)
        places = [*_places(way)]
        seen, length, first = set(places), 0.0, place
        while length < _UPSTREAM or first.road == place.road:
            before = [p for p in self._before.get(first, ()) if p not in seen]
            if not before:
                break
            straight = [p for p in before if self._onward.from_(p)[0] == first] or before
            first = straight[0]
            seen.add(first)
            places.insert(0, first)
            section = self.network.roads[first.road].sections[first.section]
            length += section.end - section.s
        # Roads are passed from end to end: one that is entered in its middle is left out.
        while (first := places[0]).road != place.road and not self._begins(first):
            places.pop(0)
        return way_in(self._graph, tuple(places))

    def _begins(self, place: LanePlace) -> bool:
        road = self.network.roads[place.road]
        return place.section == (0 if self._along(place) else len(road.sections) - 1)

    def _between(self, one: str, other: str, where: Location) -> list[str]:
        """The roads after *one* on the shortest way to *other*, which is the last of them."""
        if one == other:
            return []
        successors: dict[str, set[str]] = {}
        for place in _all_places(self.network):
            for after in next_places(self._graph, place):
                if after.road != place.road:
                    successors.setdefault(place.road, set()).add(after.road)
        lengths = {one: 0.0}
        came: dict[str, str] = {}
        left = {one}
        while left:
            here = min(left, key=lambda id_: (lengths[id_], id_))
            left.remove(here)
            if here == other:
                found = [here]
                while came[found[0]] != one:
                    found.insert(0, came[found[0]])
                return found
            for there in sorted(successors.get(here, ())):
                length = lengths[here] + self.network.roads[there].length
                if length < lengths.get(there, math.inf):
                    lengths[there], came[there] = length, here
                    left.add(there)
        raise fail(f"no way leads from road '{one}' to road '{other}'", where)


@dataclass(frozen=True, slots=True)
class Branch:
    """Where *path* ends a road at *station*, its lane *lane* does not go on beside it, but in the path *to*."""

    path: int
    station: float
    lane: int
    to: int


def _places(way: Way) -> Iterator[LanePlace]:
    return (place for passage in way.passages for place in passage)


def _all_places(network: Network) -> Iterator[LanePlace]:
    for road in network.roads.values():
        for number, section in enumerate(road.sections):
            yield from (LanePlace(road.id, number, id_) for id_ in section.lanes if id_ != 0)


def _scenario_path(graph: LaneGraph, way: Way) -> ScenarioPath:
    path = path_along(graph, way, "path", every_lane=True)
    stretches: list[Stretch] = []
    rows: list[LaneRow] = []
    begin = 0.0
    for passage in way.passages:
        road = graph.network.roads[passage[0].road]
        along = runs_along(road, lane_at(graph.network, passage[0]))
        sections = [road.sections[place.section] for place in passage]
        start, end = min(each.s for each in sections), max(each.end for each in sections)
        start = start if min(place.section for place in passage) else 0.0
        base = begin - start if along else begin + end
        stretches.append(Stretch(road.id, base, 1 if along else -1, begin, begin + end - start))
        for place, section in zip(passage, sections, strict=True):
            at = base + section.s if along else base - section.end
            rows += _rows(road, place, section, max(at, begin), along=along)
        begin += end - start
    return ScenarioPath(way, path, tuple(stretches), tuple(rows))


def _rows(road: Road, place: LanePlace, section: Section, start: float, *, along: bool) -> Iterator[LaneRow]:
    ids = sorted(id_ for id_ in section.lanes if id_ != 0)
    own = ids.index(place.lane)
    for i, id_ in enumerate(ids):
        sense = 1 if runs_along(road, section.lanes[id_]) == along else -1
        yield LaneRow(start, id_, (i - own) if along else (own - i), sense, 1 if along else -1)


def _section_at(road: Road, s: float) -> Section:
    return next((each for each in road.sections if s < each.end), road.sections[-1])


def height_at(road: Road, s: float, t: float) -> float:
    """The height of a road, in m, at its station *s* and *t* m to the left of its reference line."""
    height, bank = (
        float(value(from_cubics(cubics, 0.0, road.length), np.array([s]))[0]) if cubics else 0.0
        for cubics in (road.elevation, road.superelevation)
    )
    return height + t * math.tan(bank)


def _foot(road: Road, x: float, y: float) -> tuple[float, float, float]:
    """Station and t of the point of a road's reference line that is nearest, and how far off its ends it is, in m."""
    best = (math.inf, 0.0, 0.0, 0.0)
    for piece in road.geometries:
        count = max(2, min(2000, math.ceil(piece.length) + 1))
        u = np.linspace(0.0, piece.length, count)
        frames = curve_of(piece).at(u)
        px, py = piece.x + frames.x, piece.y + frames.y
        heading = frames.heading
        i = int(np.argmin(np.hypot(px - x, py - y)))
        dx, dy = x - float(px[i]), y - float(py[i])
        c, s = math.cos(float(heading[i])), math.sin(float(heading[i]))
        ahead, aside = dx * c + dy * s, dy * c - dx * s
        inside = min(max(float(u[i]) + ahead, 0.0), piece.length)
        off = abs(float(u[i]) + ahead - inside)
        distance = math.hypot(dx, dy)
        if distance < best[0]:
            best = distance, piece.s + inside, aside, off
    return best[1], best[2], best[3]
