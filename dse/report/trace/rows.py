"""A part's outputs as JSON: ``motion.speed`` is a member of an object, ``load[2]`` the second item of an array.

Viewers find them by paths such as ``/signals/chassis.motion.speed`` and ``/signals/chassis.load[1]`` (from 0).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import TypeAlias

from dse.domain.component import Type
from dse.report.content.data import Floats

_PIECE = re.compile(r"[^.,\[\]]+")
_IN_ARRAY = re.compile(r"\]\.")

Tree: TypeAlias = "str | dict[str, Tree] | list[Tree]"
"""A signal; a structure's members by their names; an array's items."""


def trees_of(signals: Iterable[str]) -> dict[str, Tree]:
    """The *signals* by their parts, without arrays of structures: these are in the scene and in the messages of OSI."""
    parts: dict[str, list[str]] = {}
    for name in sorted(filter(is_in_row, signals)):
        parts.setdefault(name.split(".", 1)[0], []).append(name)
    return {part: _tree_of(part, names) for part, names in parts.items()}


def is_in_row(signal: str) -> bool:
    """Whether *signal* is in the rows of its part."""
    return not _IN_ARRAY.search(signal)


def _tree_of(part: str, signals: Sequence[str]) -> Tree:
    ways = ((_PIECE.findall(signal[len(part) :]), signal) for signal in signals)
    # Indices with zeros before them, so that the tenth comes after the second.
    return _tree(sorted((tuple(each.zfill(9) if each.isdigit() else each for each in way), name) for way, name in ways))


def _tree(ways: Sequence[tuple[tuple[str, ...], str]]) -> Tree:
    if not ways[0][0]:
        return ways[0][1]
    groups = groupby(ways, key=lambda each: each[0][0])
    inner = {first: _tree([(way[1:], name) for way, name in group]) for first, group in groups}
    return list(inner.values()) if next(iter(inner)).isdigit() else inner


def row_of(tree: Tree, signals: Mapping[str, Floats], at: int) -> object:
    """The outputs in row *at*; a number that JSON does not have is null."""
    if isinstance(tree, str):
        number = float(signals[tree][at])
        return number if abs(number) < float("inf") else None
    if isinstance(tree, list):
        return [row_of(each, signals, at) for each in tree]
    return {name: row_of(each, signals, at) for name, each in tree.items()}


def schema_of(tree: Tree, types: Mapping[str, Type]) -> dict[str, object]:
    """The JSON Schema of `row_of`, which states the units."""
    if isinstance(tree, str):
        return {"type": "number", "description": str(types[tree])}
    if isinstance(tree, list):
        return {"type": "array", "items": schema_of(tree[0], types)}
    return {"type": "object", "properties": {name: schema_of(each, types) for name, each in tree.items()}}
