"""What in a network contradicts itself, or names what is not there."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np

from dse.errors import Problem, closest
from dse.formats import shortened
from dse.world.opendrive.curves import curve_of
from dse.world.opendrive.driving import DRIVEN, ends_at, lanes_at, leaves_at
from dse.world.opendrive.structure import Connection, Cubic, End, Fault, Geometry, Lane, Network, Road

GAP = 0.05
"""How far apart pieces of a line may be, in m; and how far lengths may contradict each other, beside 1e-4 of them."""
KINK = 0.1
"""How much pieces of a line may turn where they meet, in rad."""

_HIGHEST, _WIDEST = 1e4, 1e4  # m
_STEEPEST = 1.4  # rad
_BARELY = 1e-6  # m
_SAMPLES = np.linspace(0.0, 1.0, 9)


def road_faults(road: Road) -> Iterator[Fault]:
    """Lengths that contradict, and gaps; raises DseError where a curve cannot be followed at all."""
    pieces = road.geometries
    ends = [piece.s for piece in pieces[1:]] + [road.length]
    for piece, end in zip(pieces, ends, strict=True):
        if not _agree(piece.s + piece.length, end):
            what = f"the <geometry> from {piece.s:g} m on is {piece.length:g} m long, but the next begins"
            what = what if end is not road.length else what.replace("the next begins", "the road ends")
            yield Fault(Problem(f"{what} at {end:g} m", piece.where), abs(piece.s + piece.length - end))
    for piece in pieces:
        length = curve_of(piece).length
        if not _agree(length, piece.length):
            what = f"the curve is {length:g} m long, its <geometry> gives {piece.length:g} m"
            yield Fault(Problem(what, piece.where), abs(length - piece.length))
    for one, other in pairwise(pieces):
        yield from _apart(one, other)


def road_problems(road: Road) -> Iterator[Problem]:
    """Sizes no road has."""
    piece = road.geometries[0]
    if piece.s > GAP:
        yield Problem(f"the first <geometry> begins at {piece.s:g} m, not at 0", piece.where)
    yield from _unfit(road.elevation, road.length, _HIGHEST, "a height of", "m")
    yield from _unfit(road.superelevation, road.length, _STEEPEST, "a superelevation of", "rad")
    yield from _unfit(road.offsets, road.length, _WIDEST, "a lane offset of", "m")
    for section in road.sections:
        for lane in section.lanes.values():
            first = (lane.widths or lane.borders)[0]
            if first.s > section.s + _BARELY:
                what = f"the width of lane {lane.id} begins {first.s - section.s:g} m behind its section"
                yield Problem(what, first.where)
            yield from _unfit(lane.widths, section.end, _WIDEST, f"in lane {lane.id} a width of", "m", -GAP)
            yield from _unfit(() if lane.widths else lane.borders, section.end, _WIDEST, "a border at", "m")


def _unfit(
    cubics: tuple[Cubic, ...], end: float, most: float, what: str, unit: str, least: float = -math.inf
) -> Iterator[Problem]:
    ends = [*(cubic.s for cubic in cubics[1:]), end]
    for cubic, until in zip(cubics, ends, strict=False):
        ds = max(min(until, end) - cubic.s, 0.0) * _SAMPLES
        values = cubic.a + ds * (cubic.b + ds * (cubic.c + ds * cubic.d))
        worst = values[np.argmax(np.where(values < least, math.inf, np.abs(values)))]
        if not max(least, -most) <= worst <= most:
            yield Problem(f"the road has {what} {worst:g} {unit}", cubic.where)


def _apart(one: Geometry, other: Geometry) -> Iterator[Fault]:
    frames = curve_of(one).at(np.array([one.length]))
    begin = curve_of(other).at(np.zeros(1))
    dx = one.x + frames.x[0] - other.x - begin.x[0]
    dy = one.y + frames.y[0] - other.y - begin.y[0]
    off = math.hypot(dx, dy)
    if not off <= GAP:
        yield Fault(Problem(f"this <geometry> begins {off:.3g} m off the end of the one before", other.where), off)
    kink = math.remainder(frames.heading[0] - begin.heading[0], math.tau)
    if not abs(kink) <= KINK:
        what = f"this <geometry> begins with a kink of {kink:.3g} rad"
        yield Fault(Problem(what, other.where), kink=abs(kink))


def network_problems(network: Network) -> list[Problem]:
    """Links to what is not there; those between lanes are looked at if roads and junctions are."""
    return [*_missing(network)] or [*_missing_lanes(network)]


def _missing(network: Network) -> Iterator[Problem]:
    for road in network.roads.values():
        if road.junction and road.junction not in network.junctions:
            what = f"road '{shortened(road.id)}' is in junction '{shortened(road.junction)}', which is not there"
            yield Problem(what, road.where, closest(road.junction, network.junctions))
        for end, link in road.links.items():
            there = network.roads if link.element == "road" else network.junctions
            if link.id not in there:
                what = f"there is no {link.element} '{shortened(link.id)}' for road '{shortened(road.id)}' to meet"
                yield Problem(f"{what} at its {end.value}", link.where, closest(link.id, there))
    for junction in network.junctions.values():
        for connection in junction.connections:
            for id_ in (connection.incoming, connection.road):
                if id_ not in network.roads:
                    yield Problem(f"there is no road '{shortened(id_)}'", connection.where, closest(id_, network.roads))


def _missing_lanes(network: Network) -> Iterator[Problem]:
    for road in network.roads.values():
        for here, there in pairwise(road.sections):
            for lane in here.lanes.values():
                goes_on = there.left_goes_on if lane.id > 0 else there.right_goes_on
                yield from _unlinked(lane, () if goes_on else lane.successors, there.lanes, "the next section")
            for lane in there.lanes.values():
                goes_on = there.left_goes_on if lane.id > 0 else there.right_goes_on
                yield from _unlinked(lane, () if goes_on else lane.predecessors, here.lanes, "the section before")
        for end, link in road.links.items():
            if link.element == "road":
                there_, called = lanes_at(network.roads[link.id], link.contact), f"road '{shortened(link.id)}'"
                for lane in lanes_at(road, end).values():
                    yield from _unlinked(
                        lane, lane.predecessors if end is End.START else lane.successors, there_, called
                    )
    for junction in network.junctions.values():
        for connection in junction.connections:
            incoming, road = network.roads[connection.incoming], network.roads[connection.road]
            for end in ends_at(network, junction, connection):
                beyond = lanes_at(road, connection.contact)
                yield from _cut_off(incoming, end, dict(connection.links), beyond, connection)
                back = {other: one for one, other in connection.links}
                yield from _cut_off(road, connection.contact, back, lanes_at(incoming, end), connection)


def _cut_off(
    road: Road, end: End, links: Mapping[int, int], lanes: Mapping[int, Lane], connection: Connection
) -> Iterator[Problem]:
    """Links that vehicles would take out of a road, to lanes that are not there; nobody misses others."""
    for here, there in links.items():
        lane = lanes_at(road, end).get(here)
        if lane is not None and leaves_at(road, lane, end) and lane.type in DRIVEN and there not in lanes:
            what = f"lane {here} of road '{shortened(road.id)}' is linked to lane {there}, which is not there"
            yield Problem(what, connection.where, closest(str(there), map(str, lanes)))


def _unlinked(lane: Lane, linked: tuple[int, ...], lanes: Mapping[int, Lane], called: str) -> Iterator[Problem]:
    for id_ in linked:
        # Centre lanes are no lanes to drive in; some programs link to them where a lane ends.
        if id_ and id_ not in lanes:
            yield Problem(f"lane {lane.id} is linked to lane {id_}, which {called} does not have", lane.where)


def _agree(one: float, other: float) -> bool:
    return abs(one - other) <= GAP + 1e-4 * max(abs(one), abs(other))
