"""Ways along lanes that go on in each other, and the one that goes straight on."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from dse.world.lane_graph import LaneGraph, LanePlace, lane_at, next_places
from dse.world.opendrive.curves import curve_of
from dse.world.opendrive.driving import runs_along
from dse.world.opendrive.structure import Network, Road

_LOOK = 50.0
"""How far one looks along a road, in m, to see which goes on straight."""
MOST_PLACES = 10_000
"""Of a way."""


@dataclass(frozen=True, slots=True)
class Way:
    """Lanes that go on in each other, by the roads they pass; *closed*: the last goes on in the first.

    Roads are passed from end to end, but the last may be left where its lane ends.
    """

    passages: tuple[tuple[LanePlace, ...], ...]
    closed: bool

    @property
    def roads(self) -> tuple[str, ...]:
        """The ids of its roads, in order: with its first lane, a route that leads there."""
        return tuple(passage[0].road for passage in self.passages)

    @property
    def lane(self) -> int:
        """The lane it begins in."""
        return self.passages[0][0].lane


def way_length(network: Network, way: Way) -> float:
    """How long a way is, in m along the reference lines of its roads."""
    sections = [network.roads[place.road].sections[place.section] for passage in way.passages for place in passage]
    return sum(section.end - section.s for section in sections)


def straight_on(onward: Onward, start: LanePlace) -> Way:
    """The way straight on from *start* until a lane ends or one comes back."""
    places = [start]
    seen = {start}
    while len(places) < MOST_PLACES:
        following = onward.from_(places[-1])
        fresh = next((place for place in following if place not in seen), None)
        if start in following or fresh is None:
            return way_in(onward.graph, tuple(places), start in following)
        places.append(fresh)
        seen.add(fresh)
    return way_in(onward.graph, tuple(places), False)


class Onward:
    """Where lanes for cars go on, the straightest first; remembers what it has been asked."""

    def __init__(self, graph: LaneGraph) -> None:
        self.graph = graph
        self._known: dict[LanePlace, tuple[LanePlace, ...]] = {}
        self._turnings: dict[LanePlace, float] = {}

    def from_(self, place: LanePlace) -> tuple[LanePlace, ...]:
        """The next lanes; those in the same road, which need no turning, in the order of the file."""
        if place not in self._known:
            lanes = self.graph.network
            following = tuple(p for p in next_places(self.graph, place) if "car" in lane_at(lanes, p).users)
            several = len({next_.road for next_ in following}) > 1
            self._known[place] = tuple(sorted(following, key=self._turning)) if several else following
        return self._known[place]

    def _turning(self, place: LanePlace) -> float:
        """How far one turns in a connecting road, or at the beginning of any other, in rad."""
        if place not in self._turnings:
            network = self.graph.network
            road = network.roads[place.road]
            length = road.length if road.junction else min(road.length, _LOOK)
            along = runs_along(road, lane_at(network, place))
            a, b = (0.0, length) if along else (road.length, road.length - length)
            turning = math.remainder(heading_at(road, b) - heading_at(road, a), math.tau)
            self._turnings[place] = round(abs(turning), 6)
        return self._turnings[place]


def leaves(network: Network, place: LanePlace, next_: LanePlace) -> bool:
    """Whether the step leads out of a road, be it into the same again."""
    if place.road != next_.road:
        return True
    road = network.roads[place.road]
    step = 1 if runs_along(road, lane_at(network, place)) else -1
    return next_.section != place.section + step


def reaches_an_end(network: Network, place: LanePlace) -> bool:
    """Whether a lane is there to the end of its road."""
    road = network.roads[place.road]
    return place.section == (len(road.sections) - 1 if runs_along(road, lane_at(network, place)) else 0)


def way_in(graph: LaneGraph, places: tuple[LanePlace, ...], closed: bool = False) -> Way:
    """The way along *places*, by the roads that they are in."""
    passages = [[places[0]]]
    for one, other in pairwise(places):
        if leaves(graph.network, one, other):
            passages.append([])
        passages[-1].append(other)
    return Way(tuple(map(tuple, passages)), closed)


def heading_at(road: Road, s: float) -> float:
    """The heading of a road's reference line, in rad."""
    piece = max((g for g in road.geometries if g.s <= s), key=lambda g: g.s, default=road.geometries[0])
    return float(curve_of(piece).at(np.array([s - piece.s])).heading[0])
