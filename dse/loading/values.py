"""Values a user writes for ports and parameters, checked against their type."""

from __future__ import annotations

import re
from fractions import Fraction

from dse.domain.component import Kind, Type, Value
from dse.errors import Location, closest, fail
from dse.expression import KEYWORDS
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


def read_type(text: str, where: Location) -> Type:
    """The type of a port: a unit, ``bool``, ``int`` or ``enum[a, b]``. Raises DseError."""
    text = text.strip()
    if text == "bool":
        return Type(Kind.BOOLEAN)
    if text == "int":
        return Type(Kind.INTEGER)
    if text.startswith("enum[") and text.endswith("]"):
        items = tuple(item.strip() for item in text[5:-1].split(","))
        if not all(item.isidentifier() for item in items) or len(set(items)) != len(items):
            raise fail(f"the items of '{text}' must be different names", where, "as enum[speed, distance]")
        reserved = [item for item in items if item in KEYWORDS]
        if reserved:
            raise fail(f"the item '{reserved[0]}' is a word of the expression language", where, "choose another word")
        return Type(Kind.ENUMERATION, items=items)
    return Type(Kind.REAL, read_unit(text, where))


def _whole(raw: Raw, where: Location) -> int:
    match = _NUMBER.fullmatch(str(raw).strip()) if not isinstance(raw, bool) else None
    number = Fraction(match[0]) if match else None
    if number is None or number.denominator != 1:
        raise fail(f"expected a whole number, found '{raw}'", where)
    if abs(number) > LARGEST_WHOLE:
        raise fail(f"the whole number {raw} is too large", where, f"at most {LARGEST_WHOLE}")
    return int(number)


_NUMBER = re.compile(r"[+-]?\d{1,40}(?:\.\d{0,40})?(?:[eE][+-]?\d{1,2})?", re.ASCII)
