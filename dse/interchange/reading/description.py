"""System structure descriptions (SSD): systems, components and the connections between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import PurePosixPath

from dse.errors import DseError, Location, Problem, closest, fail
from dse.formats.xml import XmlElement
from dse.formats.xml_values import shortened, whole_of
from dse.interchange.reading.bindings import read_bindings
from dse.interchange.reading.common import (
    META,
    OWN_ANNOTATION,
    SSD,
    STEP_ELEMENT,
    TRANSFORMATIONS,
    TYPES,
    Findings,
    Scope,
    expect,
    finite,
    read_scope,
    read_sizes,
    read_transformation,
    read_type,
    require_root,
)
from dse.interchange.reading.dictionary import read_dictionary
from dse.interchange.reading.package import DEFAULT, Package, Target, follow, open_package, read_file
from dse.interchange.reading.parameters import inline
from dse.interchange.structure import (
    Component,
    Connection,
    Connector,
    DictionaryReference,
    ExperimentSettings,
    SignalType,
    System,
)

FMU = "application/x-fmu-sharedlibrary"
DEFINITION = "application/x-ssp-definition"
PACKAGE = "application/x-ssp-package"
DICTIONARY = "application/x-ssp-signal-dictionary"

_KINDS = ("input", "output", "parameter", "calculatedParameter", "structuralParameter", "constant", "local", "inout")
_MOST_LEVELS = 20
_ELEMENT = frozenset({"Connectors", "ElementGeometry", "ParameterBindings"})
_CONTENT = frozenset(
    {"Elements", "Connections", "SignalDictionaries", "SystemGeometry", "GraphicalElements", "SimulationInformation"}
)


@dataclass(frozen=True, slots=True)
class Description:
    """What one ``.ssd`` file says."""

    name: str
    version: str
    system: System
    experiment: ExperimentSettings


def read_description(package: Package, file: PurePosixPath, found: Findings, level: int = 0) -> Description:
    """Read the package's ``.ssd`` *file* and all it names. Raises DseError if it is none; all else goes to *found*."""
    here = Location(package.place(file))
    if level > _MOST_LEVELS:
        raise fail(f"packages and systems are nested more than {_MOST_LEVELS} levels deep", here)
    root = read_file(package, follow(package, PurePosixPath(DEFAULT), str(file), here))
    require_root(root, "SystemStructureDescription", SSD)
    children = {"System", "Enumerations", "Units", "DefaultExperiment", "SSDVariant"}
    expect(root, META | {"version", "name"}, children, found)
    top = root.child("System")
    if top is None:
        raise fail("there is no <System>", root.where)
    reader = _Reader(package, file, root, read_scope(root, found), found)
    return Description(
        root.required("name", found.problems),
        root.get("version"),
        reader.system(top, level),
        _experiment(root, top, found),
    )


def _experiment(root: XmlElement, top: XmlElement, found: Findings) -> ExperimentSettings:
    element = root.child("DefaultExperiment")
    said: dict[str, float | None] = {}
    if element is not None:
        expect(element, {"startTime", "stopTime"}, set(), found)
        said = {"start": finite(element, "startTime", found), "stop": _positive(element, "stopTime", found)}
        for annotation in element.below("Annotations", "Annotation"):
            if annotation.get("type") == OWN_ANNOTATION:
                for own in annotation.children:
                    said["step"] = _positive(own, "step", found)
                    said["record_every"] = _positive(own, "recordEvery", found)
    if said.get("step") is None:
        extras = (extra for tag in ("Annotations", "SimulationInformation") for extra in top.all(tag))
        masters = [master for extra in extras for master in extra.walk() if master.tag == STEP_ELEMENT]
        if masters:
            said["step"] = _positive(masters[0], "stepSize", found)
    return ExperimentSettings(**said)


def _positive(element: XmlElement, name: str, found: Findings) -> float | None:
    value = finite(element, name, found)
    if value is not None and value <= 0:
        found.problems.append(Problem(f"<{element.tag}>: '{name}' must be positive, not {value:g}", element.where))
        return None
    return value


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads the elements of one file."""

    package: Package
    file: PurePosixPath
    root: XmlElement
    scope: Scope
    found: Findings

    def system(self, element: XmlElement, level: int) -> System:
        if level > _MOST_LEVELS:
            raise fail(f"packages and systems are nested more than {_MOST_LEVELS} levels deep", element.where)
        expect(element, {"name"}, _ELEMENT | _CONTENT, self.found)
        elements: list[Component | DictionaryReference | System] = []
        names: set[str] = set()
        for child in element.below("Elements"):
            expect(child, set(), {"Component", "SignalDictionaryReference", "System"}, self.found)
            for inner in child.children:
                name = inner.get("name")
                if name in names:
                    what = f"two elements are called '{shortened(name)}'"
                    self.found.problems.append(Problem(what, inner.where, "rename one of them"))
                names.add(name)
                try:
                    elements += self._element(inner, level)
                except DseError as error:
                    self.found.problems += error.problems
        return System(
            element.required("name", self.found.problems),
            tuple(elements),
            tuple(self._connection(c) for c in element.below("Connections", "Connection")),
            self._connectors(element),
            read_bindings(self.package, self.file, element, None, self.found),
            element.where,
            dict(self._dictionaries(element)),
        )

    def _element(self, element: XmlElement, level: int) -> list[Component | DictionaryReference | System]:
        name = element.required("name", self.found.problems)
        match element.tag:
            case "System":
                return [self.system(element, level + 1)]
            case "SignalDictionaryReference":
                expect(element, {"name", "dictionary"}, _ELEMENT, self.found)
                named = element.required("dictionary", self.found.problems)
                return [DictionaryReference(name, named, self._connectors(element), element.where)]
            case "Component":
                return [self._component(name, element, level)]
        return []

    def _component(self, name: str, element: XmlElement, level: int) -> Component | System:
        expect(element, {"name", "type", "source", "implementation"}, _ELEMENT, self.found)
        source = element.get("source")
        if not source:
            what = f"component '{shortened(name)}' has no 'source', so there is nothing to simulate"
            raise fail(what, element.where, "name its FMU, as resources/part.fmu")
        type_ = element.get("type", FMU)
        if type_ not in (FMU, DEFINITION, PACKAGE):
            what = f"component '{shortened(name)}' is of the type '{shortened(type_)}', which is not supported"
            raise fail(what, element.where, "components are FMUs, systems (.ssd) or packages (.ssp)")
        target = follow(self.package, self.file, source, element.where)
        if type_ == FMU:
            bindings = read_bindings(self.package, self.file, element, target.path, self.found)
            implementation = element.word(
                "implementation", ("any", "CoSimulation", "ModelExchange"), self.found.problems, "any"
            )
            connectors = self._connectors(element)
            return Component(name, source, target.path, connectors, bindings, element.where, implementation)
        inner = self._nested(type_, source, target, element, level)
        # Bindings of the component come after those of the system it stands for (SSP, ParameterBindings).
        bindings = read_bindings(self.package, self.file, element, None, self.found)
        return replace(inner, name=name, bindings=(*inner.bindings, *bindings))

    def _nested(self, type_: str, source: str, target: Target, element: XmlElement, level: int) -> System:
        if type_ == PACKAGE:
            package, variant = open_package(target.path, self.package.into)
            package = replace(package, called=self.package.place(target.file))
            file = PurePosixPath(target.fragment or f"{variant}.ssd")
            return read_description(package, file, self.found, level + 1).system
        if not source.startswith("#"):
            return read_description(self.package, target.file, self.found, level + 1).system
        meant = [e for e in self.root.walk() if e.tag == "System" and e.get("id") == target.fragment]
        if not meant:
            known = [e.get("id") for e in self.root.walk() if e.tag == "System" and e.get("id")]
            what = f"no system in this file has the id '{shortened(target.fragment)}'"
            raise fail(what, element.where, closest(target.fragment, known))
        return self.system(meant[0], level + 1)

    def _connectors(self, element: XmlElement) -> tuple[Connector, ...]:
        connectors: dict[str, Connector] = {}
        for child in element.below("Connectors", "Connector"):
            expect(child, {"name", "kind"}, {*TYPES, "ConnectorGeometry", "Dimension"}, self.found)
            name = child.required("name", self.found.problems)
            kind = child.word("kind", _KINDS, self.found.problems)
            if "kind" not in child.attributes:
                self.found.problems.append(Problem(f"connector '{shortened(name)}' has no 'kind'", child.where))
            if name in connectors:
                self.found.problems.append(Problem(f"connector '{shortened(name)}' is there twice", child.where))
            type_ = read_type(child, self.scope, self.found)
            connectors[name] = Connector(name, kind, type_, child.where, read_sizes(child, self.found))
        return tuple(connectors.values())

    def _connection(self, element: XmlElement) -> Connection:
        ends = {f"{end}{what}" for end in ("start", "end") for what in ("Element", "Connector", "Indices")}
        expect(element, ends | {"suppressUnitConversion"}, {*TRANSFORMATIONS, "ConnectionGeometry"}, self.found)
        return Connection(
            element.get("startElement"),
            element.required("startConnector", self.found.problems),
            element.get("endElement"),
            element.required("endConnector", self.found.problems),
            element.where,
            read_transformation(element, self.found),
            element.flag("suppressUnitConversion", self.found.problems),
            self._indices(element, "startIndices"),
            self._indices(element, "endIndices"),
        )

    def _indices(self, element: XmlElement, name: str) -> tuple[int, ...]:
        numbers = [whole_of(text) for text in element.get(name).split()]
        indices = tuple(number for number in numbers if number is not None)
        if len(indices) < len(numbers):
            what = f"'{name}' is '{shortened(element.get(name))}', no list of whole numbers"
            self.found.problems.append(Problem(what, element.where))
        return indices

    def _dictionaries(self, element: XmlElement) -> dict[str, dict[str, SignalType]]:
        dictionaries: dict[str, dict[str, SignalType]] = {}
        for child in element.below("SignalDictionaries", "SignalDictionary"):
            expect(child, {"name", "type", "source"}, {"SignalDictionary"}, self.found)
            name = child.required("name", self.found.problems)
            type_, source = child.get("type", DICTIONARY), child.get("source")
            try:
                if type_ != DICTIONARY:
                    what = f"signal dictionary '{shortened(name)}' is of the type '{shortened(type_)}'"
                    raise fail(f"{what}, which is not supported", child.where)
                if source:
                    root = read_file(self.package, follow(self.package, self.file, source, child.where))
                else:
                    root = inline(child, "SignalDictionary")
                dictionaries[name] = read_dictionary(root, self.found)
            except DseError as error:
                self.found.problems += error.problems
        return dictionaries
