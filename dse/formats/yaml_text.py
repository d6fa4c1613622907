"""Names, texts, values and parameters as YAML that reads back as the same, and mappings of them."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import Any

from dse.domain.component import Kind, Parameter
from dse.domain.labels import Shape, array_of, element_names, shapes
from dse.errors import Location, fail
from dse.units import Unit

_PLAIN = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_PLAIN_TEXT = re.compile(r"[A-Za-z_][A-Za-z0-9_ ./<>=+*^%()-]*")
_OTHERS = frozenset({"null", "true", "false"})
# What ends a line in YAML, and not in JSON.
_ENDS_OF_LINES = {0x85: "\\N", 0x2028: "\\L", 0x2029: "\\P", 0xFEFF: "\\uFEFF"}


def dump_yaml(data: Mapping[str, Any]) -> str:
    """A file with plain *data*: mappings, lists, texts, numbers, truth values and None, which read back as the same."""
    from io import StringIO

    from ruamel.yaml import YAML

    yaml: Any = YAML(typ="safe", pure=True)  # whose types are narrower than what it takes
    yaml.default_flow_style = None  # what holds no mapping or list is written in one line
    yaml.sort_base_mapping_type_on_output = False
    yaml.width = 120
    text = StringIO()
    yaml.dump(data, text)
    return text.getvalue()


def write_file(data: Mapping[str, Any]) -> str:
    """A file with *data*: mappings and lists of what is written already, one entry a line."""
    return "\n".join(_block(data, 0)) + "\n"


def _block(data: Mapping[str, Any], level: int) -> Iterator[str]:
    pad = "  " * level
    for key, value in data.items():
        head = f"{pad}{write_name(key)}:"
        if isinstance(value, str) or not value:
            yield f"{head} {value or '{}'}"
            continue
        yield head
        if isinstance(value, Mapping):
            yield from _block(value, level + 1)
            continue
        for entry in value:
            first, *rest = [f"{pad}    {entry}"] if isinstance(entry, str) else _block(entry, level + 2)
            yield f"{pad}  - {first.lstrip()}"
            yield from rest


def write_data(value: Any) -> Any:
    """Plain data as `write_file` takes it: in one line where that is short, else one entry a line."""
    if isinstance(value, Mapping):
        return inline({str(key): write_data(entry) for key, entry in value.items()})
    return inline([write_data(entry) for entry in value]) if isinstance(value, list) else write_scalar(value)


def inline(written: Any) -> Any:
    """What `write_file` takes, with all that is short in one line."""
    if isinstance(written, str):
        return written
    if isinstance(written, Mapping):
        entries = {key: inline(value) for key, value in written.items()}
        line = write_flow(entries) if all(isinstance(value, str) for value in entries.values()) else ""
        return line if line and len(line) <= _SHORT else entries
    items = [inline(value) for value in written]
    line = f"[{', '.join(items)}]" if all(isinstance(item, str) for item in items) else ""
    return line if line and len(line) <= _SHORT else items


def write_scalar(value: Any) -> str:
    """A number, text, truth value or None; ranges of numbers and quantities without quotes."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return value if _PLAIN_RANGE.fullmatch(value) else write_text(value)
    return "null" if value is None else repr(value)


_SHORT = 100
_PLAIN_RANGE = re.compile(r"[0-9]+\.\.(?:[0-9]+|\*)|-?[0-9]+(?:\.[0-9]+)? [A-Za-z%][A-Za-z0-9/.^]*")
"""Texts that need no quotes: a range of numbers, a quantity."""


def write_flow(data: Mapping[str, str]) -> str:
    """A mapping in one line, of what is written already."""
    return f"{{{', '.join(f'{write_name(key)}: {value}' for key, value in data.items())}}}"


def write_parameter(parameter: Parameter, *others: Parameter) -> str:
    """A parameter as one mapping; with *others* an array, whose values they are. Raises DseError as `write_value`."""
    unit, where = parameter.type.unit, parameter.where
    stated = {"start": parameter.start, "min": parameter.minimum, "max": parameter.maximum}
    entries = {key: write_value(value, unit, where) for key, value in stated.items() if value is not None}
    array = array_of(parameter.name)
    if array:
        starts = {one.name: write_value(one.start, unit, where) for one in (parameter, *others)}
        entries["start"] = _nested(array, shapes(starts)[array], starts)
    match parameter.type.kind:
        case Kind.ENUMERATION:
            entries["enum"] = f"[{', '.join(map(write_name, parameter.type.items))}]"
        case Kind.REAL:
            entries["unit"] = write_text(str(unit) or "1")
        case kind:
            entries["type"] = str(kind)
    if not parameter.tunable:
        entries["tunable"] = "false"
    if parameter.random:
        entries["random"] = "true"
    if parameter.title:
        entries["title"] = write_text(parameter.title)
    return write_flow(entries)


def _nested(array: str, shape: Shape, texts: Mapping[str, str]) -> str:
    """The *texts* of an array's values as lists of lists."""
    rows = [texts[label] for label in element_names(array, shape)]
    for size in reversed(shape):
        rows = [f"[{', '.join(rows[at : at + size])}]" for at in range(0, len(rows), size)]
    return rows[0]


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
    raise fail(f"{value} in SI is not a floating-point number of {unit}", where, "give it in an SI unit")


def write_name(name: str) -> str:
    """A name, quoted if it needs to be."""
    return name if _PLAIN.fullmatch(name) and name.lower() not in _OTHERS else json.dumps(name)


def write_text(text: str) -> str:
    """A YAML scalar that reads as *text*: as it is if it looks like nothing else, in double quotes otherwise."""
    if _PLAIN_TEXT.fullmatch(text) and not text.endswith(" ") and text.lower() not in _OTHERS:
        return text
    return json.dumps(text, ensure_ascii=False).translate(_ENDS_OF_LINES)
