"""OpenDRIVE as the tests evaluate it: lines, arcs and spirals in closed form, by Fresnel integrals."""

from __future__ import annotations

import cmath
import math
from xml.etree.ElementTree import Element

from defusedxml.ElementTree import fromstring
from scipy.special import fresnel

Pose = tuple[complex, float, float]
"""A point, a heading in rad and a curvature in 1/m."""


def roads_of(text: str) -> dict[str, Element]:
    return {road.get("id"): road for road in fromstring(text).iter("road")}


def number(element: Element, name: str) -> float:
    return float(element.get(name))


def pose(road: Element, s: float) -> Pose:
    """The reference line at *s*."""
    piece = [g for g in road.iter("geometry") if number(g, "s") <= s + 1e-12][-1]
    return after(piece, s - number(piece, "s"))


def after(geometry: Element, ds: float) -> Pose:
    start, heading = complex(number(geometry, "x"), number(geometry, "y")), number(geometry, "hdg")
    (shape,) = geometry
    if shape.tag == "line":
        return start + ds * cmath.exp(1j * heading), heading, 0.0
    if shape.tag == "arc":
        k = number(shape, "curvature")
        return start + (cmath.exp(1j * k * ds) - 1) / (1j * k) * cmath.exp(1j * heading), heading + k * ds, k
    first, last = number(shape, "curvStart"), number(shape, "curvEnd")
    rate = (last - first) / number(geometry, "length")
    # The clothoid with curvature 0 at its own start, from where this one begins.
    before, behind = _clothoid(first / rate, rate), _clothoid(first / rate + ds, rate)
    turned = cmath.exp(1j * (heading - first**2 / (2 * rate)))
    return start + (behind - before) * turned, heading + first * ds + rate * ds**2 / 2, first + rate * ds


def _clothoid(length: float, rate: float) -> complex:
    scale = math.sqrt(math.pi / abs(rate))
    sine, cosine = fresnel(length / scale)
    return scale * complex(cosine, math.copysign(sine, length * rate))


def cubic(records: list[Element], s: float, name: str = "s") -> float:
    """The value at *s* of the last record that begins before."""
    found = [record for record in records if number(record, name) <= s + 1e-9]
    if not found:
        return 0.0
    ds = s - number(found[-1], name)
    return sum(number(found[-1], letter) * ds**power for power, letter in enumerate("abcd"))


def lane_borders(road: Element, lane: int, s: float, *, last: bool = False) -> tuple[float, float]:
    """The t of a lane's inner and outer border at *s*; of two sections that meet there the earlier one if *last*."""
    sections = [x for x in road.iter("laneSection") if number(x, "s") <= s - (1e-9 if last and s > 0 else -1e-9)]
    section, sign = sections[-1], math.copysign(1, lane)
    widths = {int(x.get("id")): x.findall("width") for x in section.iter("lane")}
    t = cubic(list(road.iter("laneOffset")), s)
    for number_ in range(1, abs(lane) + 1):
        width = cubic(widths[int(sign * number_)], s - number(section, "s"), "sOffset")
        inner, t = t, t + sign * width
    return inner, t


def lane_middle(road: Element, lane: int, s: float) -> tuple[complex, float]:
    """The middle of a lane and the heading there."""
    point, heading, _ = pose(road, s)
    return point + 1j * sum(lane_borders(road, lane, s)) / 2 * cmath.exp(1j * heading), heading
