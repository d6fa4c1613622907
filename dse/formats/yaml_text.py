"""Names, texts, values and parameters as YAML that reads back as the same."""

from __future__ import annotations

import json
import math
import re
from fractions import Fraction

from dse.domain.component import Kind, Parameter
from dse.errors import Location, fail
from dse.units import Unit

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_PLAIN_TEXT = re.compile(r"[A-Za-z_][A-Za-z0-9_ ./<>=+*^%()-]*")
_OTHERS = frozenset({"null", "true", "false"})
# What ends a line in YAML, and not in JSON.
_ENDS_OF_LINES = {0x85: "\\N", 0x2028: "\\L", 0x2029: "\\P", 0xFEFF: "\\uFEFF"}


def write_parameter(parameter: Parameter) -> str:
    """A parameter as one mapping. Raises DseError for a value that its unit cannot say."""
    type_ = parameter.type
    start = parameter.start
    entries = [f"start: {write_value(start, type_.unit, parameter.where)}"]
    for key, bound in (("min", parameter.minimum), ("max", parameter.maximum)):
        if bound is not None:
            entries.append(f"{key}: {write_value(bound, type_.unit, parameter.where)}")
    if type_.kind is Kind.ENUMERATION:
        entries.append(f"enum: [{', '.join(map(write_name, type_.items))}]")
    elif type_.kind is Kind.REAL:
        entries.append(f"unit: {write_text(type_.unit.symbol or '1')}")
    else:
        entries.append(f"type: {type_.kind}")
    if not parameter.tunable:
        entries.append("tunable: false")
    if parameter.title:
        entries.append(f"title: {write_text(parameter.title)}")
    return f"{{{', '.join(entries)}}}"


def write_value(value: float | int | bool | str, unit: Unit, where: Location | None) -> str:
    """The shortest number in *unit* that reads as the SI *value*, to the last bit. Raises DseError if there is none."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return write_text(value)
    if isinstance(value, int):
        return str(value)
    near = unit.from_si(value)
    # The shortest first: what was read as 120 km/h is written so, though its SI number is 120.00000000000001 km/h.
    shorter = (float(f"{near:.{digits}g}") for digits in range(1, 18))
    for number in (*shorter, math.nextafter(near, math.inf), math.nextafter(near, -math.inf)):
        if math.isfinite(number) and float(Fraction(repr(number)) * unit.factor + unit.offset) == value:
            return repr(number)
    raise fail(f"{value} in SI is no floating-point number of {unit}", where, "give it in an SI unit")


def write_name(name: str) -> str:
    """A name, quoted if it needs to be."""
    return name if _PLAIN.fullmatch(name) and name.lower() not in _OTHERS else json.dumps(name)


def write_text(text: str) -> str:
    """A YAML scalar that reads as *text*: as it is if it looks like nothing else, in double quotes otherwise."""
    if _PLAIN_TEXT.fullmatch(text) and not text.endswith(" ") and text.lower() not in _OTHERS:
        return text
    return json.dumps(text, ensure_ascii=False).translate(_ENDS_OF_LINES)
