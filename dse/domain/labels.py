"""Names of single values in arrays and arrays of structures: ``ranges[2]``, ``objects[3].pose[1,2]``, counted from 1.

Ports and parameters are single values; an array is all whose names differ in nothing but the indices.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from itertools import product

Shape = tuple[int, ...]
"""Sizes of an array's dimensions, () for a single value."""

_INDICES = re.compile(r"\[(\d+(?:,\d+)*)\]", re.ASCII)


def element_names(name: str, shape: Shape) -> Iterator[str]:
    """A name for each value, row by row: *name* itself, or ``name[2]``, ``name[1,3]``."""
    if not shape:
        return iter((name,))
    ranges = (range(1, size + 1) for size in shape)
    return (f"{name}[{','.join(map(str, index))}]" for index in product(*ranges))


def wholes(label: str) -> Iterator[str]:
    """What *label* is a part of, the nearest first: ``a.b[2].c`` is one of ``a.b[2]``, of ``a.b`` and of ``a``."""
    for place in range(len(label) - 1, 0, -1):
        if label[place] in ".[":
            yield label[:place]


def is_part(label: str, whole: str) -> bool:
    """Whether *label* is *whole*, or a part of the group or array of that name."""
    return label.startswith(whole) and label[len(whole) : len(whole) + 1] in ("", ".", "[")


def array_of(label: str) -> str:
    """The array that *label* is an element of: ``a[1].b[2]`` is one of ``a[1].b``; "" if it is none."""
    return label[: label.rindex("[")] if label.endswith("]") else ""


def shapes(labels: Iterable[str]) -> dict[str, Shape]:
    """The shape of every array among *labels*, and of groups and single values, by name; inner ones ``objects[].pose``.

    The name of what all labels are parts of is "".
    """
    found: dict[str, Shape] = {}
    for label in labels:
        name = ""
        for text, written in _PIECES.findall(label):
            name += text
            shape = tuple(map(int, written.split(","))) if written else ()
            known = found.get(name, ())
            found[name] = tuple(map(max, shape, known)) if len(known) == len(shape) else max(known, shape, key=len)
            name += "[]" if shape else ""
    return found


_PIECES = re.compile(r"((?:^|\.)[^.\[]*)(?:\[(\d+(?:,\d+)*)\])?", re.ASCII)


def folded(labels: Iterable[str]) -> dict[str, str]:
    """What each label says with the sizes of arrays for its indices: all of ``objects[3].pose[1,2]`` share a text."""
    names = tuple(labels)
    sizes = shapes(names)
    found = {}
    for label in names:
        text = name = ""
        for piece, written in _PIECES.findall(label):
            text, name = text + piece, name + piece
            if written:
                text, name = f"{text}[{','.join(map(str, sizes[name]))}]", f"{name}[]"
        found[label] = text
    return found


def c_member(label: str) -> str:
    """*label* as C spells it: ``objects[3].pose[1,2]`` is ``objects[2].pose[0][1]``."""
    return _INDICES.sub(lambda found: "".join(f"[{int(index) - 1}]" for index in found[1].split(",")), label)


def spelled(shape: Shape) -> str:
    """*shape* in words."""
    return f"an array of {' x '.join(map(str, shape))}" if shape else "a single value"


def tightened(text: str) -> str:
    """*text* without the blanks that a person may write between indices."""
    return _LOOSE.sub(lambda found: found[0].replace(" ", ""), text)


_LOOSE = re.compile(r"\[[0-9, ]*\]")
