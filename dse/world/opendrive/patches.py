"""Objects with a friction of their own: patches of the road that are slippery."""

from __future__ import annotations

import math
from collections.abc import Iterator

from dse.errors import Problem
from dse.formats import XmlElement
from dse.world.opendrive.structure import Slick
from dse.world.opendrive.values import number

_MOST_COPIES = 10_000

Rectangle = tuple[float, float, float, float]
"""From and to along the road, right and left."""


def read_slicks(road: XmlElement, refused: list[Problem]) -> Iterator[Slick]:
    """The objects of a road with a friction of their own; what is no rectangle along the road goes to *refused*."""
    for element in road.below("objects", "object"):
        # Objects are scenery but for their friction: nothing of the world asks for the others.
        material = next((child for child in element.all("material") if "friction" in child.attributes), None)
        if material is None:
            continue
        friction, repeats = number(material, "friction", least=0.0), list(element.all("repeat"))
        problems = [problem for repeat in repeats if (problem := _unrepeatable(element, repeat))]
        refused += problems
        for repeat in [] if problems else repeats:
            yield from (Slick(*sides, friction, repeat.where) for sides in _repeated(element, repeat))
        if repeats:
            continue
        sides = _rectangle(element)
        if sides is None:
            what = "an <object> with friction must be a rectangle along the road: length, width, and hdg 0"
            refused.append(Problem(what, element.where))
        else:
            yield Slick(*sides, friction, element.where)


def _unrepeatable(element: XmlElement, repeat: XmlElement) -> Problem | None:
    """Why the copies of an object are no rectangles along the road."""
    if math.sin(number(element, "hdg", default=0.0)) or _outlines(element):
        what = "a <repeat> of an <object> with friction that is turned or has an outline is not supported"
        return Problem(what, repeat.where)
    if repeat.get("detachFromReferenceLine").strip() in {"true", "1"}:
        what = "a <repeat> with 'detachFromReferenceLine' of an <object> with friction is not supported"
        return Problem(what, repeat.where)
    step, length = number(repeat, "distance", least=0.0), number(repeat, "length", least=0.0)
    if not step and (_ends(element, repeat, "t", "width")):
        what = (
            "a continuous <repeat> of an <object> with friction must keep its t and its width: it is no rectangle else"
        )
        return Problem(what, repeat.where)
    if step and length / step > _MOST_COPIES:
        return Problem(f"a <repeat> makes more than {_MOST_COPIES} copies of an <object> with friction", repeat.where)
    return None


def _repeated(element: XmlElement, repeat: XmlElement) -> Iterator[Rectangle]:
    """The copies of an object (OpenDRIVE 1.8.1, 13.4): they replace it; between start and end values are linear."""
    start, whole, step = (number(repeat, name, least=0.0) for name in ("s", "length", "distance"))
    if not step:
        t, width = (_between(element, repeat, name, 0.0) for name in ("t", "width"))
        yield start, start + whole, t - width / 2, t + width / 2
        return
    for i in range(math.floor(whole / step + 1e-9) + 1):
        share = min(i * step / whole, 1.0) if whole else 0.0
        t, width, length = (_between(element, repeat, name, share) for name in ("t", "width", "length"))
        s = start + i * step
        yield s - length / 2, s + length / 2, t - width / 2, t + width / 2


def _outlines(element: XmlElement) -> list[XmlElement]:
    return [*element.all("outline"), *element.below("outlines", "outline")]


def _between(element: XmlElement, repeat: XmlElement, name: str, share: float) -> float:
    own = number(element, name, default=0.0)
    start = number(repeat, f"{name}Start", default=own)
    return start + share * (number(repeat, f"{name}End", default=start) - start)


def _ends(element: XmlElement, repeat: XmlElement, *names: str) -> bool:
    """Whether a value is another one at the end than at the start."""
    return any(_between(element, repeat, name, 0.0) != _between(element, repeat, name, 1.0) for name in names)


def _rectangle(element: XmlElement) -> Rectangle | None:
    """From and to along the road, right and left; None if it is no rectangle."""
    outlines = _outlines(element)
    if outlines:
        corners = [(number(c, "s", least=0.0), number(c, "t")) for o in outlines for c in o.all("cornerRoad")]
        along, across = {s for s, _ in corners}, {t for _, t in corners}
        if len(outlines) != 1 or len({*corners}) != 4 or len(along) != 2 or len(across) != 2:
            return None
        return min(along), max(along), min(across), max(across)
    if math.sin(number(element, "hdg", default=0.0)) or not {"length", "width"} <= element.attributes.keys():
        return None
    s, t = number(element, "s", least=0.0), number(element, "t")
    half, side = number(element, "length", least=0.0) / 2, number(element, "width", least=0.0) / 2
    return s - half, s + half, t - side, t + side
