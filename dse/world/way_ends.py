"""What a user should know of the ways along routes: what is ignored there, and where they end in the network."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from dse.errors import Problem, some_of
from dse.formats import shortened
from dse.world.lane_graph import LaneGraph, lane_at, lane_graph, next_places
from dse.world.opendrive.driving import lanes_at, runs_along
from dse.world.opendrive.structure import End, Network
from dse.world.routes import Route, way_of
from dse.world.ways import Way


def route_notes(network: Network, routes: Iterable[Route]) -> Iterator[Problem]:
    """What the roads along *routes* have that is ignored, and why ways end where their roads meet something.

    Raises DseError located at a route along which there is no way.
    """
    graph = lane_graph(network)
    for route in routes:
        way = way_of(graph, route)
        for road in dict.fromkeys(way.roads):
            yield from network.roads[road].ignored
        end = way_end(graph, way)
        if end is not None:
            yield end


def way_end(graph: LaneGraph, way: Way) -> Problem | None:
    """Why *way* ends where its road meets something; None where the network ends, or the way closes.

    It may also be the user's wish to end there: then lanes go on, and none of this is a fault.
    """
    last = way.passages[-1][-1]
    if way.closed or next_places(graph, last):
        return None
    road = graph.network.roads[last.road]
    along = runs_along(road, lane_at(graph.network, last))
    end = End.END if along else End.START
    is_at_end = last.section == (len(road.sections) - 1 if along else 0)
    link = road.links.get(end)
    named = f"road '{shortened(road.id)}'"
    if not is_at_end:
        what = f"the way ends inside {named}: its lane {last.lane} ends there"
        return Problem(what, lane_at(graph.network, last).where)
    if link is None:
        where = f"in junction '{shortened(road.junction)}'" if road.junction else ""
        what = f"the way ends {where}, at the end of {named}: it names no road that follows"
        return Problem(what, road.where) if where else None
    if link.element == "junction":
        what = (
            f"the way ends at junction '{shortened(link.id)}': no connection leads on from lane {last.lane} of {named}"
        )
        return Problem(what, link.where)
    where = f"in junction '{shortened(road.junction)}'" if road.junction else "at the end of its road"
    tag = "successor" if along else "predecessor"
    what = f"the way ends {where}: lane {last.lane} of {named} names no <{tag}> in road '{shortened(link.id)}'"
    others = [str(id_) for id_ in lanes_at(graph.network.roads[link.id], link.contact)]
    return Problem(what, lane_at(graph.network, last).where, f"lanes there: {some_of(others)}")
