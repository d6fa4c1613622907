"""A system is written as an SSP package that other programs open, too: the same system, the same bytes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import fail
from dse.formats import pack_zip
from dse.interchange.names import each_named, numbered
from dse.interchange.reading.common import OWN_ANNOTATION, SSC, SSD, SSV
from dse.interchange.resolving.osmp import without_binaries
from dse.interchange.structure import ExperimentSettings
from dse.interchange.writing.connections import add_connection
from dse.interchange.writing.type_definitions import Definitions, add_connector, needs_version_2
from dse.interchange.writing.values import add_values
from dse.scratch import write_whole

_OWN = "urn:dse:simulation"


def write_ssp(target: Path, name: str, system: SystemStructure, experiment: ExperimentSettings) -> None:
    """Write *system*, called *name*, with its FMUs to the package *target*.

    It is SSP 1.0, or 2.0 if it has what only that knows: other types than those of FMI 2, arrays. Components are sorted
    by name; one called ``a.b`` becomes ``a_b``, as many programs take no dots. Of the start values, those are
    written that differ from the FMU's own. Raises DseError if *target* or an FMU cannot be read or written, or for what
    SSP cannot say.
    """
    system = without_binaries(system)
    archives = _archives(system)
    contents: dict[str, bytes] = {}
    for element in system.elements:
        path = archives[element.model.content_hash]
        try:
            contents.setdefault(path, element.model.archive.read_bytes())
        except OSError as error:
            raise fail(f"the FMU {element.model.archive} cannot be read: {error.strerror or error}") from error
    contents["SystemStructure.ssd"] = _described(name, system, experiment, archives)
    write_whole(target, pack_zip(contents))


def _archives(system: SystemStructure) -> dict[str, str]:
    """Where each FMU lies in the package, by its content hash."""
    identifiers = {e.model.content_hash: e.model.identifier for e in system.elements}
    paths: dict[str, str] = {}
    for content, identifier in sorted(identifiers.items(), key=lambda entry: (entry[1], entry[0])):
        stem = f"resources/{re.sub(r'[^A-Za-z0-9_.-]', '_', identifier)}"
        paths[content] = numbered(stem, lambda free: f"{free}.fmu" in paths.values()) + ".fmu"
    return paths


def _described(
    name: str, system: SystemStructure, experiment: ExperimentSettings, archives: Mapping[str, str]
) -> bytes:
    """``SystemStructure.ssd``; *archives* holds where in the package each FMU lies, by its content hash."""
    names = each_named(
        (element.name for element in system.elements),
        lambda name, taken: numbered(re.sub(r"[^A-Za-z0-9_]", "_", name), taken.__contains__),
    )
    elements = sorted(system.elements, key=lambda element: names[element.name])
    definitions = Definitions("2.0" if any(needs_version_2(element) for element in elements) else "1.0")
    root = ET.Element("ssd:SystemStructureDescription", {"xmlns:ssd": SSD, "xmlns:ssc": SSC, "xmlns:ssv": SSV})
    root.attrib |= {"version": definitions.version, "name": name, "generationTool": "dse"}
    top = ET.SubElement(root, "ssd:System", name=name)
    group = ET.SubElement(top, "ssd:Elements")
    for element in elements:
        _add_component(group, element, names[element.name], archives[element.model.content_hash], definitions)
    if system.wires:
        joined = ET.SubElement(top, "ssd:Connections")
        for wire in sorted(system.wires, key=lambda w: _rank(w, names)):
            add_connection(joined, wire, system, names)
    definitions.add_to(root)
    _add_experiment(root, experiment)
    ET.indent(root)
    text: bytes = ET.tostring(root, "UTF-8", xml_declaration=True)
    return text + b"\n"


def _add_component(group: ET.Element, element: Element, name: str, archive: str, definitions: Definitions) -> None:
    component = ET.SubElement(group, "ssd:Component", name=name, type="application/x-fmu-sharedlibrary")
    component.set("source", archive)
    component.set("implementation", str(element.model.interface))
    shown = {variable.name for variable in (*element.inputs, *element.outputs)}
    if shown:
        connectors = ET.SubElement(component, "ssd:Connectors")
        for variable in element.model.variables.values():
            if variable.name in shown:
                add_connector(connectors, variable, element.model, name, definitions)
    add_values(component, element, definitions.version)


def _add_experiment(root: ET.Element, experiment: ExperimentSettings) -> None:
    said = {"startTime": experiment.start, "stopTime": experiment.stop}
    element = ET.SubElement(root, "ssd:DefaultExperiment", {k: repr(v) for k, v in said.items() if v is not None})
    own = {"step": experiment.step, "recordEvery": experiment.record_every, "tolerance": experiment.tolerance}
    known = {key: repr(value) for key, value in own.items() if value is not None}
    if known:
        annotations = ET.SubElement(element, "ssd:Annotations")
        annotation = ET.SubElement(annotations, "ssc:Annotation", type=OWN_ANNOTATION)
        ET.SubElement(annotation, "Simulation", {"xmlns": _OWN, **known})


def _rank(wire: Wire, names: Mapping[str, str]) -> tuple[str, str, str, str]:
    return names[wire.source], wire.source_variable, names[wire.target], wire.target_variable
