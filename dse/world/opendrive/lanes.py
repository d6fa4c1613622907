"""<lanes>: sections, lanes, and what changes along them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from dse.errors import Location, Problem, Problems, fail
from dse.formats import XmlElement, shortened
from dse.world.in_the_way import users_of
from dse.world.opendrive.structure import Cubic, Fault, Lane, Limit, Section
from dse.world.opendrive.values import cubic, in_order, number, text, whole

_KMH = 1000.0 / 3600.0
SPEED_UNITS = {"m/s": 1.0, "km/h": _KMH, "mph": 1609.344 / 3600.0}
_UNLIMITED = ("no limit", "undefined")


@dataclass(frozen=True, slots=True)
class _Raw:
    """A <laneSection> as it stands there, for one side of the road or both."""

    s: float
    left: dict[int, Lane]
    right: dict[int, Lane]
    single: bool
    where: Location


def read_offsets(road: XmlElement) -> tuple[Cubic, ...]:
    """The offsets of the centre lane from the reference line."""
    return in_order("<laneOffset>", (cubic(element) for element in road.below("lanes", "laneOffset")))


def read_sections(road: XmlElement, length: float) -> tuple[Section, ...]:
    """The sections of a road; those for one side only are completed by the lanes of the other side.

    Raises DseError located where one cannot be understood.
    """
    lanes = road.child("lanes")
    if lanes is None:
        raise fail("<road> has no <lanes>", road.where)
    raw = in_order("the <laneSection>", (_raw(element) for element in lanes.all("laneSection")))
    if not raw:
        raise fail("<lanes> has no <laneSection>", lanes.where)
    if raw[0].s > 1e-6:
        raise fail(f"the first <laneSection> begins at {raw[0].s:g} m, not at 0", raw[0].where)
    for section in raw:
        if section.s >= length:
            what = f"the <laneSection> at {section.s:g} m is beyond the end of its road, {length:g} m"
            raise fail(what, section.where)
    return tuple(_completed(raw, length))


def read_limit(element: XmlElement, s: float) -> Limit:
    """What a <speed> allows, in m/s."""
    if element.get("max").strip() in _UNLIMITED:
        return Limit(s, 0.0)
    unit = element.get("unit", "m/s").strip() or "m/s"
    if unit not in SPEED_UNITS:
        raise fail(f"<speed>: '{shortened(unit)}' is not a unit of a speed", element.where, "possible: km/h, m/s, mph")
    return Limit(s, number(element, "max", least=0.0) * SPEED_UNITS[unit])


def _completed(raw: tuple[_Raw, ...], length: float) -> Iterator[Section]:
    left: dict[int, Lane] = {}
    right: dict[int, Lane] = {}
    ends = [section.s for section in raw[1:]] + [length]
    for section, end in zip(raw, ends, strict=True):
        left_goes_on = section.single and not section.left
        right_goes_on = section.single and not section.right
        left = left if left_goes_on else section.left
        right = right if right_goes_on else section.right
        if end > section.s:
            yield Section(section.s, end, left | right, left_goes_on, right_goes_on, section.where)


def _raw(element: XmlElement) -> _Raw:
    s = number(element, "s", least=0.0)
    left, right = _side(element, "left", s), _side(element, "right", s)
    single = element.get("singleSide").strip() in {"true", "1"}
    if single and left and right:
        raise fail("a <laneSection> with 'singleSide' has lanes on both sides", element.where)
    return _Raw(s, left, right, single, element.where)


def _side(section: XmlElement, side: str, s: float) -> dict[int, Lane]:
    """The lanes of a side by their ids, from the centre outwards."""
    lanes: dict[int, Lane] = {}
    for element in section.below(side, "lane"):
        lane = _lane(element, s)
        if lane.id in lanes:
            raise fail(f"there is another lane {lane.id} in this section", element.where)
        if (lane.id > 0) != (side == "left") or lane.id == 0:
            raise fail(f"lane {lane.id} is in <{side}>", element.where, "ids are > 0 on the left, < 0 on the right")
        lanes[lane.id] = lane
    return dict(sorted(lanes.items(), key=lambda item: abs(item[0])))


def _lane(element: XmlElement, s: float) -> Lane:
    refused = Problems()
    limits: tuple[Limit, ...] = ()
    with refused:
        limits = tuple(read_limit(child, s + number(child, "sOffset", least=0.0)) for child in element.all("speed"))
    if element.child("width") is None and element.child("border") is None:
        raise fail(f"lane {whole(element, 'id')} has neither <width> nor <border>", element.where)
    return Lane(
        whole(element, "id"),
        text(element, "type"),
        element.get("direction").strip() == "reversed",
        in_order("<width>", (cubic(child, s, "sOffset") for child in element.all("width"))),
        in_order("<border>", (cubic(child, s, "sOffset") for child in element.all("border"))),
        _linked(element, "predecessor"),
        _linked(element, "successor"),
        limits,
        tuple(_friction(child, s) for child in element.all("material")),
        users_of(text(element, "type"), _rules(element)),
        tuple(_faults(element)),
        tuple(refused),
        element.where,
    )


def _linked(lane: XmlElement, which: str) -> tuple[int, ...]:
    return tuple(whole(element, "id") for element in lane.below("link", which))


def _friction(element: XmlElement, s: float) -> tuple[float, float]:
    # Programs differ in what 1 is; ours take it for dry asphalt, so that the tyre's own friction is scaled by it.
    return s + number(element, "sOffset", least=0.0), number(element, "friction", least=0.0, default=1.0)


def _rules(lane: XmlElement) -> Iterator[tuple[str, str]]:
    """What <access> allows or denies; until 1.6 all are denied. A rule of a part of the lane counts for all of it."""
    for element in lane.all("access"):
        words = [element.get("restriction"), *(each.get("type") for each in element.all("restriction"))]
        yield from ((element.get("rule", "deny").strip(), word.strip()) for word in words if word)


def _faults(lane: XmlElement) -> Iterator[Fault]:
    for element in lane.all("height"):
        inner, outer = number(element, "inner", default=0.0), number(element, "outer", default=0.0)
        if not math.isclose(inner, 0.0, abs_tol=1e-6) or not math.isclose(outer, 0.0, abs_tol=1e-6):
            what = "a lane with a <height> of its own is not supported on a path"
            yield Fault(Problem(what, element.where), max(abs(inner), abs(outer)))
