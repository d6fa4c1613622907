"""Ways through a network: the one that a route names, the longest straight on, and all there are."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import islice

from dse.errors import DseError, Location, closest, fail, some_of
from dse.formats import shortened
from dse.world.lane_graph import LaneGraph, LanePlace, entries, next_places
from dse.world.opendrive.driving import runs_along
from dse.world.opendrive.structure import Network
from dse.world.ways import MOST_PLACES, Onward, Way, leaves, reaches_an_end, straight_on, way_in, way_length


@dataclass(frozen=True, slots=True)
class Route:
    """What a user says of a path: ids of *roads* in order and its first lane.

    Without roads it is the way that the network was made for, if it says one, and else the longest straight on.

    *lane* is an id in the first road; 0: the outermost from which the route can be driven. *where* the route stands.
    """

    roads: tuple[str, ...] = ()
    lane: int = 0
    name: str = "path"
    where: Location | None = None


def way_of(graph: LaneGraph, route: Route) -> Way:
    """The way that a route means. Raises DseError located at the route where there is none."""
    network = graph.network
    for id_ in route.roads:
        if id_ not in network.roads:
            raise fail(
                f"there is no road '{shortened(id_)}' in the file",
                route.where or network.where,
                closest(id_, network.roads),
            )
    if not route.roads:
        return _made_for(graph, route) or _longest(graph, route)
    search, starts = _Search(graph, route), list(_starts(network, route))
    found = search.way(starts)
    if found is None:
        raise search.failed(starts)
    return found


def _made_for(graph: LaneGraph, route: Route) -> Way | None:
    """The way that the network says it was made for, if it says one and the lane leads along it."""
    roads = graph.network.route
    if not all(id_ in graph.network.roads for id_ in roads):
        return None
    starts = [p for p in entries(graph.network) if p.road in roads[:1] and route.lane in {0, p.lane}]
    return _Search(graph, replace(route, roads=roads)).way(starts)


def _longest(graph: LaneGraph, route: Route) -> Way:
    """The longest way straight on; the first of those that are as long to a mm."""
    onward = Onward(graph)
    ways = [_rounded(onward, straight_on(onward, start), route) for start in _starts(graph.network, route)]
    lengths = [round(way_length(graph.network, way), 3) for way in ways]
    return ways[lengths.index(max(lengths))]


def _rounded(onward: Onward, way: Way, route: Route) -> Way:
    """The closed way from where *way* comes back to its first road, in another lane than it began in; else *way*."""
    first = way.passages[0][0]
    again = next((passage[0] for passage in way.passages[1:] if passage[0].road == first.road), None)
    if way.closed or again is None or route.lane not in {0, again.lane}:
        return way
    closed = straight_on(onward, again)
    return closed if closed.closed else way


def list_ways(graph: LaneGraph, most: int = 200) -> tuple[Way, ...]:
    """Ways through the network that use no road twice, from where roads begin to where lanes end or close: *most*.

    Those of a start are together, the straightest first. A network without a beginning is entered everywhere.
    """
    return tuple(islice(_all_ways(graph), most))


def _all_ways(graph: LaneGraph) -> Iterator[Way]:
    listed = list(entries(graph.network))
    reached = {next_ for place in listed for end in _ends(graph, place) for next_ in next_places(graph, end)}
    onward = Onward(graph)
    starts = [place for place in listed if place not in reached] or listed
    # A way that comes back to its road in another lane than it began in: that lane's may close.
    returns: dict[LanePlace, None] = {}
    for start in starts:
        for way in _ways_from(onward, start):
            yield way
            if not way.closed:
                after = onward.from_(way.passages[-1][-1])
                returns.update((next_, None) for next_ in after if next_.road == start.road and next_ not in starts)
    for start in returns:
        yield from (way for way in _ways_from(onward, start) if way.closed)


def _ways_from(onward: Onward, start: LanePlace) -> Iterator[Way]:
    """Depth first, without recursion: ways are longer than Python's stack."""
    stack: list[tuple[LanePlace, ...]] = [(start,)]
    while stack:
        places = stack.pop()
        used = {place.road for place in places}
        following = onward.from_(places[-1])
        fresh = [n for n in following if n.road not in used or (n.road == places[-1].road and n not in places)]
        if start in following or not fresh or len(places) >= MOST_PLACES:
            yield way_in(onward.graph, places, start in following)
        else:
            stack += [(*places, next_) for next_ in reversed(fresh)]


def _ends(graph: LaneGraph, start: LanePlace) -> Iterator[LanePlace]:
    """Where the lane that begins there leaves its road."""
    seen, stack = {start}, [start]
    while stack:
        place = stack.pop()
        inside = [n for n in next_places(graph, place) if n.road == place.road and n not in seen]
        if not inside:
            yield place
        seen.update(inside)
        stack += inside


def _starts(network: Network, route: Route) -> Iterator[LanePlace]:
    listed = list(entries(network))
    if not route.roads:
        fit = [p for p in listed if not network.roads[p.road].junction and route.lane in {0, p.lane}]
        fit = fit or [p for p in listed if route.lane in {0, p.lane}]
        if not fit:
            what = f"no road begins with a lane {route.lane} for vehicles" if route.lane else "no lane is for vehicles"
            raise fail(what, route.where or network.where)
        yield from fit
        return
    road = network.roads[route.roads[0]]
    if not route.lane:
        fit = [place for place in listed if place.road == road.id]
        if not fit:
            raise fail(f"no lane of road '{road.id}' is for vehicles", route.where or road.where, "name a 'lane'")
        yield from fit
        return
    for section, along in ((0, True), (len(road.sections) - 1, False)):
        lanes = road.sections[section].lanes
        if route.lane in lanes and runs_along(road, lanes[route.lane]) == along:
            yield LanePlace(road.id, section, route.lane)
            return
    ids = [str(place.lane) for place in listed if place.road == road.id]
    what = f"road '{shortened(road.id)}' does not begin with a lane {route.lane}"
    raise fail(what, route.where or road.where, f"lanes for vehicles: {some_of(ids)}")


class _Search:
    """Looks for the lanes along a route, and remembers the farthest road that it came to."""

    def __init__(self, graph: LaneGraph, route: Route) -> None:
        self._graph, self._route = graph, route
        self._farthest = 0

    def from_(self, start: LanePlace) -> tuple[LanePlace, ...]:
        """The lanes from *start* to the end of the last road, back to *start* if they can; none if there is no way."""
        roads = self._route.roads
        open_way: tuple[LanePlace, ...] = ()
        tried: set[tuple[LanePlace, int]] = set()
        stack: list[tuple[tuple[LanePlace, ...], int]] = [((start,), 0)]
        while stack:
            places, step = stack.pop()
            self._farthest = max(self._farthest, step)
            if (places[-1], step) in tried:
                continue
            tried.add((places[-1], step))
            following = next_places(self._graph, places[-1])
            inside = [n for n in following if not self._leaves(places[-1], n)]
            if step == len(roads) - 1 and not inside:
                if start in following:
                    return places
                open_way = open_way or places
                continue
            onward = [(n, step) for n in inside]
            if step + 1 < len(roads):
                left = [n for n in following if n.road == roads[step + 1] and self._leaves(places[-1], n)]
                onward += [(n, step + 1) for n in left]
            stack += [((*places, next_), at) for next_, at in reversed(onward)]
        return open_way

    def way(self, starts: list[LanePlace]) -> Way | None:
        """The way from the first of *starts* that closes, else leads to the end; lanes that end are the last choice."""
        graph = self._graph
        found = [places for start in starts if (places := self.from_(start))]
        if not found:
            return None
        closed = next((places for places in found if places[0] in next_places(graph, places[-1])), None)
        ending = next((places for places in found if reaches_an_end(graph.network, places[-1])), found[0])
        return way_in(graph, closed or ending, closed is not None)

    def failed(self, starts: list[LanePlace]) -> DseError:
        """What to say if nothing was found."""
        roads, network = self._route.roads, self._graph.network
        here, there = roads[self._farthest], roads[min(self._farthest + 1, len(roads) - 1)]
        ends = [end for place in entries(network) if place.road == here for end in _ends(self._graph, place)]
        following = {end: next_places(self._graph, end) for end in ends}
        lanes = sorted({str(end.lane) for end, after in following.items() if any(p.road == there for p in after)})
        others = list(dict.fromkeys(p.road for after in following.values() for p in after if p.road != here))
        if lanes:
            hint = f"only these lanes of road '{here}' do: {some_of(lanes)}"
        else:
            hint = f"it leads to {some_of(others)}" if others else f"road '{here}' leads nowhere"
        lane = f" in lane {starts[0].lane}" if self._route.lane else ""
        what = f"the route cannot go from road '{here}' to road '{there}': begun{lane}, no link of a lane leads there"
        return fail(what, self._route.where or network.roads[here].where, hint)

    def _leaves(self, place: LanePlace, next_: LanePlace) -> bool:
        return leaves(self._graph.network, place, next_)
