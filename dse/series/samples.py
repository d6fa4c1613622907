"""Columns of files → samples: checked times, values in SI and of the port's type."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Causality, Component, Kind, Type, Value
from dse.domain.time_series import Interpolation, Missing, Outside, Series, TableFile, TimeSeriesSource
from dse.errors import Location, Problem, Problems, closest, fail, raise_if_any
from dse.series.columns import Place, RawColumn, find_column, unit_of, usual_time
from dse.series.csv_table import MISSING, NUMBER, TextTable, read_text_table
from dse.series.mdf_table import read_channel
from dse.series.parquet_table import read_parquet
from dse.units import DIMENSIONLESS, Unit, counts_otherwise, describe, parse_unit

MOST_SAMPLES = 400_000
"""Of one column; a day at 4 Hz, or an hour at 100 Hz. They become C that is compiled."""

MOST_NUMBERS = 1_000_000
"""Of one component, times included."""

_INCREASING = "times must increase; a jump is two rows a little apart, or 'interpolation: previous'"

_LONGEST_RUN = 1e7
"""Seconds; no run is longer, so that a series that begins later counts from an epoch."""


@dataclass(frozen=True, slots=True)
class Samples:
    """What the output *port* gives: *values* in SI (items by number) at *times*, in s after *first*, increasing."""

    port: str
    type: Type
    times: NDArray[np.float64]
    values: NDArray[np.float64]
    first: float
    interpolation: Interpolation
    outside: Outside


def read_samples(component: Component, source: TimeSeriesSource) -> tuple[Samples, ...]:
    """The samples of every output of *component*. Raises DseError with all that is wrong with files and component."""
    raise_if_any(_misfits(component, source))
    problems, found, tables = Problems(), [], dict[TableFile, TextTable]()
    types = {port.name: port.type for port in component.interface.ports}
    for series in source.series:
        with problems:
            samples = _samples(series, types[series.port], tables)
            problems += _out_of_reach(samples, series, _start_of(component, series.port), source.stop)
            found.append(samples)
    numbers = sum(2 * len(samples.times) for samples in found)
    if numbers > MOST_NUMBERS:
        what = f"component '{component.name}' has {numbers:,} numbers in its series, more than {MOST_NUMBERS:,}"
        problems.add(what, component.where, "use several components, or fewer samples")
    raise_if_any(problems)
    return tuple(found)


PARAMETERS: Mapping[str, Type] = {"offset": Type(Kind.REAL, parse_unit("s")), "gain": Type(Kind.REAL)}
"""What may be declared as a parameter: for all series, or as ``PORT.offset`` for one."""


def _start_of(component: Component, port: str) -> float:
    declared = component.parameter(f"{port}.offset") or component.parameter("offset")
    value: Value = declared.start if declared else 0.0
    return float(value)


def _misfits(component: Component, source: TimeSeriesSource) -> list[Problem]:
    """Ports without a series, series without a port, parameters that mean nothing."""
    problems = Problems()
    outputs = {port.name: port for port in component.interface.ports if port.causality is Causality.OUTPUT}
    given = {series.port for series in source.series}
    for series in source.series:
        port = outputs.get(series.port)
        if port is None:
            what = f"'{series.port}' is not an output of {component.interface.name}"
            problems.add(what, series.where, closest(series.port, outputs))
        elif port.type.kind is not Kind.REAL and series.interpolation is Interpolation.LINEAR:
            what = f"'{series.port}' is {port.type}: between two of its values there is none"
            problems.add(what, series.where, "leave out 'interpolation', or set 'previous'")
        elif port.type.kind is not Kind.REAL and series.outside is Outside.ERROR:
            what = f"'{series.port}' is {port.type}, which has no value for an error"
            problems.add(what, series.where, "set 'outside: hold' or 'periodic'")
    for port in component.interface.ports:
        if port.causality is Causality.INPUT:
            what = f"a time series has no inputs, and {component.interface.name} has '{port.name}'"
            problems.add(what, component.where, "implement an interface with outputs only")
        elif port.name not in given:
            problems.add(f"the output '{port.name}' has no column", component.where, "add it under 'columns'")
    known = {name for ending in PARAMETERS for name in (ending, *(f"{port}.{ending}" for port in outputs))}
    for parameter in component.parameters:
        wanted = PARAMETERS.get(parameter.name.rpartition(".")[2])
        if parameter.name not in known or wanted is None:
            what = f"a time series has no parameter '{parameter.name}'"
            problems.add(what, parameter.where, closest(parameter.name, known))
        elif parameter.type.kind is not Kind.REAL or parameter.type.unit.dimension != wanted.unit.dimension:
            what = f"'{parameter.name}' must be {describe(wanted.unit.dimension)}, not {parameter.type}"
            problems.add(what, parameter.where)
    return problems


def _samples(series: Series, type_: Type, tables: dict[TableFile, TextTable]) -> Samples:
    time, column = _columns(series, tables)
    if len(time.cells) > MOST_SAMPLES:
        what = f"'{column.heading}' has {len(time.cells):,} samples, more than {MOST_SAMPLES:,}"
        raise fail(what, series.where, "cut out what is used, or take every n-th row")
    seconds, values = _seconds(time, series.where), _values(column, type_, series.where)
    absent = np.isnan(seconds) | np.isnan(values)
    if absent.any() and series.missing is Missing.ERROR:
        row = int(np.argmax(absent))
        name = time.heading if np.isnan(seconds[row]) else column.heading
        more = f", as in {int(absent.sum()) - 1:,} more" if absent.sum() > 1 else ""
        what = f"there is no value of '{name}' in this row{more}"
        raise fail(what, column.where(row), "set 'missing: skip' to leave out such rows")
    rows = np.flatnonzero(~absent)
    seconds, values = seconds[rows], values[rows]
    for name, numbers in ((time.heading, seconds), (column.heading, values)):
        if not np.isfinite(numbers).all():
            raise fail(f"'{name}' is infinite", column.where(int(rows[np.argmin(np.isfinite(numbers))])))
    if len(seconds) < 2:
        raise fail(f"'{column.heading}' has fewer than two samples", series.where, "give the input a value instead")
    steps = np.diff(seconds)
    if not (steps > 0).all():
        at = int(np.argmin(steps > 0))
        how = "does not advance" if steps[at] == 0 else "goes back"
        what = f"the time {how}: {seconds[at + 1]:.12g} s after {seconds[at]:.12g} s"
        raise fail(what, time.where(int(rows[at + 1])), _INCREASING)
    usual = Interpolation.LINEAR if type_.kind is Kind.REAL else Interpolation.PREVIOUS
    first = float(seconds[0])
    return Samples(series.port, type_, seconds - first, values, first, series.interpolation or usual, series.outside)


def _columns(series: Series, tables: dict[TableFile, TextTable]) -> tuple[RawColumn, RawColumn]:
    """The times and the values of *series* as they stand in its file."""
    path, where = series.file.path, series.where
    match path.suffix:
        case ".mf4" | ".mdf":
            return read_channel(series)
        case ".parquet":
            time, column = read_parquet(path, lambda names: _places(series, names, len(names)), where)
            return time, column
    if series.file not in tables:
        tables[series.file] = read_text_table(series.file, where)
    table = tables[series.file]
    time, column = table.columns(_places(series, table.headings, table.width))
    return time, column


def _places(series: Series, headings: Sequence[str], count: int) -> tuple[Place, Place]:
    where = series.where
    time = find_column(series.time, headings, count, where) if series.time else usual_time(headings, where)
    return time, find_column(series.column, headings, count, where)


def _seconds(column: RawColumn, where: Location) -> NDArray[np.float64]:
    """Times in seconds; of dates, after the first. NaN where there is none."""
    cells = column.cells
    if cells.dtype == object:
        absent = [text.lower() in MISSING for text in cells]
        if not all(absent) and NUMBER.fullmatch(cells[absent.index(False)]) is None:
            dates = [None if absent[row] else _date(text, column, row) for row, text in enumerate(cells)]
            cells = np.array(dates, dtype="datetime64[ns]")
    if cells.dtype.kind == "M":
        first = cells[~np.isnat(cells)][:1]
        after = cells - first if len(first) else cells - cells
        seconds: NDArray[np.float64] = after / np.timedelta64(1, "ns") / 1e9
        return seconds
    unit = unit_of(column, where)
    second = PARAMETERS["offset"].unit
    if unit is not None and unit.dimension != second.dimension:
        raise fail(
            f"'{column.heading}' is in {unit}, which is not a unit of time", where, "name the column of the time"
        )
    return _in_si(_numbers(column, None), unit or second)


def _date(text: str, column: RawColumn, row: int) -> np.datetime64:
    try:
        read = datetime.fromisoformat(text)
    except ValueError:
        hint = "seconds, numbers in the unit of the heading, or dates as 2026-03-01T12:30:00.5"
        raise fail(f"'{text}' is not a time", column.where(row), hint) from None
    shift = read.utcoffset()
    return np.datetime64(read.replace(tzinfo=None)) - np.timedelta64(shift or 0)


def _values(column: RawColumn, type_: Type, where: Location) -> NDArray[np.float64]:
    """Values in SI, truth values as 0 and 1, items by their numbers; NaN where there is none."""
    if type_.kind is Kind.REAL:
        unit = unit_of(column, where)
        if unit is None and type_.unit.dimension:
            hint = f"state it, as 'column: {column.heading.removeprefix('column ')} [{type_.unit}]'"
            raise fail(f"no unit is given for '{column.heading}'", where, hint)
        unit = unit or DIMENSIONLESS
        if unit.dimension != type_.unit.dimension or counts_otherwise(unit.symbol, type_.unit.symbol):
            found = describe(unit.dimension) if unit.dimension != type_.unit.dimension else str(unit)
            what = f"'{column.heading}' is {found}, the input is in {type_.unit or 'no unit'}"
            raise fail(what, where, "name another column, or state its unit")
        return _in_si(_numbers(column, None), unit)
    values = _numbers(column, type_)
    highest = {Kind.BOOLEAN: 1, Kind.ENUMERATION: len(type_.items) - 1}.get(type_.kind, 2**31 - 1)
    lowest = -(2**31) if type_.kind is Kind.INTEGER else 0
    with np.errstate(invalid="ignore"):
        wrong = ~np.isnan(values) & ((values != np.floor(values)) | (values < lowest) | (values > highest))
    if wrong.any():
        row = int(np.argmax(wrong))
        raise fail(f"{values[row]:g} in '{column.heading}' is not a value of {type_}", column.where(row))
    return values


def _numbers(column: RawColumn, type_: Type | None) -> NDArray[np.float64]:
    """The cells as numbers; words of *type_* as theirs."""
    cells: NDArray[Any] = column.cells
    if cells.dtype.kind == "f":
        return np.array(cells, dtype=np.float64)
    if cells.dtype.kind == "M":
        raise fail(f"'{column.heading}' has dates, no numbers", column.where(0))
    words: dict[str, float] = {}
    if type_ is not None and type_.kind is Kind.ENUMERATION:
        words = {item: float(number) for number, item in enumerate(type_.items)}
    elif type_ is not None and type_.kind is Kind.BOOLEAN:
        words = {word: float(word.lower() == "true") for word in ("true", "false", "True", "False", "TRUE", "FALSE")}
    numbers = []
    for row, text in enumerate(cells):
        if text in words:
            numbers.append(words[text])
        elif NUMBER.fullmatch(text):
            numbers.append(float(text))
        elif text.lower() in MISSING:
            numbers.append(np.nan)
        else:
            kind = type_ or "a number"
            raise fail(f"'{text}' in '{column.heading}' is not {kind}", column.where(row), closest(text, words))
    return np.array(numbers, dtype=np.float64)


def _in_si(values: NDArray[np.float64], unit: Unit) -> NDArray[np.float64]:
    """*values* of *unit* in SI; numerator and denominator apart, so that 36 km/h are 10 m/s to the last bit."""
    numerator, denominator = (float(part) for part in unit.factor.as_integer_ratio())
    scaled = values * numerator / denominator
    return scaled + float(unit.offset) if unit.offset else scaled  # -0.0 stays what it is


def _out_of_reach(samples: Samples, series: Series, start: float, stop: float | None) -> list[Problem]:
    """A series that a run from *start* on would never meet, or leaves where that is an error."""
    first, last = samples.first, samples.first + float(samples.times[-1])
    end = start + (_LONGEST_RUN if stop is None else stop)
    reach = f"'{series.port}': its series goes from {first:.9g} s to {last:.9g} s"
    problems = Problems()
    if samples.outside is not Outside.PERIODIC and (end <= first or start >= last):
        what = f"{reach}, the run from {start:.9g} s on never meets it"
        problems.add(what, series.where, f"set where the run begins, as 'offset: {first:.9g} s'")
    elif samples.outside is Outside.ERROR and stop is not None:
        slack = 1e-9 * (1.0 + abs(first) + abs(last))
        if start < first - slack or end > last + slack:
            what = f"{reach}, the run from {start:.9g} s to {end:.9g} s, and 'outside' is 'error'"
            problems.add(what, series.where, "set 'outside: hold' or 'periodic', or shorten the run")
    return problems
