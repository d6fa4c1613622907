"""One column of a file as it stands there, and which one a user means."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from dse.errors import Location, closest, fail
from dse.units import DIMENSIONLESS, Unit, UnitError, parse_unit

LARGEST_FILE = 256_000_000
"""Bytes; a text of that size holds far more than `dse.series.samples.MOST_SAMPLES`."""


@dataclass(frozen=True, slots=True)
class RawColumn:
    """The *cells* of a column from the first row on: texts, numbers (NaN where there is none) or datetime64.

    *stated* is the unit the user gives it, *unit* that of the file, "" for none; *where* tells a row's place.
    """

    heading: str
    stated: str
    unit: str
    cells: NDArray[Any]
    where: Callable[[int], Location]


@dataclass(frozen=True, slots=True)
class Place:
    """A column by its *index* from 0, with the unit the user stated for it."""

    index: int
    stated: str = ""


def find_column(wanted: str | int, headings: Sequence[str], count: int, where: Location) -> Place:
    """The column *wanted*: its heading, also without its unit or with one stated, or its number from 1.

    Raises DseError.
    """
    name, stated = split_unit(str(wanted))
    if name.isdecimal() and (isinstance(wanted, int) or name not in _names(headings)):
        if not 0 < int(name) <= count:
            raise fail(f"there is no column {name}: the file has {count}", where)
        return Place(int(name) - 1, stated)
    if not headings:
        raise fail("the file has no headings", where, "give the number of the column, as 'column: 2 [m/s]'")
    for names, text, unit in ((headings, wanted, ""), (headings, name, stated), (_names(headings), name, stated)):
        found = [index for index, heading in enumerate(names) if heading == text]
        if len(found) > 1:
            numbers = " and ".join(str(index + 1) for index in found)
            raise fail(f"columns {numbers} are both '{text}'", where, "give the number of the one that is meant")
        if found:
            return Place(found[0], unit)
    raise fail(f"there is no column '{wanted}'", where, closest(str(wanted), filter(None, headings)))


def usual_time(headings: Sequence[str], where: Location) -> Place:
    """The column of times where none is named: the one called ``time`` or ``t``. Raises DseError."""
    found = [index for index, name in enumerate(_names(headings)) if name.lower() in ("time", "t")]
    if len(found) != 1:
        raise fail("the column of the time is not clear", where, "name it, as 'time: Timestamp [ms]' or 'time: 1'")
    return Place(found[0])


def split_unit(heading: str) -> tuple[str, str]:
    """``v [km/h]`` or ``v (km/h)`` as (``v``, ``km/h``); no unit is ""."""
    heading = heading.strip()
    for first, last in ("[]", "()"):
        if heading.endswith(last) and first in heading:
            name, _, unit = heading[:-1].rpartition(first)
            return name.strip(), unit.strip()
    return heading, ""


def unit_of(column: RawColumn, where: Location) -> Unit | None:
    """The unit of *column*; None if nobody states one. Raises DseError: one nobody knows, or two that differ."""
    try:
        stated = parse_unit(column.stated) if column.stated else None
    except UnitError as error:
        raise fail(str(error), where, "write it as 'm/s2', 'N.m', 'km/h', 'kWh' or '%'") from None
    found: Unit | None = None
    with suppress(UnitError):
        found = _from_file(column.unit)
    if column.unit and found is None and stated is None:
        name = split_unit(column.heading)[0]
        what = f"'{column.heading}' has the unknown unit '{column.unit}'"
        raise fail(what, where, f"state the unit that is meant: '{name} [m/s]'")
    if stated is not None and found is not None and not _are_same(stated, found):
        raise fail(f"'{column.heading}' is in {column.unit}, not in {column.stated}", where, "leave out the unit here")
    return stated or found


def _from_file(text: str) -> Unit | None:
    if text in ("-", "–", "[-]"):
        return DIMENSIONLESS
    return parse_unit(text) if text else None


def _are_same(a: Unit, b: Unit) -> bool:
    return (a.factor, a.offset, a.dimension) == (b.factor, b.offset, b.dimension)


def _names(headings: Sequence[str]) -> list[str]:
    return [split_unit(heading)[0] for heading in headings]
