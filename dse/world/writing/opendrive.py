"""A network as OpenDRIVE 1.7 text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from xml.sax.saxutils import quoteattr

from dse.domain.road import Road
from dse.world.opendrive.reading import ROUTE
from dse.world.opendrive.roadside import PHASES, SHIFT
from dse.world.writing.layout import network_of
from dse.world.writing.network import (
    CubicRecord,
    JunctionRecord,
    LaneRecord,
    LaneSection,
    LightGroup,
    Link,
    NetworkRecord,
    PatchRecord,
    RoadRecord,
    SignalRecord,
)
from dse.world.writing.pieces import Piece

_LIGHT = "1000001"
"""The type of a traffic light with three colours in OpenDRIVE's own catalogue."""


def opendrive_of(road: Road) -> str:
    """*road* as OpenDRIVE. Raises DseError if it is closed and its ends do not meet."""
    return "\n".join(['<?xml version="1.0" encoding="UTF-8"?>', *_file(network_of(road))]) + "\n"


Lines = Iterator[str]
Attributes = Mapping[str, str | int | float]


def _tag(name: str, attributes: Attributes, level: int, inner: Iterator[str] | None = None) -> Lines:
    said = "".join(f" {key}={quoteattr(_text(value))}" for key, value in attributes.items())
    head = f"{'  ' * level}<{name}{said}"
    if inner is None:
        yield f"{head}/>"
        return
    yield f"{head}>"
    yield from inner
    yield f"{'  ' * level}</{name}>"


def _text(value: str | float) -> str:
    return value if isinstance(value, str) else repr(value)


def _file(network: NetworkRecord) -> Lines:
    def inner() -> Lines:
        yield from _tag("header", {"revMajor": 1, "revMinor": 7, "name": network.name, "version": "1.00"}, 1)
        for road in network.roads:
            yield from _road(road)
        for junction in network.junctions:
            for number, group in enumerate(junction.lights):
                yield from _controller(junction, number, group)
        for junction in network.junctions:
            yield from _junction(junction)
        if network.route:
            yield from _tag("userData", {"code": ROUTE, "value": " ".join(map(str, network.route))}, 1)

    return _tag("OpenDRIVE", {}, 0, inner())


def _road(road: RoadRecord) -> Lines:
    def inner() -> Lines:
        links = [("predecessor", road.before), ("successor", road.behind)]
        known = [(name, link) for name, link in links if link is not None]
        if known:
            yield from _tag("link", {}, 2, (line for name, link in known for line in _link(name, link)))
        for station, limit in road.speeds:
            speed = _tag("speed", {"max": limit, "unit": "m/s"}, 3) if limit else None
            yield from _tag("type", {"s": station, "type": "unknown"}, 2, speed)
        yield from _tag("planView", {}, 2, _plan(road.pieces))
        yield from _tag("elevationProfile", {}, 2, _cubics("elevation", "s", road.heights, 3))
        yield from _tag("lateralProfile", {}, 2, _cubics("superelevation", "s", road.banks, 3) if road.banks else None)
        yield from _tag("lanes", {}, 2, _lanes(road))
        if road.patches:
            objects = (line for number, patch in enumerate(road.patches) for line in _patch(road, number, patch))
            yield from _tag("objects", {}, 2, objects)
        if road.signals:
            yield from _tag("signals", {}, 2, (line for signal in road.signals for line in _signal(signal)))

    head: Attributes = {
        "name": road.name,
        "length": road.length,
        "id": road.id,
        "junction": road.within or -1,
        "rule": "RHT",
    }
    return _tag("road", head, 1, inner())


def _link(name: str, link: Link) -> Lines:
    if not link.contact:
        return _tag(name, {"elementType": "junction", "elementId": link.id}, 3)
    return _tag(name, {"elementType": "road", "elementId": link.id, "contactPoint": link.contact}, 3)


def _plan(pieces: tuple[Piece, ...]) -> Lines:
    station = 0.0
    for piece in pieces:
        start, bend = piece.start, piece.bend
        head: Attributes = {"s": station, "x": start.x, "y": start.y, "hdg": start.heading, "length": bend.length}
        if bend.first != bend.last:
            shape = _tag("spiral", {"curvStart": bend.first, "curvEnd": bend.last}, 4)
        elif bend.first:
            shape = _tag("arc", {"curvature": bend.first}, 4)
        else:
            shape = _tag("line", {}, 4)
        yield from _tag("geometry", head, 3, shape)
        station += bend.length


def _cubics(name: str, along: str, cubics: tuple[CubicRecord, ...], level: int) -> Lines:
    for cubic in cubics:
        factors = {"a": cubic.a, "b": cubic.b, "c": cubic.c, "d": cubic.d}
        yield from _tag(name, {along: cubic.start, **factors}, level)


def _lanes(road: RoadRecord) -> Lines:
    if road.offset is not None:
        yield from _cubics("laneOffset", "s", (road.offset,), 3)
    for section in road.sections:
        yield from _tag("laneSection", {"s": section.start}, 3, _section(section))


def _section(section: LaneSection) -> Lines:
    left = [lane for lane in section.lanes if lane.number > 0]
    right = [lane for lane in section.lanes if lane.number < 0]
    if left:
        yield from _tag("left", {}, 4, (line for lane in left for line in _lane(lane)))
    middle = _tag("lane", {"id": 0, "type": "none", "level": "false"}, 5, _mark(section.mark))
    yield from _tag("center", {}, 4, middle)
    if right:
        yield from _tag("right", {}, 4, (line for lane in right for line in _lane(lane)))


def _lane(lane: LaneRecord) -> Lines:
    def inner() -> Lines:
        links = [("predecessor", lane.before), ("successor", lane.behind)]
        known = [(name, number) for name, number in links if number]
        if known:
            yield from _tag("link", {}, 6, (line for name, number in known for line in _tag(name, {"id": number}, 7)))
        yield from _cubics("width", "sOffset", (lane.width,), 6)
        yield from _mark(lane.mark)
        for offset, friction in lane.frictions:
            yield from _tag("material", {"sOffset": offset, "friction": friction, "roughness": 0.0}, 6)

    return _tag("lane", {"id": lane.number, "type": "driving", "level": "false"}, 5, inner())


def _mark(kind: str) -> Lines:
    head: Attributes = {"sOffset": 0.0, "type": kind, "weight": "standard", "color": "white", "width": 0.12}
    return _tag("roadMark", head, 6)


def _patch(road: RoadRecord, number: int, patch: PatchRecord) -> Lines:
    corners = [
        (patch.start, patch.right),
        (patch.end, patch.right),
        (patch.end, patch.left),
        (patch.start, patch.left),
    ]

    def outline() -> Lines:
        for s, t in corners:
            yield from _tag("cornerRoad", {"s": s, "t": t, "dz": 0.0, "height": 0.0}, 6)

    def inner() -> Lines:
        yield from _tag("outlines", {}, 4, _tag("outline", {"id": 0, "closed": "true"}, 5, outline()))
        yield from _tag("material", {"friction": patch.friction, "roughness": 0.0, "surface": "slippery"}, 4)

    middle = (patch.start + patch.end) / 2, (patch.right + patch.left) / 2
    head: Attributes = {
        "id": f"{road.id}_{number}",
        "type": "patch",
        "s": middle[0],
        "t": middle[1],
        "zOffset": 0.0,
        "orientation": "none",
        "hdg": 0.0,
    }
    return _tag("object", head, 3, inner())


def _signal(signal: SignalRecord) -> Lines:
    head: Attributes = {
        "s": signal.station,
        "t": signal.offset,
        "id": signal.id,
        "name": f"light_{signal.id}",
        "dynamic": "yes",
        "orientation": signal.orientation,
        "zOffset": 3.0,
        "country": "OpenDRIVE",
        "type": _LIGHT,
        "subtype": "-1",
    }
    return _tag("signal", head, 3)


def _controller_id(junction: JunctionRecord, number: int) -> str:
    return f"{junction.id}{'ab'[number]}"


def _controller(junction: JunctionRecord, number: int, group: LightGroup) -> Lines:
    def inner() -> Lines:
        for signal in group.signals:
            yield from _tag("control", {"signalId": signal, "type": "0"}, 2)
        shown = ", ".join(f"{colour} {seconds!r}" for colour, seconds in group.phases)
        yield from _tag("userData", {"code": PHASES, "value": shown}, 2)
        if group.shift:
            yield from _tag("userData", {"code": SHIFT, "value": group.shift}, 2)

    name = _controller_id(junction, number)
    return _tag("controller", {"id": name, "name": f"lights_{name}", "sequence": number}, 1, inner())


def _junction(junction: JunctionRecord) -> Lines:
    def inner() -> Lines:
        for number, connection in enumerate(junction.connections):
            head: Attributes = {
                "id": number,
                "incomingRoad": connection.incoming,
                "connectingRoad": connection.connecting,
                "contactPoint": "start",
            }
            yield from _tag("connection", head, 2, _tag("laneLink", {"from": connection.lane, "to": -1}, 3))
        for high, low in junction.priorities:
            yield from _tag("priority", {"high": high, "low": low}, 2)
        for number in range(len(junction.lights)):
            yield from _tag("controller", {"id": _controller_id(junction, number), "type": "0"}, 2)

    return _tag("junction", {"id": junction.id, "name": junction.name}, 1, inner())
