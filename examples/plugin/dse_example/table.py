"""A kind of component as another package offers it: ``source: {kind: table, points: [[0, 0], [1, 2]]}``.

Its output ``y`` is the straight lines between the points at its input ``u``, times its parameter ``factor``.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from dse.plugins import Component, ComponentKind, Source, SourcePlace, SourceSection, build_generated, fail

Points = tuple[tuple[float, float], ...]


class TableSection(SourceSection):
    """The keys of ``source``."""

    points: list[list[float]]


@dataclass(frozen=True, slots=True)
class TableSource(Source):
    """*points* (u, y) in the order of the file."""

    kind = "table"
    label = "Table"

    points: Points


class TableKind(ComponentKind[TableSection, TableSource]):
    """The C of a table is written here and built as the kind ``c`` is."""

    section = TableSection

    def read(self, section: TableSection, place: SourcePlace) -> TableSource:
        """Points of two numbers each."""
        for number, point in enumerate(section.points):
            if len(point) != 2:
                raise fail("a point has two numbers", place.at("points", number), "points: [[0, 0], [1, 2]]")
        return TableSource(tuple((x, y) for x, y in section.points))

    def build(self, component: Component, source: TableSource, *, version: int, cache: Path | None) -> Path:
        """An FMU with its sources inside, which can be fused."""
        files = {"table.h": HEADER, "table.c": code(source.points)}
        return build_generated(component, files, "table", version=version, cache=cache)


KIND = TableKind()

HEADER = """\
#ifndef TABLE_H
#define TABLE_H
typedef struct {
    struct { double u; } in;
    struct { double y; } out;
    struct { double factor; } par;
} table;
void table_init(table *self);
void table_step(table *self, double h);
#endif
"""


def code(points: Points) -> str:
    """The C behind the header."""
    lines = ['#include "table.h"', "static double at(double u) {"]
    for (x, y), (end, top) in pairwise(points):
        lines.append(f"    if (u < {end!r}) return {y!r} + (u - {x!r}) * {(top - y) / (end - x)!r};")
    lines += [f"    return {points[-1][1]!r};", "}"]
    lines.append("void table_init(table *self) { self->out.y = self->par.factor * at(self->in.u); }")
    lines.append("void table_step(table *self, double h) { (void)h; table_init(self); }")
    return "\n".join(lines) + "\n"
