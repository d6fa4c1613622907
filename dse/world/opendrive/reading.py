"""OpenDRIVE 1.4 to 1.8 → a network of roads."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from dse.errors import Problem, Problems, closest, fail, raise_if_any
from dse.formats import XmlElement, read_xml_file, real_of, shortened
from dse.world.opendrive.checks import network_problems, road_faults, road_problems
from dse.world.opendrive.driving import DRIVEN
from dse.world.opendrive.lanes import read_limit, read_offsets, read_sections
from dse.world.opendrive.patches import read_slicks
from dse.world.opendrive.roadside import Cycle, read_cycle, read_orders, read_signals, read_signs
from dse.world.opendrive.scenery_reader import read_scenery
from dse.world.opendrive.structure import (
    Arc,
    Connection,
    Cubic,
    End,
    Fault,
    Geometry,
    Junction,
    Limit,
    Line,
    Network,
    Parametric,
    Polynomial,
    Road,
    RoadLink,
    Shape,
    Sign,
    Signal,
    Spiral,
    TrafficOrder,
)
from dse.world.opendrive.values import MOST_FACTOR, cubic, in_order, number, text, whole

_UNFLAT = {"shape": "a lateral <shape>", "crossfall": "a <crossfall>", "crossSectionSurface": "a <crossSectionSurface>"}

ROUTE = "dse.route"
"""Code of <userData> of the whole: ids of roads, the way that is driven unless another one is asked for."""


def read_network(path: Path, file: str) -> Network:
    """The roads and junctions of the OpenDRIVE file at *path*, which is called *file* in messages.

    Raises DseError with everything in it that is wrong, or is not understood and would change where a road lies; what
    cannot be followed only along some roads is told when a path uses them.
    """
    return network_in(read_xml_file(path, file))


def network_in(root: XmlElement) -> Network:
    """The roads and junctions of an OpenDRIVE document. Raises DseError as `read_network`."""
    if root.tag != "OpenDRIVE":
        raise fail(f"an OpenDRIVE file begins with <OpenDRIVE>, not with <{shortened(root.tag)}>", root.where)
    problems = Problems()
    with problems:
        _require_version(root)
    named = {signal.get("id"): signal for signal in root.below("road", "signals", "signal")}
    cycles: dict[str, Cycle] = {}
    for element in root.all("controller"):
        with problems:
            cycle = read_cycle(element)
            cycles |= {control.get("signalId"): cycle for control in element.all("control")}
    roads: dict[str, Road] = {}
    for element in root.all("road"):
        with problems:
            road = _road(element, named, cycles)
            if road.id in roads:
                raise fail(f"there is another road '{shortened(road.id)}'", element.where)
            roads[road.id] = road
    junctions: dict[str, Junction] = {}
    for element in root.all("junction"):
        with problems:
            junction = _junction(element)
            if junction.id in junctions:
                raise fail(f"there is another junction '{shortened(junction.id)}'", element.where)
            junctions[junction.id] = junction
    raise_if_any(problems)
    if not roads:
        raise fail("there is no <road>", root.where)
    route = (id_ for data in root.all("userData") if data.get("code") == ROUTE for id_ in data.get("value").split())
    network = Network(roads, junctions, root.where, tuple(route), tuple(_roundabouts(root)))
    raise_if_any(network_problems(network))
    return network


def _require_version(root: XmlElement) -> None:
    header = root.child("header")
    if header is None:
        raise fail("<OpenDRIVE> has no <header>", root.where)
    version = whole(header, "revMajor"), whole(header, "revMinor")
    if version[0] != 1 or not version[1] <= 8:
        hint = "1.4 to 1.8 are read"
        raise fail(f"OpenDRIVE {version[0]}.{version[1]} is not supported", header.where, hint)


def _road(element: XmlElement, named: Mapping[str, XmlElement], cycles: Mapping[str, Cycle]) -> Road:
    rule = element.get("rule", "RHT")
    if rule not in {"RHT", "LHT"}:
        raise fail(f"<road>: 'rule' cannot be '{shortened(rule)}'", element.where, "possible: LHT, RHT")
    length = number(element, "length", least=0.0)
    if not length > 0.0:
        raise fail("<road> has no length", element.where)
    junction = element.get("junction", "-1").strip()
    refused, ignored = Problems(_unsupported(element)), Problems()
    limits: tuple[Limit, ...] = ()
    signals: tuple[Signal, ...] = ()
    signs: tuple[Sign, ...] = ()
    orders: tuple[TrafficOrder, ...] = ()
    with refused:
        limits, signals = tuple(_limits(element)), tuple(read_signals(element, named, cycles))
        signs, orders = tuple(read_signs(element, named, ignored)), tuple(read_orders(element, named))
    road = Road(
        text(element, "id"),
        length,
        rule == "LHT",
        "" if junction == "-1" else junction,
        dict(_links(element)),
        read_geometries(element),
        _profile(element, "elevationProfile", "elevation"),
        _profile(element, "lateralProfile", "superelevation"),
        read_offsets(element),
        read_sections(element, length),
        limits,
        tuple(read_slicks(element, refused)),
        signals,
        signs,
        orders,
        (),
        (),
        tuple(ignored),
        element.where,
        read_scenery(element, named),
    )
    with refused:
        refused += road_problems(road)
    faults: list[Fault] = []
    with refused:
        faults += road_faults(road)
    return replace(road, refused=tuple(refused), faults=tuple(faults))


def _profile(road: XmlElement, profile: str, tag: str) -> tuple[Cubic, ...]:
    return in_order(f"the <{tag}>", (cubic(element) for element in road.below(profile, tag)))


def _limits(road: XmlElement) -> Iterator[Limit]:
    for element in road.all("type"):
        s = number(element, "s", least=0.0)
        speed = element.child("speed")
        yield Limit(s, 0.0) if speed is None else read_limit(speed, s)


def _unsupported(road: XmlElement) -> Iterator[Problem]:
    """What would change heights along the road and cannot be carried by a path."""
    for element in road.below("lateralProfile"):
        for child in element.children:
            if child.tag in _UNFLAT and not _flat(child):
                yield Problem(f"a road with {_UNFLAT[child.tag]} is not supported on a path", child.where)
    if not all(_flat(element) for element in road.below("lateralProfile", "superelevation")):
        for lane in (lane for side in ("left", "right") for lane in road.below("lanes", "laneSection", side, "lane")):
            if lane.get("level") in {"true", "1"} and lane.get("type") in DRIVEN:
                yield Problem("a lane for vehicles that is level beside a banked road is not supported", lane.where)
    for element in road.below("surface", "CRG"):
        yield Problem("a road with an OpenCRG <surface> is not supported on a path", element.where)


def _flat(element: XmlElement) -> bool:
    """Whether all factors of a polynomial are zero."""
    return all(real_of(element.get(letter)) == 0.0 for letter in "abcd")


def _links(road: XmlElement) -> Iterator[tuple[End, RoadLink]]:
    for tag, end in (("predecessor", End.START), ("successor", End.END)):
        for element in road.below("link", tag):
            kind = element.get("elementType", "road")
            if kind not in {"road", "junction"}:
                raise fail(f"<{tag}>: 'elementType' cannot be '{shortened(kind)}'", element.where, "road or junction")
            # A link into the middle of a road belongs to a virtual junction, which is not followed.
            if "elementS" not in element.attributes:
                contact = End.START if kind == "junction" else _contact(element)
                yield end, RoadLink(kind, text(element, "elementId"), contact, element.where)


def _contact(element: XmlElement) -> End:
    said = text(element, "contactPoint")
    if said not in {"start", "end"}:
        raise fail(f"<{element.tag}>: 'contactPoint' cannot be '{shortened(said)}'", element.where, "start or end")
    return End(said)


def _junction(element: XmlElement) -> Junction:
    kind = element.get("type", "default").strip() or "default"
    followed = kind in {"default", "direct"}
    connections = tuple(_connection(child, kind) for child in element.all("connection")) if followed else ()
    ranks = tuple((p.get("high"), p.get("low")) for p in element.all("priority"))
    return Junction(text(element, "id"), kind, connections, ranks, element.where)


def _roundabouts(root: XmlElement) -> Iterator[frozenset[str]]:
    for group in root.all("junctionGroup"):
        if group.get("type") == "roundabout":
            yield frozenset(each.get("junction") for each in group.all("junctionReference"))


def _connection(element: XmlElement, kind: str) -> Connection:
    return Connection(
        text(element, "incomingRoad"),
        text(element, "linkedRoad" if kind == "direct" else "connectingRoad"),
        _contact(element),
        tuple((whole(link, "from"), whole(link, "to")) for link in element.all("laneLink")),
        element.where,
    )


# <planView>: the pieces of a reference line.


_SHAPES = ("line", "arc", "spiral", "poly3", "paramPoly3")
_MOST_TURNING = 100 * math.tau
"""A piece that turns more often is a slip of a digit; a ramp of a car park has some ten turns."""


def read_geometries(road: XmlElement) -> tuple[Geometry, ...]:
    """The pieces of a road's reference line; raises DseError located where one cannot be followed."""
    plan = road.child("planView")
    if plan is None:
        raise fail("<road> has no <planView>", road.where)
    read = (_geometry(element) for element in plan.all("geometry"))
    # A piece without length changes nothing.
    pieces = in_order("the <geometry>", (piece for piece in read if piece.length > 0.0))
    if not pieces:
        raise fail("<planView> has no <geometry> with a length", plan.where)
    return pieces


def _geometry(element: XmlElement) -> Geometry:
    s, length = number(element, "s", least=0.0), number(element, "length", least=0.0)
    x, y, heading = number(element, "x"), number(element, "y"), number(element, "hdg")
    return Geometry(s, x, y, heading, length, _shape(element, length), element.where)


def _shape(element: XmlElement, length: float) -> Shape:
    # What else stands there is data of a user.
    shapes = [child for child in element.children if child.tag not in {"userData", "include", "dataQuality"}]
    if len(shapes) != 1:
        raise fail(f"<geometry> has {len(shapes)} shapes, not one", element.where, f"possible: {', '.join(_SHAPES)}")
    shape = shapes[0]
    match shape.tag:
        case "line":
            return Line()
        case "arc":
            curvature = number(shape, "curvature")
            _require_turning(shape, curvature * length)
            return Arc(curvature)
        case "spiral":
            start, end = number(shape, "curvStart"), number(shape, "curvEnd")
            _require_turning(shape, max(abs(start), abs(end)) * length)
            return Spiral(start, end)
        case "poly3":
            return Polynomial(_letters(shape, ""))
        case "paramPoly3":
            return Parametric(_letters(shape, "U"), _letters(shape, "V"), _last(shape, length))
    raise fail(f"<{shortened(shape.tag)}> is not a known shape of a road", shape.where, closest(shape.tag, _SHAPES))


def _require_turning(shape: XmlElement, angle: float) -> None:
    if abs(angle) > _MOST_TURNING:
        raise fail(f"<{shape.tag}> turns {abs(angle) / math.tau:.3g} times", shape.where, "curvatures are in 1/m")


def _letters(shape: XmlElement, axis: str) -> tuple[float, float, float, float]:
    a, b, c, d = (number(shape, letter + axis, most=MOST_FACTOR) for letter in "abcd")
    return a, b, c, d


def _last(shape: XmlElement, length: float) -> float:
    # 1.4 has files without it; its text says that p is normalized then.
    match shape.get("pRange", "normalized"):
        case "normalized":
            return 1.0
        case "arcLength":
            return length
    raise fail(
        f"<paramPoly3>: 'pRange' cannot be '{shortened(shape.get('pRange'))}'",
        shape.where,
        "possible: arcLength, normalized",
    )
