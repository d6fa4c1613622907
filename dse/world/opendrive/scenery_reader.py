"""An OpenDRIVE road → its scenery."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import suppress

from dse.errors import DseError
from dse.formats import XmlElement, real_of, whole_of
from dse.world.opendrive.lanes import SPEED_UNITS
from dse.world.opendrive.scenery import PlacedObject, PlacedSign, RoadMark, Scenery
from dse.world.opendrive.speed_signs import is_german, sign_speed

_MOST_REPEATED = 2000
_WIDTHS = {"bold": 0.25, "standard": 0.12}
_WRITTEN = ("km/h", "mph")
_WHOLE = 0.01
_ORDERS = {"205", "206", "301", "306", "307"}


def read_scenery(road: XmlElement, named: Mapping[str, XmlElement]) -> Scenery:
    """The scenery of *road*; *named* are all signals of the file. What is not a number or not known is not drawn: it
    changes no run, and a file is not refused for it."""
    kinds = [element.get("type") for element in road.all("type")]
    return Scenery(
        next((kind for kind in kinds if kind and kind != "unknown"), ""),
        dict(_marks(road)),
        tuple(_signs(road, named)),
        tuple(each for element in road.below("objects", "object") for each in _objects(element)),
    )


def _marks(road: XmlElement) -> Iterator[tuple[tuple[float, int], tuple[RoadMark, ...]]]:
    for section in road.below("lanes", "laneSection"):
        start = _real(section, "s", 0.0)
        for side in ("left", "center", "right"):
            for lane in section.below(side, "lane"):
                marks = tuple(sorted((_mark(each, start) for each in lane.all("roadMark")), key=lambda mark: mark.s))
                id_ = whole_of(lane.get("id"))
                if marks and id_ is not None:
                    yield (start, id_), marks


def _mark(element: XmlElement, start: float) -> RoadMark:
    width = _real(element, "width", 0.0) or _WIDTHS.get(element.get("weight"), 0.12)
    colour = element.get("color") or "white"
    return RoadMark(start + _real(element, "sOffset", 0.0), element.get("type") or "none", min(width, 0.5), colour)


def _signs(road: XmlElement, named: Mapping[str, XmlElement]) -> Iterator[PlacedSign]:
    placed = [(element, element) for element in road.below("signals", "signal")]
    referred = road.below("signals", "signalReference")
    placed += [(each, named[each.get("id")]) for each in referred if each.get("id") in named]
    for where, signal in placed:
        kind, text = _face(signal)
        if kind:
            yield PlacedSign(_real(where, "s", 0.0), _real(where, "t", 0.0), where.get("orientation"), kind, text)


def _face(signal: XmlElement) -> tuple[str, str]:
    """What is on a sign: a speed limit in the unit it is written in, or an order of the German catalogue."""
    speed = None
    with suppress(DseError):  # which is reported where limits are read
        speed = sign_speed(signal, [])
    if speed:
        written = signal.get("unit").strip()
        units = (written,) if written in _WRITTEN else _WRITTEN
        numbers = [speed / SPEED_UNITS[unit] for unit in units]
        return "limit", f"{next((each for each in numbers if abs(each - round(each)) < _WHOLE), numbers[0]):.0f}"
    kind = signal.get("type")
    return (kind, "") if kind in _ORDERS and is_german(signal) else ("", "")


def _objects(element: XmlElement) -> Iterator[PlacedObject]:
    kind = element.get("type")
    if not kind or element.child("material") is not None:
        return
    radius = _real(element, "radius", 0.0)
    size = [_real(element, "length", 2 * radius), _real(element, "width", 2 * radius), _real(element, "height", 0.0)]
    s, t, z = (_real(element, name, 0.0) for name in ("s", "t", "zOffset"))
    heading = _real(element, "hdg", 0.0)
    repeats = list(element.all("repeat"))
    if not repeats:
        yield PlacedObject(s, t, z, heading, kind, *size)
    for repeat in repeats:
        start, length, distance = (_real(repeat, name, 0.0) for name in ("s", "length", "distance"))
        # Without a distance it is one long thing, of which there are pieces here.
        step = distance if distance > 0.0 else max(size[0], 4.0)
        count = min(int(length / step) + 1, _MOST_REPEATED) if length > 0.0 else 1
        first, last = (_real(repeat, name, t) for name in ("tStart", "tEnd"))
        height = _real(repeat, "heightStart", size[2])
        long = size[0] if distance > 0.0 else step
        for number in range(count):
            share = number * step / length if length > 0.0 else 0.0
            at = first + share * (last - first)
            yield PlacedObject(start + number * step, at, z, heading, kind, long, size[1], height)


def _real(element: XmlElement, name: str, default: float) -> float:
    found = real_of(element.get(name))
    return found if found is not None and math.isfinite(found) else default
