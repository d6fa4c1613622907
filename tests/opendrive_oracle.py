"""Places on a road straight from OpenDRIVE's text: its XML, closed forms, and quadrature of the original curves.

Nothing here knows dse: elements are searched for again for each point, arcs are drawn about their centres, clothoids by
Fresnel integrals, and the lengths of polynomials are integrated adaptively.
"""

from __future__ import annotations

import math
from xml.etree import ElementTree as ET

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.special import fresnel


def roads_of(text: str | bytes) -> dict[str, ET.Element]:
    return {element.get("id", ""): element for element in ET.fromstring(text).iter("road")}  # noqa: S314  # our own


def place(road: ET.Element, s: float, t: float) -> tuple[float, float]:
    """x and y of the point at s, t."""
    x, y, heading = reference(road, s)
    return x - t * math.sin(heading), y + t * math.cos(heading)


def reference(road: ET.Element, s: float) -> tuple[float, float, float]:
    """x, y and heading of the reference line."""
    pieces = [g for g in road.iter("geometry") if _number(g, "s") <= s and _number(g, "length") > 0]
    geometry = max(pieces, key=lambda g: _number(g, "s"))
    ds = s - _number(geometry, "s")
    u, v, turned = _local(geometry, ds)
    heading = _number(geometry, "hdg")
    x = _number(geometry, "x") + u * math.cos(heading) - v * math.sin(heading)
    y = _number(geometry, "y") + u * math.sin(heading) + v * math.cos(heading)
    return x, y, heading + turned


def borders(road: ET.Element, s: float, id_: int) -> tuple[float, float]:
    """The t of the inner and the outer border of a lane."""
    lanes = road.find("lanes")
    assert lanes is not None
    sign = 1 if id_ > 0 else -1
    side = "left" if sign > 0 else "right"
    sections = [x for x in lanes.iter("laneSection") if _number(x, "s") <= s]
    # A section for one side only says nothing of the other.
    sections = [x for x in sections if x.get("singleSide") != "true" or x.find(side) is not None]
    section = sections[-1]
    inner = outer = _cubic(lanes.findall("laneOffset"), "s", s)
    by_id = {int(x.get("id", "")): x for x in section.iter("lane")}
    for number in range(sign, id_ + sign, sign):
        ds = s - _number(section, "s")
        inner = outer
        if by_id[number].find("width") is not None:
            outer = inner + sign * _cubic(by_id[number].findall("width"), "sOffset", ds)
        else:
            outer = _cubic(by_id[number].findall("border"), "sOffset", ds)
    return inner, outer


def height(road: ET.Element, s: float, t: float) -> float:
    tilt = _cubic(road.findall("lateralProfile/superelevation"), "s", s)
    return _cubic(road.findall("elevationProfile/elevation"), "s", s) + t * math.tan(tilt)


def _number(element: ET.Element, name: str) -> float:
    return float(element.get(name, "nan"))


def _cubic(elements: list[ET.Element], along: str, s: float) -> float:
    begun = [e for e in elements if _number(e, along) <= s]
    if not begun:
        return 0.0
    a, b, c, d = (_number(begun[-1], name) for name in "abcd")
    ds = s - _number(begun[-1], along)
    return a + b * ds + c * ds**2 + d * ds**3


def _local(geometry: ET.Element, ds: float) -> tuple[float, float, float]:
    length = _number(geometry, "length")
    shape = next(iter(geometry))
    if shape.tag == "line":
        return ds, 0.0, 0.0
    if shape.tag == "arc":
        return _circle(_number(shape, "curvature"), ds)
    if shape.tag == "spiral":
        k0, k1 = _number(shape, "curvStart"), _number(shape, "curvEnd")
        return _circle(k0, ds) if k0 == k1 else _clothoid(k0, k1, length, ds)
    if shape.tag == "poly3":
        v = [_number(shape, name) for name in "abcd"]
        return _along([0.0, 1.0, 0.0, 0.0], v, ds, length)
    u, v = ([_number(shape, name + axis) for name in "abcd"] for axis in "UV")
    last = length if shape.get("pRange") == "arcLength" else 1.0
    whole = _arc_length(u, v, last)
    return _along(u, v, ds / length * whole, last)


def _circle(k: float, s: float) -> tuple[float, float, float]:
    return (math.sin(k * s) / k, (1 - math.cos(k * s)) / k, k * s) if k else (s, 0.0, 0.0)


def _clothoid(k0: float, k1: float, length: float, s: float) -> tuple[float, float, float]:
    """A clothoid is a part of the one that begins straight, between curvatures k0 and k0 + rate s."""
    rate = (k1 - k0) / length
    scale = math.sqrt(math.pi / abs(rate))

    def point(k: float) -> complex:
        sine, cosine = fresnel(k / rate / scale)
        return scale * complex(cosine, math.copysign(1, rate) * sine)

    turned = k0 * s + rate * s**2 / 2
    along = (point(k0 + rate * s) - point(k0)) * np.exp(-1j * k0**2 / (2 * rate))
    return along.real, along.imag, turned


def _arc_length(u: list[float], v: list[float], p: float) -> float:
    def pace(q: float) -> float:
        du, dv = (c[1] + 2 * c[2] * q + 3 * c[3] * q**2 for c in (u, v))
        return math.hypot(du, dv)

    return float(quad(pace, 0.0, p, epsabs=1e-11, epsrel=1e-12, limit=200)[0])


def _along(u: list[float], v: list[float], s: float, last: float) -> tuple[float, float, float]:
    p = brentq(lambda q: _arc_length(u, v, q) - s, -1e-3 * last, 1.001 * last, xtol=1e-13, rtol=1e-14)
    (pu, du), (pv, dv) = (
        (c[0] + c[1] * p + c[2] * p**2 + c[3] * p**3, c[1] + 2 * c[2] * p + 3 * c[3] * p**2) for c in (u, v)
    )
    return pu, pv, math.atan2(dv, du)
