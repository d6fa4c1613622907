"""Single values by their names → the groups, arrays and arrays of structures that they make up."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import product

from dse.domain.labels import Shape

_STEP = re.compile(r"([^.\[]*)(?:\[([0-9]+(?:,[0-9]+)*)\])?(?:\.|$)", re.ASCII)


@dataclass(frozen=True, slots=True)
class Outlined:
    """What stands behind a name: an array of this *shape*, or () for one, of a type, or of *members* by name."""

    shape: Shape
    type: str = ""
    members: tuple[tuple[str, Outlined], ...] = ()


class IrregularError(Exception):
    """Names that make up no array: values are missing, or differ in type."""


def outline(leaves: Iterable[tuple[str, str]]) -> dict[str, Outlined]:
    """What the values, given by name and type, make up, by the first step of their names. Raises IrregularError."""
    found: dict[str, dict[Shape, list[tuple[str, str]]]] = {}
    for label, type_ in leaves:
        match = _STEP.match(label)
        if match is None:
            raise IrregularError(label)
        index = tuple(map(int, match[2].split(","))) if match[2] else ()
        found.setdefault(match[1], {}).setdefault(index, []).append((label[match.end() :], type_))
    return {name: _outlined(name, elements) for name, elements in found.items()}


def _outlined(name: str, elements: dict[Shape, list[tuple[str, str]]]) -> Outlined:
    sizes = {len(index) for index in elements}
    shape = tuple(map(max, zip(*elements, strict=True))) if len(sizes) == 1 else ()
    if set(elements) != set(product(*(range(1, size + 1) for size in shape))):
        raise IrregularError(name)
    inner = {_element(name, leaves, shape) for leaves in elements.values()}
    if len(inner) > 1:
        raise IrregularError(name)
    return inner.pop()


def _element(name: str, leaves: list[tuple[str, str]], shape: Shape) -> Outlined:
    if len(leaves) == 1 and not leaves[0][0]:
        return Outlined(shape, leaves[0][1])
    if not all(rest for rest, _ in leaves):
        raise IrregularError(name)
    return Outlined(shape, members=tuple(outline(leaves).items()))
