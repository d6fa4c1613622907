"""Points from a table that the user wrote."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from pathlib import Path
from typing import Any, ClassVar, Self

from pydantic import Field

from dse.domain.sampler import Brief, DesignVariable, Placing, Point
from dse.errors import Location, Problem, closest, fail, raise_if_any
from dse.exploration.one_shot_sampler import ValueSampler, require_few
from dse.formats import shown
from dse.loading import Surroundings, named_file, read_unit
from dse.units import Unit

_MAX_BYTES = 500_000_000


class Csv(ValueSampler):
    """The rows of a CSV *file*: a column for each design variable, headed ``name [unit]``, or by the name alone if it
    is in SI anyway.

    Columns that are headed otherwise are refused. The stored definition holds the points, not the file's name. With
    *even* the rows are a sample of the whole space, as a Latin hypercube is: findings take shares of them for shares of
    it.
    """

    name: ClassVar[str] = "csv"
    examples: ClassVar[tuple[Mapping[str, Any], ...]] = ({"file": "points.csv"},)
    example_files: ClassVar[Mapping[str, str]] = {"points.csv": "part.y,part.x\n-0.5,0.25\n1,2\n"}

    file: str
    even: bool = False
    rows: tuple[Point, ...] = Field(default=(), exclude=True)

    def options(self) -> Mapping[str, Any]:
        """The points."""
        return {"rows": [list(row) for row in self.rows]} | ({"even": True} if self.even else {})

    @classmethod
    def placed(cls, options: Mapping[str, Any]) -> Placing:
        """Evenly if the user says so."""
        return Placing.EVEN if options.get("even") else Placing.CHOSEN

    def settled(self, around: Surroundings) -> Self:
        """With the rows of the file; raises DseError with every cell that is wrong, at its line."""
        where = around.place("file")
        if "rows" in self.model_fields_set:
            raise fail("unknown key 'rows'", around.place("rows"), "write the points into a file")
        path = named_file(around.entry.document.path.parent, self.file, around.inside, (".csv",), where)
        lines = list(csv.reader(io.StringIO(_text(path, where), newline="")))
        if not lines:
            raise fail(f"{shown(path)} is empty", where, "head a column for each design variable")
        require_few(len(lines) - 1, where)
        if {variable.name for variable in around.variables} != around.names:
            return self  # what is wrong with a variable is told at its place
        columns = _columns(path, lines[0], around.variables)
        problems: list[Problem] = []
        rows = [_row(path, number, line, columns, problems) for number, line in _numbered(lines)]
        raise_if_any(problems)
        if not rows:
            raise fail(f"{shown(path)} has no row below its head", where, "write a line for each point")
        # Rows that stand there twice are one run.
        return self.model_copy(update={"rows": tuple(dict.fromkeys(tuple(row) for row in rows))})

    def values(self, brief: Brief) -> Sequence[Point]:  # noqa: ARG002  # as every sampler has it
        """The rows, in the order of the file."""
        return self.rows


_Columns = Sequence[tuple[int, DesignVariable, Unit]]
"""For each design variable, in their order: which column holds it, in which unit."""


def _text(path: Path, where: Location) -> str:
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise fail(f"{shown(path)} is larger than {_MAX_BYTES // 1_000_000} MB", where, "split the study")
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        raise fail(f"{shown(path)} is not UTF-8 text (byte {error.start})", where, "save it as UTF-8") from None
    except OSError as error:
        raise fail(f"{shown(path)} cannot be read: {error.strerror or error}", where, "check its name") from None


def _columns(path: Path, head: Sequence[str], variables: Sequence[DesignVariable]) -> _Columns:
    line = Location(shown(path), 1, 1)
    if len(head) == 1 and ";" in head[0]:
        raise fail("the columns are separated by ';'", line, "save the table with commas")
    problems = []
    found: dict[str, tuple[int, Unit]] = {}
    known = {variable.name: variable for variable in variables}
    for index, heading in enumerate(head):
        # An element of an array has brackets of its own: those of the unit are the last ones.
        is_plain = heading.strip() in known or "[" not in heading
        name, bracket, symbol = (part.strip() for part in ((heading, "", "") if is_plain else heading.rpartition("[")))
        if name not in known:
            problems.append(Problem(f"the column '{name}' is not a design variable", line, closest(name, known)))
        elif name in found:
            problems.append(Problem(f"two columns are headed '{name}'", line, "remove one"))
        else:
            usual = known[name].unit
            unit = read_unit(symbol.rstrip("] "), line) if bracket else usual
            if unit.dimension != usual.dimension:
                what = f"the column '{name}' is in {unit}, the variable in {usual}"
                problems.append(Problem(what, line, "give a unit of the same kind"))
            elif not bracket and not usual.is_coherent:
                what = f"the column '{name}' may be in {usual} or in SI"
                problems.append(Problem(what, line, f"head it '{name} [{usual}]'"))
            found[name] = index, unit
    missing = [name for name in known if name not in found]
    problems += [Problem(f"there is no column '{name}'", line, "head one with it") for name in missing]
    raise_if_any(problems)
    return [(found[variable.name][0], variable, found[variable.name][1]) for variable in variables]


def _numbered(lines: Sequence[Sequence[str]]) -> Iterator[tuple[int, Sequence[str]]]:
    return ((number, line) for number, line in enumerate(lines[1:], 2) if any(cell.strip() for cell in line))


def _row(path: Path, number: int, line: Sequence[str], columns: _Columns, problems: list[Problem]) -> list[float]:
    point = []
    for index, variable, unit in columns:
        where = Location(shown(path), number, 1)
        cell = line[index].strip() if index < len(line) else ""
        if variable.labels and cell not in variable.labels:
            what = f"'{cell}' is not a value of {variable.name}"
            problems.append(Problem(what, where, closest(cell, variable.labels)))
            continue
        try:
            value = variable.values[variable.labels.index(cell)] if variable.labels else unit.to_si(_exact(cell))
        except ValueError:
            problems.append(Problem(f"'{cell}' is not a number for {variable.name}", where, "write 1.5 or 2e-3"))
            continue
        if not variable.low <= value <= variable.high:
            what = f"{variable.name} = {cell} is outside its range"
            problems.append(Problem(what, where, "widen the range in the study, or leave the row out"))
        point.append(value)
    return point


def _exact(cell: str) -> float | Fraction:
    """A number with all its digits, which in another unit than SI may be more than a double has."""
    value = float(cell)
    return Fraction(cell) if value and math.isfinite(value) else value


SAMPLER = Csv
