"""Numbers in OpenDRIVE's attributes."""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise
from typing import Protocol, TypeVar

from dse.errors import Location, Problem, fail
from dse.formats import XmlElement, shortened
from dse.world.opendrive.structure import Cubic

MOST = 1e8
"""No place in a road network has larger numbers: doubles are good to 1e-8 m there."""
MOST_FACTOR = 1e30
"""No factor of a polynomial is larger; what they come to is looked at where it matters."""


class PlacedText(Protocol):
    """Something that begins at a station of a road."""

    @property
    def s(self) -> float:
        """Where it begins, in m from the start of the road."""

    @property
    def where(self) -> Location:
        """Where it stands in the file."""


P = TypeVar("P", bound=PlacedText)


def number(
    element: XmlElement, name: str, *, least: float | None = None, most: float = MOST, default: float | None = None
) -> float:
    """The attribute as a finite number from *least* (or -*most*) to *most*; *default*, if there is one, if not there.

    Raises DseError located at the element: not there, no number, or out of range.
    """
    found: list[Problem] = []
    value = element.real(name, found)
    if found:
        raise fail(found[0].what, element.where)
    if value is None:
        if default is None:
            raise fail(f"<{element.tag}> has no '{name}'", element.where)
        return default
    said = shortened(element.get(name).strip())
    if not math.isfinite(value) or abs(value) > most:
        raise fail(f"<{element.tag}>: '{name}' is {said}, not between -{most:g} and {most:g}", element.where)
    if least is not None and value < least:
        raise fail(f"<{element.tag}>: '{name}' is {said}, not at least {least:g}", element.where)
    return value


def whole(element: XmlElement, name: str) -> int:
    """The attribute as a whole number; raises DseError located at the element."""
    found: list[Problem] = []
    value = element.whole(name, found, least=-1000, most=1000)
    if value is None:
        raise fail(found[0].what if found else f"<{element.tag}> has no '{name}'", element.where)
    return value


def text(element: XmlElement, name: str) -> str:
    """The attribute's text; raises DseError located at the element if there is none."""
    value = element.get(name).strip()
    if not value:
        raise fail(f"<{element.tag}> has no '{name}'", element.where)
    return value


def cubic(element: XmlElement, start: float = 0.0, name: str = "s") -> Cubic:
    """A cubic from an element's attributes *name*, which counts from *start*, and a, b, c, d."""
    a, b, c, d = (number(element, letter, most=MOST_FACTOR) for letter in "abcd")
    return Cubic(start + number(element, name, least=0.0), a, b, c, d, element.where)


def in_order(what: str, items: Iterable[P]) -> tuple[P, ...]:
    """The items, which must stand in the order of their stations; raises DseError at the first that does not."""
    listed = tuple(items)
    for one, other in pairwise(listed):
        if other.s < one.s:
            raise fail(f"{what} at {other.s:g} m comes after that at {one.s:g} m", other.where, "put them in order")
    return listed
