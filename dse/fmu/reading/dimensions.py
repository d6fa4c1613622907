"""Dimension elements of FMI 3.0: how large arrays are, and which structural parameters say so."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod

from dse.errors import Problem
from dse.formats import XmlElement, whole_of

_MOST_ELEMENTS = 10_000_000


@dataclass(frozen=True, slots=True)
class Size:
    """A variable that may size arrays. *name* is "" if it is a constant."""

    name: str
    start: int | None


Sizes = Mapping[int, Size]


def declared_sizes(model: XmlElement) -> Sizes:
    """The structural parameters and whole constants below ModelVariables, by value reference."""
    sizes: dict[int, Size] = {}
    for element in model.children:
        is_structural = element.get("causality").strip() == "structuralParameter"
        reference = whole_of(element.get("valueReference"))
        if reference is not None and (is_structural or element.get("variability").strip() == "constant"):
            sizes[reference] = Size(element.get("name") if is_structural else "", whole_of(element.get("start")))
    return sizes


def read_shape(
    element: XmlElement, subject: str, sizes: Sizes, problems: list[Problem]
) -> tuple[tuple[int, ...], tuple[str, ...]]:
    """The sizes of a variable's dimensions, and the structural parameter behind each ("" for a fixed one)."""
    shape: list[int] = []
    sized_by: list[str] = []
    for dimension in element.all("Dimension"):
        start = dimension.whole("start", problems, least=0)
        reference = dimension.whole("valueReference", problems, least=0)
        name = ""
        if ("start" in dimension.attributes) == ("valueReference" in dimension.attributes):
            what = f"{subject}: a dimension has either a 'start' or a 'valueReference'"
            problems.append(Problem(what, dimension.where))
            continue
        if reference is not None:
            size = sizes.get(reference)
            if size is None or size.start is None:
                what = f"{subject} is sized by value reference {reference}, no structural parameter with a start"
                problems.append(Problem(what, dimension.where))
                continue
            name, start = size.name, size.start
        if start is None:
            continue
        shape.append(start)
        sized_by.append(name)
    if prod(shape) > _MOST_ELEMENTS:
        problems.append(Problem(f"{subject} has more than {_MOST_ELEMENTS:,} elements", element.where))
        return (), ()
    return tuple(shape), tuple(sized_by)
