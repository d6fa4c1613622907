"""Which lane goes on in which, in the direction that it is driven."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from dse.world.opendrive.driving import ends_at, lanes_at, runs_along
from dse.world.opendrive.structure import Connection, End, Junction, Lane, Network, Road

LaneEnd = tuple[str, End, int]
"""A road, one of its ends, and a lane there."""


@dataclass(frozen=True, slots=True, order=True)
class LanePlace:
    """A lane in the section of that number of a road."""

    road: str
    section: int
    lane: int


@dataclass(frozen=True, eq=False, slots=True)
class LaneGraph:
    """A network and which ends of lanes meet; what a road says of its own end comes first."""

    network: Network
    meets: Mapping[LaneEnd, tuple[LaneEnd, ...]]


def lane_graph(network: Network) -> LaneGraph:
    """The graph of a network's lanes."""
    found: dict[LaneEnd, dict[LaneEnd, None]] = {}
    said = list(_declared_links(network))
    backwards = [(there, here) for here, there in said if _may_be_answered(network, there)]
    for here, there in said + backwards:
        found.setdefault(here, {})[there] = None
    return LaneGraph(network, {here: tuple(there) for here, there in found.items()})


def lane_at(network: Network, place: LanePlace) -> Lane:
    """The lane at a place."""
    return network.roads[place.road].sections[place.section].lanes[place.lane]


def entries(network: Network) -> Iterator[LanePlace]:
    """All lanes for cars where they begin at an end of a road, as they are driven; along its stations first."""
    for road in network.roads.values():
        last = len(road.sections) - 1
        for section, along in ((0, True), (last, False)):
            lanes = road.sections[section].lanes.values()
            fit = [lane for lane in lanes if "car" in lane.users and runs_along(road, lane) == along]
            # The outermost is for those who do not overtake.
            for lane in sorted(fit, key=lambda lane: (lane.type != "driving", -abs(lane.id), lane.id)):
                yield LanePlace(road.id, section, lane.id)


def next_places(graph: LaneGraph, place: LanePlace) -> tuple[LanePlace, ...]:
    """Where a lane goes on: in the next section of its road, or in other roads; nowhere if it ends."""
    road = graph.network.roads[place.road]
    along = runs_along(road, lane_at(graph.network, place))
    section = place.section + (1 if along else -1)
    if 0 <= section < len(road.sections):
        return tuple(LanePlace(road.id, section, lane) for lane in _inside(road, place, section, along=along))
    ends = graph.meets.get((road.id, End.END if along else End.START, place.lane), ())
    return tuple(next_ for there in ends for next_ in _entered(graph.network, there))


def _inside(road: Road, place: LanePlace, next_: int, *, along: bool) -> Iterator[int]:
    here, there = road.sections[place.section], road.sections[next_]
    later = there if along else here
    if later.left_goes_on if place.lane > 0 else later.right_goes_on:
        yield place.lane
        return
    lane = here.lanes[place.lane]
    linked = lane.successors if along else lane.predecessors
    # A link may be said by one of the two only.
    back = (o.id for o in there.lanes.values() if place.lane in (o.predecessors if along else o.successors))
    for id_ in dict.fromkeys((*linked, *back)):
        if id_ in there.lanes and runs_along(road, there.lanes[id_]) == along:
            yield id_


def _entered(network: Network, there: LaneEnd) -> Iterator[LanePlace]:
    """The lane at an end of a road, if it is driven away from there."""
    road = network.roads[there[0]]
    section = 0 if there[1] is End.START else len(road.sections) - 1
    lane = road.sections[section].lanes.get(there[2])
    if lane is not None and runs_along(road, lane) == (there[1] is End.START):
        yield LanePlace(road.id, section, lane.id)


def _may_be_answered(network: Network, there: LaneEnd) -> bool:
    """Whether the road there leaves it to others what it meets: a junction says by itself who goes where."""
    link = network.roads[there[0]].links.get(there[1])
    return link is None or link.element != "junction" or network.junctions[link.id].kind == "direct"


def _declared_links(network: Network) -> Iterator[tuple[LaneEnd, LaneEnd]]:
    for road in network.roads.values():
        for end, link in road.links.items():
            if link.element == "road":
                for lane in lanes_at(road, end).values():
                    for id_ in lane.predecessors if end is End.START else lane.successors:
                        yield (road.id, end, lane.id), (link.id, link.contact, id_)
    for junction in network.junctions.values():
        for connection in junction.connections:
            yield from _connected(network, junction, connection)


def _connected(network: Network, junction: Junction, connection: Connection) -> Iterator[tuple[LaneEnd, LaneEnd]]:
    there = lanes_at(network.roads[connection.road], connection.contact)
    for end in ends_at(network, junction, connection):
        here = lanes_at(network.roads[connection.incoming], end)
        # Without links, lanes of the same number go on in each other (OpenDRIVE, junctions).
        for one, other in connection.links or [(id_, id_) for id_ in here if id_ in there]:
            yield (connection.incoming, end, one), (connection.road, connection.contact, other)
