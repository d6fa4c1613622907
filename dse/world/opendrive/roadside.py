"""What stands on a road: traffic lights and signs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from dse.errors import Problem, fail
from dse.formats import XmlElement, real_of, shortened
from dse.world.opendrive.speed_signs import is_german, sign_speed
from dse.world.opendrive.structure import Sign, Signal, TrafficOrder
from dse.world.opendrive.values import number, text, whole

PHASES, SHIFT = "dse.phases", "dse.shift"
"""Codes of <userData>. OpenDRIVE says where lights are, not what they show: a signal, or the controller of several,
says it in ``<userData code="dse.phases" value="green 20, yellow 3, red 27"/>`` and, if all of it begins later than at
0 s, in ``<userData code="dse.shift" value="10"/>``."""
COLOURS = ("off", "red", "red_yellow", "yellow", "green")

_LIGHTS = {"1000001", "1000009", "1000010", "1000011", "1000012"}
"""Lights for vehicles in the catalogue of OpenDRIVE; those for pedestrians and trams are not obeyed by cars."""

_ORDERS = {"205", "206", "301", "306", "307"}

Cycle = tuple[tuple[tuple[str, float], ...], float]
"""Phases and their shift."""


def read_cycle(element: XmlElement) -> Cycle:
    """The phases that the user data of *element* tell, none if they do not; raises DseError located there."""
    phases: tuple[tuple[str, float], ...] = ()
    shift = 0.0
    for data in element.all("userData"):
        if data.get("code") == PHASES:
            phases = tuple(_phase(data, part) for part in data.get("value").split(","))
        elif data.get("code") == SHIFT:
            shift = number(data, "value")
    return phases, shift


def read_signals(road: XmlElement, named: Mapping[str, XmlElement], cycles: Mapping[str, Cycle]) -> Iterator[Signal]:
    """The traffic lights of a road, *named* signals that it refers to among them; *cycles* are those of controllers.

    Raises DseError located where one cannot be understood.
    """
    for stands, signal in _standing(road, named):
        if _is_light(signal):
            yield _signal(stands, signal, cycles)


def read_signs(road: XmlElement, named: Mapping[str, XmlElement], ignored: list[Problem]) -> Iterator[Sign]:
    """The speed limits that signs of a road tell; those that cannot be read go to *ignored*.

    Raises DseError located where one cannot be understood.
    """
    for stands, signal in _standing(road, named):
        speed = sign_speed(signal, ignored)
        if speed is not None:
            yield Sign(*_place(stands), speed)


def read_orders(road: XmlElement, named: Mapping[str, XmlElement]) -> Iterator[TrafficOrder]:
    """The signs of a road that say who has the right of way: 205, 206, 301, 306 and 307 of the same catalogue."""
    for stands, signal in _standing(road, named):
        if is_german(signal) and signal.get("type") in _ORDERS:
            yield TrafficOrder(*_place(stands), signal.get("type"))


def _standing(road: XmlElement, named: Mapping[str, XmlElement]) -> Iterator[tuple[XmlElement, XmlElement]]:
    """What says where a signal stands, and what says what it is."""
    for element in road.below("signals", "signal"):
        yield element, element
    for element in road.below("signals", "signalReference"):
        signal = named.get(text(element, "id"))
        if signal is None:
            raise fail(f"there is no signal '{shortened(element.get('id'))}'", element.where)
        yield element, signal


def _is_light(element: XmlElement) -> bool:
    kind = element.get("type").replace(".", "").strip()
    catalogued = kind in _LIGHTS and element.get("country", "OpenDRIVE").lower() in {"opendrive", ""}
    return element.get("dynamic") == "yes" and (
        catalogued or any(data.get("code") == PHASES for data in element.all("userData"))
    )


def _signal(stands: XmlElement, signal: XmlElement, cycles: Mapping[str, Cycle]) -> Signal:
    id_ = text(signal, "id")
    own = read_cycle(signal)
    phases, shift = own if own[0] else cycles.get(id_, own)
    return Signal(id_, *_place(stands), phases, shift, stands.where)


def _place(stands: XmlElement) -> tuple[float, str, tuple[tuple[int, int], ...]]:
    """Where a signal stands, which way it looks, and the lanes it is for."""
    lanes = tuple((whole(v, "fromLane"), whole(v, "toLane")) for v in stands.all("validity"))
    orientation = stands.get("orientation", "none").strip()
    if orientation not in {"+", "-", "none"}:
        raise fail(f"<{stands.tag}>: 'orientation' is '{shortened(orientation)}'", stands.where, "possible: +, -, none")
    return number(stands, "s", least=0.0), orientation, lanes


def _phase(data: XmlElement, part: str) -> tuple[str, float]:
    colour, _, length = part.strip().partition(" ")
    seconds = real_of(length)
    if colour not in COLOURS or seconds is None or not 0.0 < seconds < math.inf:
        hint = f"a colour ({', '.join(COLOURS)}) and seconds each, like 'green 20, yellow 3, red 27'"
        raise fail(f"'{shortened(part.strip())}' is not a phase of a traffic light", data.where, hint)
    return colour, seconds
