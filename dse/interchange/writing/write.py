"""A system is written as an SSP package that other programs open, too: the same system, the same bytes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import fail
from dse.formats.zipped import pack_zip
from dse.interchange.reading.common import OWN_ANNOTATION, SSC, SSD, SSV
from dse.interchange.structure import ExperimentSettings
from dse.interchange.writing.connections import add_connection
from dse.interchange.writing.type_definitions import Definitions, add_connector, needs_version_2
from dse.interchange.writing.values import add_values

_OWN = "urn:dse:simulation"


def write_ssp(target: Path, name: str, system: SystemStructure, experiment: ExperimentSettings) -> None:
    """Write *system*, called *name*, with its FMUs to the package *target*.

    It is SSP 1.0, or 2.0 if it has what only that knows: other types than those of FMI 2, arrays. Components are sorted
    by name; one called ``a.b`` becomes ``a_b``, as many programs take no dots. Of the start values, those are
    written that differ from the FMU's own. Raises DseError if *target* or an FMU cannot be read or written, or for what
    SSP cannot say.
    """
    contents = package_of(name, system, experiment)
    try:
        target.write_bytes(pack_zip(contents))
    except OSError as error:
        raise fail(f"cannot write '{target}': {error.strerror or error}") from error


def package_of(name: str, system: SystemStructure, experiment: ExperimentSettings) -> dict[str, bytes]:
    """The files of the package by path."""
    archives = _archives(system)
    contents: dict[str, bytes] = {}
    for element in system.elements:
        path = archives[element.model.content_hash]
        try:
            contents.setdefault(path, element.model.archive.read_bytes())
        except OSError as error:
            raise fail(f"the FMU {element.model.archive} cannot be read: {error.strerror or error}") from error
    contents["SystemStructure.ssd"] = describe(name, system, experiment, archives)
    return contents


def describe(name: str, system: SystemStructure, experiment: ExperimentSettings, archives: Mapping[str, str]) -> bytes:
    """``SystemStructure.ssd``; *archives* holds where in the package each FMU lies, by its content hash."""
    names = component_names(system)
    elements = sorted(system.elements, key=lambda element: names[element.name])
    version = "2.0" if any(needs_version_2(element) for element in elements) else "1.0"
    definitions = Definitions()
    root = ET.Element("ssd:SystemStructureDescription", {"xmlns:ssd": SSD, "xmlns:ssc": SSC, "xmlns:ssv": SSV})
    root.attrib |= {"version": version, "name": name, "generationTool": "dse"}
    top = ET.SubElement(root, "ssd:System", name=name)
    group = ET.SubElement(top, "ssd:Elements")
    for element in elements:
        _add_component(group, element, names[element.name], archives, definitions, version)
    if system.wires:
        joined = ET.SubElement(top, "ssd:Connections")
        for wire in sorted(system.wires, key=lambda w: _rank(w, names)):
            add_connection(joined, wire, system, names)
    definitions.add_to(root)
    _add_experiment(root, experiment)
    ET.indent(root)
    text: bytes = ET.tostring(root, "UTF-8", xml_declaration=True)
    return text + b"\n"


def component_names(system: SystemStructure) -> dict[str, str]:
    """The names of components in the package, by the element's name."""
    names: dict[str, str] = {}
    for element in sorted(system.elements, key=lambda e: e.name):
        plain = wanted = re.sub(r"[^A-Za-z0-9_]", "_", element.name)
        number = 2
        while plain in names.values():
            plain, number = f"{wanted}_{number}", number + 1
        names[element.name] = plain
    return names


def _archives(system: SystemStructure) -> dict[str, str]:
    """Where each FMU lies in the package, by its content hash."""
    identifiers = {e.model.content_hash: e.model.identifier for e in system.elements}
    paths: dict[str, str] = {}
    for content, identifier in sorted(identifiers.items(), key=lambda entry: (entry[1], entry[0])):
        wanted = path = re.sub(r"[^A-Za-z0-9_.-]", "_", identifier)
        number = 2
        while f"resources/{path}.fmu" in paths.values():
            path, number = f"{wanted}_{number}", number + 1
        paths[content] = f"resources/{path}.fmu"
    return paths


def _add_component(
    group: ET.Element,
    element: Element,
    name: str,
    archives: Mapping[str, str],
    definitions: Definitions,
    version: str,
) -> None:
    component = ET.SubElement(group, "ssd:Component", name=name, type="application/x-fmu-sharedlibrary")
    component.set("source", archives[element.model.content_hash])
    component.set("implementation", str(element.model.interface))
    shown = {variable.name for variable in (*element.inputs, *element.outputs)}
    if shown:
        connectors = ET.SubElement(component, "ssd:Connectors")
        for variable in element.model.variables.values():
            if variable.name in shown:
                add_connector(connectors, variable, element.model, name, definitions, version)
    add_values(component, element, version)


def _add_experiment(root: ET.Element, experiment: ExperimentSettings) -> None:
    said = {"startTime": experiment.start, "stopTime": experiment.stop}
    element = ET.SubElement(root, "ssd:DefaultExperiment", {k: repr(v) for k, v in said.items() if v is not None})
    own = {"step": experiment.step, "recordEvery": experiment.record_every}
    known = {key: repr(value) for key, value in own.items() if value is not None}
    if known:
        annotations = ET.SubElement(element, "ssd:Annotations")
        annotation = ET.SubElement(annotations, "ssc:Annotation", type=OWN_ANNOTATION)
        ET.SubElement(annotation, "Simulation", {"xmlns": _OWN, **known})


def _rank(wire: Wire, names: Mapping[str, str]) -> tuple[str, str, str, str]:
    return names[wire.source], wire.source_variable, names[wire.target], wire.target_variable
