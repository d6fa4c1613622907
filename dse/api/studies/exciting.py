"""Inputs that move a component: steps at first, then sines, the same each time."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from dse.domain.component import Causality, Component, Interface, Kind, Port, Type
from dse.domain.time_series import Interpolation, Missing, Outside, Series, TableFile, TimeSeriesSource
from dse.errors import Location, fail
from dse.formats import shown

_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0
_HELD, _MORE_HELD = 20, 7
"""Steps that a level is held for, and by how many longer for each further input."""

_USUAL = {Kind.REAL: (-10.0, 10.0), Kind.INTEGER: (0.0, 10.0), Kind.BOOLEAN: (0.0, 1.0)}


@dataclass(frozen=True, slots=True)
class Column:
    """A column of a *file*, by heading or number from 1, in the unit that the file states, else in SI."""

    file: Path
    column: str | int


Given = tuple[float, float] | Column
"""Between what an input moves (SI; twice the same for a constant), or where its values are."""


def excitation(ports: Sequence[Port], given: Mapping[str, Given], step: float, steps: int, folder: Path) -> Component:
    """What gives the inputs *ports* values for so many steps of *step* s; its table lies in *folder*."""
    where = Location("inputs")
    series: list[Series] = []
    columns: list[tuple[Port, list[float]]] = []
    table = TableFile(folder / "inputs.csv")
    for place, port in enumerate(ports):
        known = given.get(port.name)
        if isinstance(known, Column):
            file, column, between = TableFile(known.file), known.column, None
            if not known.file.is_file():
                raise fail(f"no such file: {shown(known.file)}", hint=f"it is to feed '{port.name}'")
        else:
            columns.append((port, [*_moves(place, port.type, known, steps)]))
            file, column, between = table, len(columns) + 1, Interpolation.PREVIOUS
        series.append(Series(port.name, file, column, "", between, Outside.HOLD, Missing.ERROR, where))
    if columns:
        table.path.write_text("\n".join(_lines(columns, step)) + "\n", encoding="utf-8")
    outputs = tuple(Port(port.name, Causality.OUTPUT, port.type) for port in ports)
    names = {port.name: f"u{place}" for place, port in enumerate(ports)}
    source = TimeSeriesSource(tuple(series), steps * step)
    return Component("inputs of both", Interface("inputs of both", outputs, where), source=source, names=names)


def _lines(columns: Sequence[tuple[Port, Sequence[float]]], step: float) -> Iterator[str]:
    units = [
        f" [{port.type.unit}]" if port.type.kind is Kind.REAL and str(port.type.unit) else "" for port, _ in columns
    ]
    yield ";".join(["time [s]", *(f"u{place}{unit}" for place, unit in enumerate(units))])
    for k, values in enumerate(zip(*(values for _, values in columns), strict=True)):
        # Half a step before it is asked for, so that rounding does not decide.
        yield ";".join(map(repr, ((k - 0.5) * step, *values)))


def _moves(place: int, type_: Type, between: tuple[float, float] | None, steps: int) -> Iterator[float]:
    low, high = (
        between or (0.0, len(type_.items) - 1.0) if type_.kind is Kind.ENUMERATION else between or _USUAL[type_.kind]
    )
    held, middle, half = _HELD + _MORE_HELD * place, (low + high) / 2, (high - low) / 2
    for k in range(steps + 1):
        level = (k // held + 1 + place) * _GOLDEN % 1.0
        if type_.kind is not Kind.REAL:
            yield low + math.floor(level * (high - low + 1))
        elif 2 * k < steps:
            yield low + level * (high - low)
        else:
            turn = 2 * math.pi * k / (3 * held)
            yield middle + half * (0.7 * math.sin(turn) + 0.3 * math.sin(math.sqrt(7) * turn))
