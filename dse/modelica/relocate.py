"""Places in the FMU's own messages: the file's name within its package, wherever the package lies on this machine."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TypeVar

from dse.errors import Location
from dse.modelica.flat import Check, Relation
from dse.modelica.solved import Solved, System

B = TypeVar("B")


def relocated(solved: Solved, names: Mapping[str, str]) -> Solved:
    """*solved* with each file called by its name in *names*; blocks that are one object stay one object."""

    def place(where: Location | None) -> Location | None:
        return replace(where, file=names.get(where.file, where.file)) if where is not None else None

    systems: dict[int, System] = {}

    def blocks(found: Iterable[B]) -> tuple[B, ...]:
        return tuple(_moved(block, systems, place) for block in found)

    flat = replace(
        solved.flat,
        relations=tuple(_with_place(relation, place) for relation in solved.flat.relations),
        checks=tuple(_with_place(check, place) for check in solved.flat.checks),
    )
    return replace(
        solved,
        flat=flat,
        derivatives=blocks(solved.derivatives),
        outputs=blocks(solved.outputs),
        event=blocks(solved.event),
        initial=blocks(solved.initial),
        notes=tuple(_with_names(note, names) for note in solved.notes),
    )


def _with_names(text: str, names: Mapping[str, str]) -> str:
    """*text* with the place it begins with renamed."""
    path, colon, rest = text.partition(":")
    return f"{names[path]}{colon}{rest}" if path in names else text


P = TypeVar("P", Relation, Check)


def _with_place(item: P, place: Callable[[Location | None], Location | None]) -> P:
    return replace(item, where=place(item.where))


def _moved(block: B, systems: dict[int, System], place: Callable[[Location | None], Location | None]) -> B:
    if not isinstance(block, System):
        return block
    if id(block) not in systems:
        systems[id(block)] = replace(block, where=tuple(p for where in block.where if (p := place(where)) is not None))
    return systems[id(block)]  # type: ignore[return-value]  # a System for a System
