"""Connectors with their types, and the units and enumerations they name."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from xml.etree import ElementTree as ET

from dse.domain.component import Kind
from dse.domain.fmu import FmuModel, UnitDefinition, Variable
from dse.domain.system import Element
from dse.fmu import BASE_UNITS
from dse.interchange.resolving.carry import ConversionError
from dse.interchange.resolving.conversion import definition
from dse.interchange.structure import NamedUnit

_IN_VERSION_1 = {
    "Float64": "Real",
    "Int32": "Integer",
    **{name: name for name in ("Real", "Integer", "Boolean", "String", "Binary")},
}
"""Types of FMI that SSP 1.0 has a word for."""
_KINDS_1 = ("input", "output", "parameter", "calculatedParameter")


def needs_version_2(element: Element) -> bool:
    """Whether something of *element* cannot be said in SSP 1.0."""
    return any(
        variable.shape
        or variable.is_structural
        or (variable.kind is not Kind.ENUMERATION and variable.fmi_type not in _IN_VERSION_1)
        or (connected and variable.causality not in _KINDS_1)
        for variable, connected in _shown_variables(element)
    )


def _shown_variables(element: Element) -> Iterator[tuple[Variable, bool]]:
    yield from ((variable, True) for variable in (*element.inputs, *element.outputs))
    yield from ((element.model.variable_of(label), False) for label in (*element.start, *element.texts))


@dataclass(slots=True)
class Definitions:
    """The units and enumerations a file of this *version* of SSP names."""

    version: str
    units: dict[str, UnitDefinition] = field(default_factory=dict)
    enumerations: dict[str, Mapping[str, int]] = field(default_factory=dict)

    def unit(self, variable: Variable, model: FmuModel) -> str:
        """The name of the variable's unit in the file; "" if nobody says what it is."""
        if not variable.unit:
            return ""
        try:
            meant = definition(NamedUnit(variable.unit, model.units.get(variable.unit)))
        except ConversionError:
            return ""
        # Two FMUs may call different units the same; then the second connector goes without.
        return variable.unit if self.units.setdefault(variable.unit, meant) == meant else ""

    def enumeration(self, variable: Variable, component: str) -> str:
        """The name of the variable's enumeration in the file: of *component*, in a file for several."""
        same = next((name for name, items in self.enumerations.items() if items == variable.items), None)
        name = same or (f"{component}.{variable.name}" if component else variable.name)
        self.enumerations[name] = variable.items
        return name

    def add_to(self, root: ET.Element) -> None:
        """Write them down."""
        self.add_enumerations(root, "ssd")
        if self.units:
            group = ET.SubElement(root, "ssd:Units")
            for name, unit in sorted(self.units.items()):
                entry = ET.SubElement(group, "ssc:Unit", name=name)
                said = {base: str(unit.exponents[base]) for base in BASE_UNITS if unit.exponents.get(base)}
                if unit.factor != 1:
                    said["factor"] = repr(unit.factor)
                if unit.offset != 0:
                    said["offset"] = repr(unit.offset)
                ET.SubElement(entry, "ssc:BaseUnit", said)

    def add_enumerations(self, root: ET.Element, prefix: str) -> None:
        """Write the enumerations down in a file whose own elements have this *prefix*."""
        if self.enumerations:
            group = ET.SubElement(root, f"{prefix}:Enumerations")
            for name, items in sorted(self.enumerations.items()):
                entry = ET.SubElement(group, "ssc:Enumeration", name=name)
                for item, value in items.items():
                    ET.SubElement(entry, "ssc:Item", name=item, value=str(value))


def add_connector(
    group: ET.Element, variable: Variable, model: FmuModel, component: str, definitions: Definitions
) -> None:
    """A connector for *variable*, with its type as far as this version of SSP has a word for it."""
    connector = ET.SubElement(group, "ssd:Connector", name=variable.name, kind=variable.causality)
    if variable.kind is Kind.ENUMERATION:
        if variable.items:
            ET.SubElement(connector, "ssc:Enumeration", name=definitions.enumeration(variable, component))
    else:
        word = _IN_VERSION_1.get(variable.fmi_type) if definitions.version == "1.0" else variable.fmi_type
        if word:
            typed = ET.SubElement(connector, f"ssc:{word}")
            unit = definitions.unit(variable, model) if variable.kind is Kind.REAL else ""
            if unit:
                typed.set("unit", unit)
    for size in variable.shape:
        ET.SubElement(connector, "ssc:Dimension", size=str(size))
