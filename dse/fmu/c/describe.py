"""modelDescription.xml and buildDescription.xml of an FMU that is built here, for FMI 2.0 and 3.0."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Container, Iterable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from itertools import accumulate, pairwise
from math import prod

from dse.domain.component import Kind
from dse.fmu.c.slots import Role, Slot
from dse.units import SI_SYMBOLS, Unit


@dataclass(frozen=True, slots=True)
class Subject:
    """What is described. *period* is the sample time in seconds, None for a plant; *files* lie in ``sources/``."""

    name: str
    identifier: str
    title: str
    token: str
    period: float | None
    slots: tuple[Slot, ...]
    files: tuple[str, ...]
    include_folder: str
    has_state: bool = True
    needs_tool: bool = False


def describe(subject: Subject, version: int) -> bytes:
    """modelDescription.xml.

    Outputs are computed by the step, so between two steps they depend on nothing; what they depend on initially is left
    out, which says: on everything.
    """
    root = description_root(subject.name, subject.token, subject.title, version)
    _add_interface(root, subject, version)
    add_units(root, {slot.type.unit.symbol: slot.type.unit for slot in subject.slots if _has_unit(slot)})
    enumerations = {slot.type for slot in subject.slots if slot.type.kind is Kind.ENUMERATION}
    add_enumerations(root, {str(kind): kind.items for kind in enumerations}, 0, version)
    categories = ET.SubElement(root, "LogCategories")
    ET.SubElement(categories, "Category", name="logStatusError", description="What was refused, and why")
    step = {} if subject.period is None else {"stepSize": repr(subject.period)}
    ET.SubElement(root, "DefaultExperiment", {"startTime": "0.0", **step})
    _add_variables(root, subject, version)
    return xml_text(root)


def description_root(name: str, token: str, title: str, version: int) -> ET.Element:
    """What every modelDescription.xml of dse begins with."""
    root = ET.Element("fmiModelDescription", fmiVersion="2.0" if version == 2 else "3.0", modelName=name)
    root.set("guid" if version == 2 else "instantiationToken", token)
    if title:
        root.set("description", title)
    root.set("generationTool", "dse")
    root.set("variableNamingConvention", "structured")
    return root


def describe_sources(identifier: str, files: Iterable[str], include_folder: str, options: Iterable[str]) -> bytes:
    """buildDescription.xml, by which an FMI 3.0 importer compiles the *files* in ``sources/`` itself."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ET.SubElement(root, "BuildConfiguration", modelIdentifier=identifier)
    listed = ET.SubElement(configuration, "SourceFileSet", language="C11", compilerOptions=" ".join(options))
    for name in files:
        ET.SubElement(listed, "SourceFile", name=name)
    ET.SubElement(listed, "IncludeDirectory", name=include_folder)
    return xml_text(root)


def model_identifier(name: str) -> str:
    """*name* as an identifier of C, for ``modelIdentifier``."""
    plain = re.sub(r"[^0-9A-Za-z_]", "_", name)
    return plain if re.match(r"[A-Za-z_]", plain) else f"_{plain}"


def xml_text(root: ET.Element) -> bytes:
    """The document as it is written to a file."""
    ET.indent(root)
    text: str = ET.tostring(root, encoding="unicode")  # to bytes, each piece would pass an encoder of its own
    return f"<?xml version='1.0' encoding='utf-8'?>\n{text}\n".encode("utf-8", "xmlcharrefreplace")


def _add_interface(root: ET.Element, subject: Subject, version: int) -> None:
    state = "FMUstate" if version == 2 else "FMUState"
    frugal = ("canNotUseMemoryManagementFunctions",) if version == 2 else ()
    saved = (f"canGetAndSet{state}", f"canSerialize{state}") if subject.has_state else ()
    outside = ("needsExecutionTool",) if subject.needs_tool else ()
    able = ("canHandleVariableCommunicationStepSize", *frugal, *saved, *outside)
    told = {"modelIdentifier": subject.identifier, **dict.fromkeys(able, "true")}
    interface = ET.SubElement(root, "CoSimulation", told)
    if version == 2:
        add_source_files(interface, subject.files)


def add_source_files(interface: ET.Element, files: Iterable[str]) -> None:
    """The *files* in ``sources/``, as FMI 2.0 lists them."""
    sources = ET.SubElement(interface, "SourceFiles")
    for name in files:
        ET.SubElement(sources, "File", name=name)


def add_units(root: ET.Element, units: Mapping[str, Unit | None]) -> None:
    """The definitions of *units* by name; FMI lets a unit be a name alone."""
    definitions = ET.SubElement(root, "UnitDefinitions") if units else root
    for name, unit in sorted(units.items(), key=lambda item: item[0]):
        element = ET.SubElement(definitions, "Unit", name=name)
        if unit is not None:
            _add_base_unit(element, unit)


def _has_unit(slot: Slot) -> bool:
    return slot.type.kind is Kind.REAL and bool(slot.type.unit.symbol)


def _add_base_unit(parent: ET.Element, unit: Unit) -> None:
    """Exponents, factor and offset to SI; nothing if FMI's base units cannot say the dimension, as for EUR."""
    if any(name not in SI_SYMBOLS or exponent.denominator != 1 for name, exponent in unit.dimension):
        return
    base = ET.SubElement(parent, "BaseUnit")
    for name, exponent in sorted(unit.dimension):
        base.set(SI_SYMBOLS[name], str(exponent))
    if unit.symbol == "rad":
        base.set("rad", "1")
    if unit.factor != Fraction(1):
        base.set("factor", repr(float(unit.factor)))
    if unit.offset:
        base.set("offset", repr(float(unit.offset)))


def add_enumerations(root: ET.Element, types: Mapping[str, tuple[str, ...]], first: int, version: int) -> None:
    """The definitions of enumerations by name, whose items count from *first*."""
    definitions = ET.SubElement(root, "TypeDefinitions") if types else root
    for name, items in sorted(types.items()):
        if version == 2:
            parent = ET.SubElement(ET.SubElement(definitions, "SimpleType", name=name), "Enumeration")
        else:
            parent = ET.SubElement(definitions, "EnumerationType", name=name)
        for number, item in enumerate(items, first):
            ET.SubElement(parent, "Item", name=item, value=str(number))


def _add_variables(root: ET.Element, subject: Subject, version: int) -> None:
    variables = ET.SubElement(root, "ModelVariables")
    slots = subject.slots if version == 2 else _whole(subject.slots)
    for slot in slots:
        common, typed = _common(slot, is_sampled=subject.period is not None), _typed(slot)
        if version == 2 and slot.type.kind is Kind.BINARY:
            _add_osmp(variables, slot, common, subject.slots)
            continue
        if version == 2:
            typed |= {"start": ""} if slot.type.kind is Kind.TEXT and slot.start is not None else {}
            ET.SubElement(ET.SubElement(variables, "ScalarVariable", common), TYPES_2[slot.type.kind], typed)
            continue
        if slot.shape:
            common["name"] = slot.array
            values = subject.slots[slot.reference : slot.reference + prod(slot.shape)]
            starts = [number_text(one.type.kind, one.start) for one in values if one.start is not None]
            typed |= {"start": " ".join(starts)} if starts else {}
        variable = ET.SubElement(variables, TYPES_3[slot.type.kind], {**common, **typed})
        for size in slot.shape:
            ET.SubElement(variable, "Dimension", start=str(size))
        if not slot.type.kind.is_number and slot.start is not None:
            ET.SubElement(variable, "Start", value="")
    if version == 3:
        add_time(variables, len(subject.slots), {slot.name for slot in subject.slots})
    structure = ET.SubElement(root, "ModelStructure")
    outputs = [slot for slot in slots if slot.role is Role.OUTPUT]
    ends = list(accumulate(len(OSMP) if slot.type.kind is Kind.BINARY else 1 for slot in slots))
    positions = dict(zip((slot.name for slot in slots), pairwise([1, *(end + 1 for end in ends)]), strict=True))
    for name in ("Output", "InitialUnknown") if outputs else ():
        group = ET.SubElement(structure, f"{name}s") if version == 2 else structure
        for slot in outputs:
            if version == 2:
                at = range(*positions[slot.name])
                unknowns = [ET.SubElement(group, "Unknown", index=str(index)) for index in at]
            else:
                unknowns = [ET.SubElement(group, name, valueReference=str(slot.reference))]
            for unknown in unknowns if name == "Output" else ():
                unknown.set("dependencies", "")


def _add_osmp(variables: ET.Element, slot: Slot, common: dict[str, str], slots: tuple[Slot, ...]) -> None:
    """The integers of a binary by the OSI Sensor Model Packaging; their references come after those of all *slots*."""
    number = [other.reference for other in slots if other.type.kind is Kind.BINARY].index(slot.reference)
    for part, role in enumerate(OSMP):
        own = {"name": f"{slot.name}.{role}", "valueReference": str(len(slots) + len(OSMP) * number + part)}
        variable = ET.SubElement(variables, "ScalarVariable", {**common, **own})
        ET.SubElement(variable, "Integer", {"start": "0"} if slot.start is not None else {})
        annotations = ET.SubElement(variable, "Annotations")
        tool = ET.SubElement(annotations, "Tool", {"name": "net.pmsf.osmp", "xmlns:osmp": _OSMP_SPACE})
        said = ET.SubElement(tool, "osmp:osmp-binary-variable", name=slot.name, role=role)
        said.set("mime-type", slot.type.media or "application/octet-stream")


OSMP = ("base.lo", "base.hi", "size")
"""What the integers of a binary are called behind its name."""
_OSMP_SPACE = "http://xsd.pmsf.net/OSISensorModelPackaging"


def _whole(slots: tuple[Slot, ...]) -> list[Slot]:
    """The slots without those that lie in an array behind its first."""
    found, end = [], 0
    for slot in slots:
        if slot.reference >= end:
            found.append(slot)
            end = slot.reference + prod(slot.shape)
    return found


def free_name(name: str, taken: Container[str]) -> str:
    """*name*, or one like it that is not *taken*."""
    while name in taken:
        name += "_"
    return name


def add_time(variables: ET.Element, reference: int, taken: Container[str]) -> None:
    """The independent variable of FMI 3.0."""
    own = {"name": free_name("time", taken), "valueReference": str(reference), "causality": "independent"}
    own |= {"variability": "continuous", "description": "Simulation time in seconds"}
    ET.SubElement(variables, "Float64", own)


TYPES_2 = {**{kind: kind.name.capitalize() for kind in Kind}, Kind.TEXT: "String"}
TYPES_3 = {**TYPES_2, Kind.REAL: "Float64", Kind.INTEGER: "Int32"}
"""What FMI 2.0 and 3.0 call the variables of a kind."""


def _common(slot: Slot, *, is_sampled: bool) -> dict[str, str]:
    attributes = {"name": slot.name, "valueReference": str(slot.reference)}
    if slot.title:
        attributes["description"] = slot.title
    attributes["causality"] = str(slot.role)
    if slot.role is Role.PARAMETER:
        attributes["variability"] = "tunable" if slot.is_tunable else "fixed"
        attributes["initial"] = "exact"
    else:
        is_continuous = slot.role is Role.INPUT or not is_sampled
        attributes["variability"] = "continuous" if slot.type.kind is Kind.REAL and is_continuous else "discrete"
    if slot.role is Role.OUTPUT:
        attributes["initial"] = "calculated"
    return attributes


def _typed(slot: Slot) -> dict[str, str]:
    attributes: dict[str, str] = {}
    if slot.type.kind is Kind.ENUMERATION:
        attributes["declaredType"] = str(slot.type)
    if not slot.type.kind.is_number:
        return {"mimeType": slot.type.media} if slot.type.media else attributes
    if _has_unit(slot):
        attributes["unit"] = slot.type.unit.symbol
    for name, number in (("min", slot.minimum), ("max", slot.maximum), ("start", slot.start)):
        if number is not None and (name == "start" or slot.type.kind in (Kind.REAL, Kind.INTEGER)):
            attributes[name] = number_text(slot.type.kind, number)
    return attributes


def number_text(kind: Kind, number: float | bool) -> str:
    """*number* as a variable of this kind has it in XML."""
    if kind is Kind.REAL:
        return repr(float(number))
    if kind is Kind.BOOLEAN:
        return "true" if number else "false"
    return str(int(number))
