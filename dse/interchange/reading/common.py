"""What all files of an SSP have in common: units, enumerations, types, transformations, and what is let pass."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field

from dse.domain.fmu import UnitDefinition
from dse.errors import Problem, closest, fail
from dse.formats.xml import XmlElement
from dse.formats.xml_values import shortened
from dse.interchange.structure import NamedUnit, SignalType, Transformation

SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSM = "http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
SSB = "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary"

REALS = ("Real", "Float64", "Float32")
INTEGERS = ("Integer", "Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64")
TYPES = (*REALS, *INTEGERS, "Boolean", "String", "Enumeration", "Binary", "Clock")
TRANSFORMATIONS = (
    "LinearTransformation",
    "BooleanMappingTransformation",
    "IntegerMappingTransformation",
    "EnumerationMappingTransformation",
)
BASE_UNITS = ("kg", "m", "s", "A", "K", "mol", "cd", "rad")

OWN_ANNOTATION = "dse.simulation"
"""Type of the annotation of an experiment in which this program keeps what SSP has no words for."""
STEP_ELEMENT = "FixedStepMaster"
"""The element of OMSimulator's annotations that says the step."""

BASE = frozenset({"id", "description"})
"""Attributes that any element may have."""
META = frozenset({"author", "fileversion", "copyright", "license", "generationTool", "generationDateAndTime"})
"""Attributes that the root of any file may have."""
EXTRAS = frozenset({"Annotations", "MetaData", "Signature"})
"""Elements that any element may hold and that say nothing of how it is simulated."""


@dataclass(slots=True)
class Findings:
    """What is wrong with a package, and what in it is of no use here."""

    problems: list[Problem] = field(default_factory=list)
    notes: list[Problem] = field(default_factory=list)


@dataclass(frozen=True, slots=True)
class Scope:
    """The units and enumerations one file defines."""

    units: Mapping[str, UnitDefinition]
    enumerations: Mapping[str, Mapping[str, int]]


def require_root(root: XmlElement, tag: str, namespace: str) -> None:
    """Raise DseError unless *root* is SSP's element *tag* in a version that is known."""
    if root.tag != tag:
        raise fail(f"<{tag}> is expected here, not <{root.tag}>", root.where, "it is no file of this kind")
    if root.namespace != namespace:
        what = f"<{tag}> is in the namespace '{shortened(root.namespace)}', not '{namespace}'"
        raise fail(what, root.where, "drafts before SSP 1.0 are not supported; export it as SSP 1.0 or 2.0")
    # OMSimulator leaves it out where one file is written into another; then the namespace has to do.
    version = root.get("version", "1.0")
    if not re.fullmatch(r"[12]\.\d+(?:-.*)?", version):
        what = f"the version '{shortened(version)}' of SSP is not supported"
        raise fail(what, root.where, "export it as SSP 1.0 or 2.0")


def expect(
    element: XmlElement,
    attributes: frozenset[str] | set[str],
    children: frozenset[str] | set[str],
    found: Findings,
) -> None:
    """Add a problem for every attribute and child that SSP does not know here, and a note for every annotation."""
    for name in element.attributes:
        # Attributes of other namespaces (xsi:schemaLocation) belong to others.
        if not name.startswith("{") and name not in attributes | BASE:
            hint = closest(name, attributes | BASE)
            found.problems.append(Problem(f"<{element.tag}> has no attribute '{name}'", element.where, hint))
    for child in element.children:
        if child.tag in EXTRAS:
            found.notes += _extras(child)
        elif child.tag not in children:
            hint = closest(child.tag, children | EXTRAS)
            found.problems.append(Problem(f"<{child.tag}> cannot stand in <{element.tag}>", child.where, hint))


def _extras(element: XmlElement) -> list[Problem]:
    if element.tag != "Annotations":
        return [Problem(f"<{element.tag}> is not used", element.where)]
    return [
        Problem(f"the annotation '{shortened(annotation.get('type'))}' is not used", annotation.where)
        for annotation in element.all("Annotation")
        if annotation.get("type") != OWN_ANNOTATION and not any(a.tag == STEP_ELEMENT for a in annotation.walk())
    ]


def read_scope(root: XmlElement, found: Findings) -> Scope:
    """The units and enumerations that the file of *root* defines."""
    units: dict[str, UnitDefinition] = {}
    for group in root.all("Units"):
        expect(group, set(), {"Unit"}, found)
        for element in group.all("Unit"):
            expect(element, {"name"}, {"BaseUnit"}, found)
            name = element.required("name", found.problems)
            if name in units:
                found.problems.append(Problem(f"the unit '{shortened(name)}' is there twice", element.where))
            base = element.child("BaseUnit")
            if base is None:
                found.problems.append(Problem(f"the unit '{shortened(name)}' has no <BaseUnit>", element.where))
            else:
                units[name] = _definition(base, found)
    enumerations: dict[str, Mapping[str, int]] = {}
    for group in root.all("Enumerations"):
        expect(group, set(), {"Enumeration"}, found)
        for element in group.all("Enumeration"):
            expect(element, {"name"}, {"Item"}, found)
            name = element.required("name", found.problems)
            if name in enumerations:
                found.problems.append(Problem(f"the enumeration '{shortened(name)}' is there twice", element.where))
            enumerations[name] = _items(element, found)
    return Scope(units, enumerations)


def _definition(base: XmlElement, found: Findings) -> UnitDefinition:
    expect(base, {*BASE_UNITS, "factor", "offset"}, set(), found)
    exponents = {name: base.whole(name, found.problems, least=-99, most=99) or 0 for name in BASE_UNITS}
    factor, offset = finite(base, "factor", found), finite(base, "offset", found)
    if factor == 0:
        found.problems.append(Problem("a unit's factor cannot be 0", base.where))
        factor = None
    return UnitDefinition(
        1.0 if factor is None else factor, offset or 0.0, {name: n for name, n in exponents.items() if n}
    )


def finite(element: XmlElement, name: str, found: Findings) -> float | None:
    """The attribute as a finite number; None if it is not there, and a problem if it is no such number."""
    value = element.real(name, found.problems)
    if value is not None and not math.isfinite(value):
        found.problems.append(Problem(f"<{element.tag}>: '{name}' cannot be {value:g}", element.where))
        return None
    return value


def _items(element: XmlElement, found: Findings) -> dict[str, int]:
    items: dict[str, int] = {}
    for item in element.all("Item"):
        expect(item, {"name", "value"}, set(), found)
        name = item.required("name", found.problems)
        value = item.whole("value", found.problems)
        if value is None and "value" not in item.attributes:
            found.problems.append(Problem("<Item> has no 'value'", item.where))
        if name in items:
            found.problems.append(Problem(f"the item '{shortened(name)}' is there twice", item.where))
        items[name] = value or 0
    return items


def unit_of(element: XmlElement, scope: Scope) -> NamedUnit | None:
    """The unit that *element* is given in, or None."""
    name = element.get("unit")
    return NamedUnit(name, scope.units.get(name)) if name else None


def read_type(element: XmlElement, scope: Scope, found: Findings) -> SignalType | None:
    """The type said in *element*, or None if none is."""
    typed = [child for child in element.children if child.tag in TYPES]
    if len(typed) > 1:
        found.problems.append(Problem(f"<{element.tag}> has more than one type", typed[1].where))
    if not typed:
        return None
    child = typed[0]
    if child.tag == "Clock":
        return SignalType(child.tag)
    expect(child, {"unit", "name", "mime-type"}, set(), found)
    items = None
    if child.tag == "Enumeration":
        name = child.required("name", found.problems)
        items = scope.enumerations.get(name)
        if items is None and name:
            # Many tools leave it to the FMU to say what its items are.
            found.notes.append(Problem(f"the enumeration '{shortened(name)}' is not defined in this file", child.where))
    return SignalType(child.tag, unit_of(child, scope), items)


def read_sizes(element: XmlElement, found: Findings) -> tuple[int | None, ...]:
    """The sizes said by the <Dimension> elements in *element*; None for one that depends on something."""
    sizes = []
    for child in element.all("Dimension"):
        expect(child, {"size", "sizeConnector"}, set(), found)
        sizes.append(child.whole("size", found.problems, least=1, most=2**31))
    return tuple(sizes)


def read_transformation(element: XmlElement, found: Findings) -> Transformation | None:
    """The transformation said in *element*, or None if none is."""
    said = [child for child in element.children if child.tag in TRANSFORMATIONS]
    if len(said) > 1:
        found.problems.append(Problem(f"<{element.tag}> has more than one transformation", said[1].where))
    if not said:
        return None
    child = said[0]
    if child.tag == "LinearTransformation":
        expect(child, {"factor", "offset"}, set(), found)
        factor, offset = finite(child, "factor", found), finite(child, "offset", found)
        return Transformation(child.tag, 1.0 if factor is None else factor, offset or 0.0, where=child.where)
    expect(child, set(), {"MapEntry"}, found)
    entries: dict[str, str] = {}
    for entry in child.all("MapEntry"):
        expect(entry, {"source", "target"}, set(), found)
        source, target = entry.required("source", found.problems), entry.required("target", found.problems)
        if source in entries:
            found.problems.append(Problem(f"the source '{shortened(source)}' is there twice", entry.where))
        entries[source] = target
    return Transformation(child.tag, entries=tuple(entries.items()), where=child.where)
