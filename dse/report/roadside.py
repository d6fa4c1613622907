"""What is seen of a road besides its lanes, as values: markings, signs, objects, and what kind of road it is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from dse.report.drawing.road_picture import Marking, StandingObject, StandingSign
from dse.report.roads import RoadLine
from dse.world import Network, Road, RoadMark, borders_of, from_cubics, value

_KINDS = {
    "motorway": "motorway",
    "rural": "rural",
    "town": "town",
    "lowSpeed": "town",
    "pedestrian": "town",
    "townExpressway": "town",
    "townCollector": "town",
    "townArterial": "town",
    "townLocal": "town",
    "townPlayStreet": "town",
    "townPrivate": "town",
}
_TOWN, _MOTORWAY = 60 / 3.6, 115 / 3.6
_INSIDE, _BESIDE = 15.0, 1.6
"""Speed limits up to which a road is in a town, and from which it is a motorway, where the file does not say."""


def kind_of(network: Network) -> str:
    """What most of the length of *network* is: "motorway", "town" or "rural"."""
    lengths: dict[str, float] = {}
    for road in network.roads.values():
        kind = _kind(road)
        lengths[kind] = lengths.get(kind, 0.0) + road.length
    return max(sorted(lengths), key=lambda kind: lengths[kind])


def markings_of(network: Network) -> tuple[Marking, ...]:
    """The markings that the file gives, along the borders of lanes."""
    return tuple(mark for road in network.roads.values() for mark in _markings(road))


def standing_signs(network: Network) -> tuple[StandingSign, ...]:
    """The signs that have a face: speed limits and orders."""
    return tuple(sign for road in network.roads.values() for sign in _signs(road))


def standing_objects(network: Network) -> tuple[StandingObject, ...]:
    """The objects of the file, repeated ones each."""
    return tuple(each for road in network.roads.values() for each in _objects(road))


def _kind(road: Road) -> str:
    if known := _KINDS.get(road.scenery.kind):
        return known
    limits = [limit.speed for limit in road.limits if limit.speed > 0.0]
    if not limits:
        return "rural"
    return "town" if max(limits) <= _TOWN else "motorway" if max(limits) >= _MOTORWAY else "rural"


def _markings(road: Road) -> Iterator[Marking]:
    line = RoadLine(road)
    for section in road.sections:
        borders = borders_of(road, section)
        centre = from_cubics(road.offsets, section.s, section.end)
        outer = {0: centre} | {id_: sides[1 if id_ > 0 else 0] for id_, sides in borders.items()}
        for id_, border in outer.items():
            marks = road.scenery.marks.get((section.s, id_), ())
            ends = [*(mark.s for mark in marks[1:]), section.end]
            for mark, until in zip(marks, ends, strict=False):
                start, end = max(mark.s, section.s), min(until, section.end)
                if _is_seen(mark) and end - start > 0.1:
                    stations = line.between(start, end)
                    points = line.along(stations, value(border, stations - section.s))
                    # Left and right of a mark are those of the side of the road that it is on.
                    yield Marking(points[::-1] if id_ > 0 else points, mark.kind, mark.width, mark.colour)


def _is_seen(mark: RoadMark) -> bool:
    return mark.kind not in {"", "none"}


def _signs(road: Road) -> Iterator[StandingSign]:
    line = RoadLine(road)
    for sign in road.scenery.signs:
        at = np.array([min(max(sign.s, 0.0), road.length)])
        along = line.heading_at(float(at[0]))
        yield StandingSign(
            line.point(at, sign.t), along + np.pi if sign.orientation == "-" else along, sign.kind, sign.text
        )

    if not any(sign.kind == "limit" for sign in road.scenery.signs) and not road.junction:
        yield from _limit_signs(road, line)


def _limit_signs(road: Road, line: RoadLine) -> Iterator[StandingSign]:
    """Beside the right border, where the file gives limits but no signs: what traffic obeys is seen."""
    for limit, before in zip(road.limits, (None, *road.limits), strict=False):
        if limit.speed > 0.0 and (before is None or before.speed != limit.speed):
            section = next(each for each in reversed(road.sections) if each.s <= limit.s)
            at = np.array([min(limit.s + _INSIDE, road.length)])
            sides = [
                float(value(side, at - section.s)[0]) for pair in borders_of(road, section).values() for side in pair
            ]
            heading = line.heading_at(float(at[0]))
            text = f"{limit.speed * 3.6:.0f}"
            yield StandingSign(line.point(at, min(sides) - _BESIDE), heading, "limit", text)


def _objects(road: Road) -> Iterator[StandingObject]:
    line = RoadLine(road)
    for each in road.scenery.objects:
        if 0.0 <= each.s <= road.length:
            place = line.point(np.array([each.s]), each.t) + np.array([0.0, 0.0, each.raised])
            heading = line.heading_at(each.s) + each.heading
            yield StandingObject(place, heading, each.kind, (each.length, each.width, each.height))
