"""Wires as connections: what units do by themselves is left to them, all else is written as a transformation."""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from xml.etree import ElementTree as ET

from dse.domain.component import Kind
from dse.domain.fmu import Variable
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import fail
from dse.interchange.resolving.carry import Carry, ConversionError
from dse.interchange.resolving.conversion import convert, form_of_variable

_EQUAL = Fraction(1, 10**12)
"""Relative difference up to which two conversions of a unit are the same, rounded otherwise."""


def add_connection(group: ET.Element, wire: Wire, system: SystemStructure, names: Mapping[str, str]) -> None:
    """A connection that carries what *wire* carries, as the FMUs see it. Raises DseError if it ends at a parameter."""
    source, target = system.element(wire.source), system.element(wire.target)
    start, start_indices = _split(wire.source_variable, source)
    end, end_indices = _split(wire.target_variable, target)
    if end.causality == "parameter":
        ends = f"{wire.source}.{start.name} -> {wire.target}.{end.name}"
        what = f"{ends}: SSP has no connection that tunes a parameter"
        raise fail(what, hint="give the parameter a value, or make it an input of the component")
    said = {"startElement": names[wire.source], "startConnector": start.name}
    if start_indices:
        said["startIndices"] = start_indices
    said |= {"endElement": names[wire.target], "endConnector": end.name}
    if end_indices:
        said["endIndices"] = end_indices
    connection = ET.SubElement(group, "ssd:Connection", said)
    raw = _raw(wire, source.conversions.get(start.name), target.conversions.get(end.name))
    if _is_by_itself(raw, start, source, end, target):
        return
    if raw.table is None:
        # The transformation is in the FMUs' own units, so that nothing may be converted before.
        connection.set("suppressUnitConversion", "true")
        if not raw.is_linear_identity:
            try:
                factor, offset = raw.numbers
            except ConversionError as error:
                raise fail(f"{said['startElement']}.{start.name} -> {said['endElement']}.{end.name}: {error}") from None
            linear = {"factor": repr(factor), "offset": repr(offset)}
            ET.SubElement(connection, "ssc:LinearTransformation", linear)
        return
    is_flag = start.kind is Kind.BOOLEAN
    mapping = "BooleanMappingTransformation" if is_flag else "IntegerMappingTransformation"
    table = ET.SubElement(connection, f"ssc:{mapping}")
    for value, becomes in sorted(raw.table.items()):
        pair = [str(bool(number)).lower() if is_flag else str(number) for number in (value, becomes)]
        ET.SubElement(table, "ssc:MapEntry", source=pair[0], target=pair[1])


def carries_the_same(wire: Wire, system: SystemStructure, source: Conversion | None, target: Conversion | None) -> bool:
    """Whether a plain wire between FMUs with these conversions carries what *wire* does, as the FMUs see it."""
    start, end = system.element(wire.source), system.element(wire.target)
    own = (
        start.conversions.get(start.model.variable_of(wire.source_variable).name),
        end.conversions.get(end.model.variable_of(wire.target_variable).name),
    )
    plain = Wire(wire.source, wire.source_variable, wire.target, wire.target_variable)
    try:
        return _is_same(_raw(wire, *own), _raw(plain, source, target))
    except ConversionError:
        return False


def _split(label: str, element: Element) -> tuple[Variable, str]:
    """The variable of a label, and its indices as SSP writes them, "" for all of it."""
    variable = element.model.variable_of(label)
    return variable, re.sub(r"\D+", " ", label.removeprefix(variable.name)).strip()


def _is_by_itself(raw: Carry, start: Variable, source: Element, end: Variable, target: Element) -> bool:
    """Whether a program that reads the package makes *raw* of a connection without a transformation."""
    try:
        return _is_same(raw, convert(form_of_variable(start, source.model), form_of_variable(end, target.model)))
    except ConversionError:
        return False


def _raw(wire: Wire, source: Conversion | None, target: Conversion | None) -> Carry:
    """From a value in the source's FMU to that in the target's."""
    way = Carry.outwards(source)
    if wire.items:
        way = way.then(Carry(table={int(a): int(b) for a, b in wire.items}))
    else:
        way = way.then(Carry.of(wire.factor, wire.offset))
    return way.then(Carry.inwards(target))


def _is_same(a: Carry, b: Carry) -> bool:
    if a.table or b.table:
        first, second = a.table or {}, b.table or {}
        return all(first.get(value, value) == second.get(value, value) for value in {*first, *second})
    scale = abs(b.factor) + abs(b.offset)
    return abs(a.factor - b.factor) <= _EQUAL * abs(b.factor) and abs(a.offset - b.offset) <= _EQUAL * scale
