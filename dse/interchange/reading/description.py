"""System structure descriptions (SSD): systems, components and the connections between them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import PurePosixPath

from dse.errors import DseError, Location, closest, fail
from dse.formats import XmlElement, shortened, whole_of
from dse.interchange.reading.bindings import read_bindings
from dse.interchange.reading.common import (
    META,
    NOTHING,
    OWN_ANNOTATION,
    SSB,
    SSD,
    STEP_ELEMENTS,
    TRANSFORMATIONS,
    TYPES,
    Findings,
    Scope,
    inline,
    read_scope,
    read_sizes,
    read_transformation,
    read_type,
    require_root,
)
from dse.interchange.reading.package import DEFAULT, Package, PackageFile, Target, open_package
from dse.interchange.structure import (
    Connector,
    DictionaryReference,
    End,
    ExperimentSettings,
    SignalType,
    SspComponent,
    SspConnection,
    SspSystem,
    System,
)

_FMU = "application/x-fmu-sharedlibrary"
_DEFINITION = "application/x-ssp-definition"
_PACKAGE = "application/x-ssp-package"
_DICTIONARY = "application/x-ssp-signal-dictionary"

_KINDS = ("input", "output", "parameter", "calculatedParameter", "structuralParameter", "constant", "local", "inout")
_MOST_LEVELS = 20
_ELEMENT = frozenset({"Connectors", "ElementGeometry", "ParameterBindings"})
_CONTENT = frozenset(
    {"Elements", "Connections", "SignalDictionaries", "SystemGeometry", "GraphicalElements", "SimulationInformation"}
)


def read_description(package: Package, name: PurePosixPath, found: Findings, level: int = 0) -> SspSystem:
    """What the package's ``.ssd`` file says, and all it names. Raises DseError if it is none; the rest is *found*."""
    here = Location(package.place(name))
    if level > _MOST_LEVELS:
        raise fail(f"packages and systems are nested more than {_MOST_LEVELS} levels deep", here)
    root = PackageFile(package, PurePosixPath(DEFAULT)).read(str(name), here, found)
    require_root(root, "SystemStructureDescription", SSD, found)
    children = {"System", "Enumerations", "Units", "DefaultExperiment", "SSDVariant"}
    found.expect(root, META | {"version", "name"}, children)
    top = root.child("System")
    if top is None:
        raise fail("there is no <System>", root.where)
    reader = _Reader(PackageFile(package, name), root, read_scope(root, found), found)
    return SspSystem(
        name=root.required("name", found.problems),
        variant=name.stem,
        version=root.get("version"),
        system=reader.system(top, level),
        experiment=_experiment(root, top, found),
    )


def _experiment(root: XmlElement, top: XmlElement, found: Findings) -> ExperimentSettings:
    element = root.child("DefaultExperiment")
    said: dict[str, float | None] = {}
    if element is not None:
        found.expect(element, {"startTime", "stopTime"})
        said = {"start": found.finite(element, "startTime"), "stop": found.positive(element, "stopTime")}
        for annotation in element.below("Annotations", "Annotation"):
            if annotation.get("type") == OWN_ANNOTATION:
                for own in annotation.children:
                    said["step"] = found.positive(own, "step")
                    said["record_every"] = found.positive(own, "recordEvery")
                    said["tolerance"] = found.positive(own, "tolerance")
    if said.get("step") is None:
        extras = [] if element is None else [*element.all("Annotations")]
        extras += [extra for tag in ("Annotations", "SimulationInformation") for extra in top.all(tag)]
        masters = [master for extra in extras for master in extra.walk() if master.tag in STEP_ELEMENTS]
        if masters:
            said["step"] = found.positive(masters[0], STEP_ELEMENTS[masters[0].tag])
    return ExperimentSettings(**said)


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads the elements of one file."""

    file: PackageFile
    root: XmlElement
    scope: Scope
    found: Findings

    def system(self, element: XmlElement, level: int) -> System:
        found = self.found
        if level > _MOST_LEVELS:
            raise fail(f"packages and systems are nested more than {_MOST_LEVELS} levels deep", element.where)
        found.expect(element, {"name"}, _ELEMENT | _CONTENT)
        elements: list[SspComponent | DictionaryReference | System] = []
        names: set[str] = set()
        for child in element.below("Elements"):
            found.expect(child, NOTHING, {"Component", "SignalDictionaryReference", "System"})
            for inner in child.children:
                name = inner.get("name")
                if name in names:
                    found.add(f"two elements are called '{shortened(name)}'", inner.where, "rename one of them")
                names.add(name)
                try:
                    elements += self._element(inner, level)
                except DseError as error:
                    found.problems += error.problems
        return System(
            element.required("name", found.problems),
            tuple(elements),
            tuple(self._connection(c) for c in element.below("Connections", "Connection")),
            self._connectors(element),
            read_bindings(self.file, element, None, found),
            self._dictionaries(element),
        )

    def _element(self, element: XmlElement, level: int) -> list[SspComponent | DictionaryReference | System]:
        name = element.required("name", self.found.problems)
        match element.tag:
            case "System":
                return [self.system(element, level + 1)]
            case "SignalDictionaryReference":
                self.found.expect(element, {"name", "dictionary"}, _ELEMENT)
                named = element.required("dictionary", self.found.problems)
                return [DictionaryReference(name, named, self._connectors(element), element.where)]
            case "Component":
                return [self._component(name, element, level)]
        return []

    def _component(self, name: str, element: XmlElement, level: int) -> SspComponent | System:
        self.found.expect(element, {"name", "type", "source", "implementation"}, _ELEMENT)
        source = element.get("source")
        if not source:
            what = f"component '{shortened(name)}' has no 'source', so there is nothing to simulate"
            raise fail(what, element.where, "name its FMU, as resources/part.fmu")
        type_ = element.get("type", _FMU)
        if type_ not in (_FMU, _DEFINITION, _PACKAGE):
            what = f"component '{shortened(name)}' is of the type '{shortened(type_)}', which is not supported"
            raise fail(what, element.where, "components are FMUs, systems (.ssd) or packages (.ssp)")
        target = self.file.follow(source, element.where)
        if type_ == _FMU:
            assigned = read_bindings(self.file, element, target.path, self.found)
            kinds = ("any", "CoSimulation", "ModelExchange")
            implementation = element.word("implementation", kinds, self.found.problems, "any")
            connectors = self._connectors(element)
            return SspComponent(name, source, target.path, connectors, assigned, element.where, implementation)
        inner = self._nested(type_, target, element, level)
        # Bindings of the component come after those of the system it stands for (SSP, ParameterBindings).
        assigned = read_bindings(self.file, element, None, self.found)
        return replace(inner, name=name, assignments=(*inner.assignments, *assigned))

    def _nested(self, type_: str, target: Target, element: XmlElement, level: int) -> System:
        package = self.file.package
        if type_ == _PACKAGE:
            inner, variant = open_package(target.path, package.into, self.found)
            inner = replace(inner, called=package.place(target.file))
            file = PurePosixPath(target.fragment or f"{variant}.ssd")
            return read_description(inner, file, self.found, level + 1).system
        if not element.get("source").startswith("#"):
            return read_description(package, target.file, self.found, level + 1).system
        systems = [e for e in self.root.walk() if e.tag == "System" and e.get("id")]
        meant = next((e for e in systems if e.get("id") == target.fragment), None)
        if meant is None:
            what = f"no system in this file has the id '{shortened(target.fragment)}'"
            raise fail(what, element.where, closest(target.fragment, [e.get("id") for e in systems]))
        return self.system(meant, level + 1)

    def _connectors(self, element: XmlElement) -> tuple[Connector, ...]:
        connectors: dict[str, Connector] = {}
        for child in element.below("Connectors", "Connector"):
            self.found.expect(child, {"name", "kind"}, TYPES | {"ConnectorGeometry", "Dimension"})
            name = self.found.new(child, connectors, "connector")
            kind = child.word("kind", _KINDS, self.found.problems)
            if "kind" not in child.attributes:
                self.found.add(f"connector '{shortened(name)}' has no 'kind'", child.where)
            type_ = read_type(child, self.scope, self.found)
            connectors[name] = Connector(name, kind, type_, child.where, read_sizes(child, self.found))
        return tuple(connectors.values())

    def _connection(self, element: XmlElement) -> SspConnection:
        ends = {f"{end}{what}" for end in ("start", "end") for what in ("Element", "Connector", "Indices")}
        self.found.expect(element, ends | {"suppressUnitConversion"}, TRANSFORMATIONS | {"ConnectionGeometry"})
        return SspConnection(
            self._end(element, "start"),
            self._end(element, "end"),
            element.where,
            read_transformation(element, self.found),
            element.flag("suppressUnitConversion", self.found.problems),
        )

    def _end(self, element: XmlElement, end: str) -> End:
        text = element.get(f"{end}Indices")
        numbers = [whole_of(number) for number in text.split()]
        indices = tuple(number for number in numbers if number is not None)
        if len(indices) < len(numbers):
            self.found.add(f"'{end}Indices' is '{shortened(text)}', no list of whole numbers", element.where)
        return End(element.get(f"{end}Element"), element.required(f"{end}Connector", self.found.problems), indices)

    def _dictionaries(self, element: XmlElement) -> dict[str, dict[str, SignalType]]:
        dictionaries: dict[str, dict[str, SignalType]] = {}
        for child in element.below("SignalDictionaries", "SignalDictionary"):
            self.found.expect(child, {"name", "type", "source"}, {"SignalDictionary"})
            name = child.required("name", self.found.problems)
            type_, source = child.get("type", _DICTIONARY), child.get("source")
            try:
                if type_ != _DICTIONARY:
                    what = f"signal dictionary '{shortened(name)}' is of the type '{shortened(type_)}'"
                    raise fail(f"{what}, which is not supported", child.where)
                root = self.file.read(source, child.where, self.found) if source else inline(child, "SignalDictionary")
                dictionaries[name] = read_dictionary(root, self.found)
            except DseError as error:
                self.found.problems += error.problems
        return dictionaries


# Signal dictionaries (SSB): the signals of a bus, by name.


def read_dictionary(root: XmlElement, found: Findings) -> dict[str, SignalType]:
    """The entries of an ``ssb:SignalDictionary``. Raises DseError if *root* is none; all else goes to *found*."""
    require_root(root, "SignalDictionary", SSB, found)
    found.expect(root, META | {"version"}, {"DictionaryEntry", "Enumerations", "Units"})
    scope = read_scope(root, found)
    entries: dict[str, SignalType] = {}
    for element in root.all("DictionaryEntry"):
        found.expect(element, {"name"}, TYPES | {"Dimension"})
        name = found.new(element, entries, "the entry")
        type_ = read_type(element, scope, found)
        if type_ is None:
            found.add(f"the entry '{shortened(name)}' has no type", element.where)
        else:
            entries[name] = type_
    return entries
