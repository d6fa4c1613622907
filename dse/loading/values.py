"""Values a user writes for ports and parameters, checked against their type."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import Any

from dse.domain.component import Kind, Type, Value
from dse.domain.labels import Shape
from dse.errors import Location, closest, fail
from dse.expression import KEYWORDS
from dse.formats import Entry
from dse.units import (
    DIMENSIONLESS,
    LARGEST,
    LARGEST_WHOLE,
    Quantity,
    Unit,
    UnitError,
    describe,
    parse_quantity,
    parse_unit,
)

Raw = str | int | float | bool
"""A value of a parameter as YAML reads it."""

Elements = list[Any]
"""Those of an array, in lists of lists where it has several dimensions."""


def read_unit(text: str, where: Location) -> Unit:
    """A unit the user wrote. Raises DseError."""
    try:
        return parse_unit(text)
    except UnitError as error:
        raise fail(str(error), where, "write it as 'm/s2', 'N.m', 'km/h', 'kWh', '%' or 'EUR'") from None


def read_quantity(raw: Raw, where: Location) -> Quantity:
    """A number with a unit; a bare number is a plain number. Raises DseError."""
    if isinstance(raw, bool):
        raise fail("expected a quantity, found a truth value", where, "write a number and a unit, as '70 km/h'")
    if isinstance(raw, int | float):
        if not abs(raw) <= LARGEST:
            raise fail(f"{raw} is not a finite number" if isinstance(raw, float) else "the number is too large", where)
        return Quantity(Fraction(repr(raw)), DIMENSIONLESS, repr(raw))
    try:
        return parse_quantity(raw)
    except UnitError as error:
        raise fail(str(error), where, "write a number and a unit, as '70 km/h'") from None


def read_number(raw: Raw, unit: Unit, where: Location) -> float:
    """An SI number of the dimension of *unit*; a bare number is taken to be in *unit*. Raises DseError."""
    quantity = read_quantity(raw, where)
    if not quantity.unit.symbol:
        si = quantity.si * unit.factor + unit.offset
        if abs(si) > LARGEST:
            raise fail(f"'{raw}' in {unit} is beyond the range of numbers", where)
        return float(si)
    if quantity.unit.dimension != unit.dimension:
        raise fail(
            f"wrong unit in '{raw}': expected {describe(unit.dimension)}, found {describe(quantity.unit.dimension)}",
            where,
            f"write it in {unit}" if str(unit) else "write a plain number",
        )
    return float(quantity.si)


def read_elements(raw: Raw | Elements, entry: Entry) -> tuple[Shape, list[tuple[Raw, Location]]]:
    """The shape of what is written at *entry*, and its values, row by row, each with its place. Raises DseError."""
    if not isinstance(raw, list):
        if not isinstance(raw, str | int | float):
            raise fail("expected a value, or a list of values", entry.where, "as [1, 2, 3]")
        return (), [(raw, entry.where)]
    if not raw:
        raise fail("the list is empty", entry.where, "write one value for each element, as [1, 2, 3]")
    rows = [read_elements(row, entry[number]) for number, row in enumerate(raw)]
    inner = rows[0][0]
    for number, (shape, _) in enumerate(rows):
        if shape != inner:
            raise fail("the rows of the list differ in length", entry[number].where, "as [[1, 2], [3, 4]]")
    return (len(rows), *inner), [value for _, values in rows for value in values]


def read_value(raw: Raw, type_: Type, where: Location) -> Value:
    """A value of *type_*: SI number, whole number, truth value, item or text. Raises DseError."""
    match type_.kind:
        case Kind.REAL:
            return read_number(raw, type_.unit, where)
        case Kind.BOOLEAN:
            if isinstance(raw, bool):
                return raw
            if raw in ("true", "false"):
                return raw == "true"
            raise fail(f"expected true or false, found '{raw}'", where)
        case Kind.INTEGER:
            return _whole(raw, where)
        case Kind.ENUMERATION:
            if isinstance(raw, str) and raw in type_.items:
                return raw
            raise fail(f"'{raw}' is not one of {type_}", where, closest(str(raw), type_.items))
        case Kind.TEXT:
            if isinstance(raw, str):
                return raw
            raise fail(f"expected text, found {raw}", where, "quote it")
        case Kind.BINARY:
            if isinstance(raw, str) and _BYTES.fullmatch(raw):
                return raw.lower()
            raise fail(f"expected bytes, found '{raw}'", where, "write them as hexadecimal digits in quotes: '0a1f'")


def split_shape(text: str, where: Location) -> tuple[str, Shape]:
    """``m[4, 2]`` as a type of single values and the sizes of an array, none of which is 0. Raises DseError."""
    match = _SIZED.fullmatch(text)
    if match is None or match[1] == "enum":
        return text, ()
    shape = tuple(int(size) for size in match[2].split(","))
    if 0 in shape:
        raise fail(f"'{text}' has no values", where, "sizes are 1 or more")
    return match[1].strip(), shape


def read_type(text: str, where: Location) -> Type:
    """The type of a port: a unit, ``bool``, ``int``, ``enum[a, b]``, ``string``, ``binary[media type]``. DseError."""
    text = text.strip()
    if text in _PLAIN_TYPES:
        return Type(_PLAIN_TYPES[text])
    if text.startswith("binary[") and text.endswith("]"):
        return Type(Kind.BINARY, media=" ".join(text[7:-1].split()))
    if text.startswith("enum[") and text.endswith("]"):
        items = tuple(item.strip() for item in text[5:-1].split(","))
        if not all(item.isidentifier() for item in items) or len(set(items)) != len(items):
            raise fail(f"the items of '{text}' must be different names", where, "as enum[speed, distance]")
        reserved = [item for item in items if item in KEYWORDS]
        if reserved:
            raise fail(f"the item '{reserved[0]}' is a word of the expression language", where, "choose another word")
        return Type(Kind.ENUMERATION, items=items)
    return Type(Kind.REAL, read_unit(text, where))


_PLAIN_TYPES = {str(kind): kind for kind in (Kind.BOOLEAN, Kind.INTEGER, Kind.TEXT, Kind.BINARY)}
_SIZED = re.compile(r"(.+?) *\[ *(\d{1,9}(?: *, *\d{1,9})*) *\]", re.ASCII)


def _whole(raw: Raw, where: Location) -> int:
    match = _NUMBER.fullmatch(str(raw).strip()) if not isinstance(raw, bool) else None
    number = Fraction(match[0]) if match else None
    if number is None or number.denominator != 1:
        raise fail(f"expected a whole number, found '{raw}'", where)
    if abs(number) > LARGEST_WHOLE:
        raise fail(f"the whole number {raw} is too large", where, f"at most {LARGEST_WHOLE}")
    return int(number)


_BYTES = re.compile(r"(?:[0-9A-Fa-f]{2})*")
_NUMBER = re.compile(r"[+-]?\d{1,40}(?:\.\d{0,40})?(?:[eE][+-]?\d{1,2})?", re.ASCII)
