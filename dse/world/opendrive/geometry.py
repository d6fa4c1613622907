"""<planView>: the pieces of a reference line."""

from __future__ import annotations

import math

from dse.errors import closest, fail
from dse.formats import XmlElement, shortened
from dse.world.opendrive.structure import Arc, Geometry, Line, Parametric, Polynomial, Shape, Spiral
from dse.world.opendrive.values import MOST_FACTOR, in_order, number

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
