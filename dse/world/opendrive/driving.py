"""Who drives where: lanes at the ends of roads, and the direction they are driven in."""

from __future__ import annotations

from collections.abc import Mapping

from dse.world.opendrive.structure import Connection, End, Junction, Lane, Network, Road

DRIVEN = frozenset(
    {
        *("driving", "entry", "exit", "onRamp", "offRamp", "connectingRamp", "slipLane", "mwyEntry", "mwyExit"),
        *("bidirectional", "bus", "taxi", "HOV", "stop", "parking", "biking", "roadWorks"),
        *("special1", "special2", "special3"),
    }
)
"""Types of lanes that count as lanes of a path; shoulders, borders, pavements and the like are beside the road."""


def runs_along(road: Road, lane: Lane) -> bool:
    """Whether the lane is driven in the direction of its road's stations."""
    return (lane.id < 0) != (road.left_hand != lane.reversed_)


def leaves_at(road: Road, lane: Lane, end: End) -> bool:
    """Whether one who drives in the lane leaves its road at *end*."""
    return runs_along(road, lane) == (end is End.END)


def ends_at(network: Network, junction: Junction, connection: Connection) -> list[End]:
    """The ends of the incoming road at which a connection of a junction begins; two for a road from it to itself."""
    incoming, road = network.roads[connection.incoming], network.roads[connection.road]
    back = road.links.get(connection.contact)
    if back is not None and back.element == "road" and back.id == incoming.id:
        return [back.contact]
    return [e for e, link in incoming.links.items() if link.element == "junction" and link.id == junction.id]


def lanes_at(road: Road, end: End) -> Mapping[int, Lane]:
    """The lanes at an end of a road."""
    return road.sections[0 if end is End.START else -1].lanes
