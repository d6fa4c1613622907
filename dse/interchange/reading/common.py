"""What all files of an SSP have in common: units, enumerations, types, transformations, and what is let pass."""

from __future__ import annotations

import math
import re
from collections.abc import Container, Iterator, Mapping, Set
from dataclasses import dataclass, field, replace
from difflib import get_close_matches

from dse.domain.fmu import UnitDefinition
from dse.errors import Location, Problem, closest, fail
from dse.fmu import BASE_UNITS, VALUE_KINDS, base_unit
from dse.formats import UNBOUND, XmlElement, shortened
from dse.interchange.structure import NamedUnit, SignalType, Transformation

SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
SSM = "http://ssp-standard.org/SSP1/SystemStructureParameterMapping"
SSB = "http://ssp-standard.org/SSP1/SystemStructureSignalDictionary"

TYPES = frozenset(VALUE_KINDS)
TRANSFORMATIONS = frozenset(
    {
        "LinearTransformation",
        "BooleanMappingTransformation",
        "IntegerMappingTransformation",
        "EnumerationMappingTransformation",
    }
)

OWN_ANNOTATION = "dse.simulation"
"""Type of the annotation of an experiment in which this program keeps what SSP has no words for."""
STEP_ELEMENTS = {"FixedStepMaster": "stepSize", "FixedStepAlgorithm": "baseStepSize"}
"""The elements of OMSimulator's and OSP's annotations that say the step, and in which attribute."""

_MODELICA = "text/x-modelica"
"""What Dymola calls a binary that is none: it names the variable's type in Modelica."""
_STANDARD = "http://ssp-standard.org/"
_PREFIXES = {f"{UNBOUND}{prefix}" for prefix in ("ssb", "ssc", "ssd", "ssm", "ssv")}
"""Namespaces that can only be the standard's, though the file does not say so."""

BASE = frozenset({"id", "description"})
"""Attributes that any element may have."""
META = frozenset({"author", "fileversion", "copyright", "license", "generationTool", "generationDateAndTime"})
"""Attributes that the root of any file may have."""
EXTRAS = frozenset({"Annotations", "MetaData", "Signature"})
"""Elements that any element may hold and that say nothing of how it is simulated."""
_OPEN = EXTRAS | {"SimulationInformation"}
"""Elements that may hold anything."""

NOTHING: frozenset[str] = frozenset()


@dataclass(slots=True)
class Findings:
    """What is wrong with a package, and what in it is of no use here, as its elements are read.

    *notes* are of what the standard allows, *ignored* of what it does not.
    """

    problems: list[Problem] = field(default_factory=list)
    notes: list[Problem] = field(default_factory=list)
    ignored: list[Problem] = field(default_factory=list)

    def add(self, what: str, where: Location, hint: str = "") -> None:
        """One more thing that is wrong."""
        self.problems.append(Problem(what, where, hint))

    def ignore(self, what: str, where: Location) -> None:
        """One more thing that should not be there, and that nothing needs."""
        self.ignored.append(Problem(what, where))

    def expect(self, element: XmlElement, attributes: Set[str] = NOTHING, children: Set[str] = NOTHING) -> None:
        """Every child that SSP does not know here is wrong, and every attribute that may be a misspelt one.

        Annotations are of no use.
        """
        for name in element.attributes:
            # Attributes of other namespaces (xsi:schemaLocation) belong to others.
            if not name.startswith("{") and name not in attributes | BASE:
                what = f"<{element.tag}> has no attribute '{name}'"
                if get_close_matches(name, attributes | BASE, n=1):
                    self.add(what, element.where, closest(name, attributes | BASE))
                else:
                    self.ignore(what, element.where)
        for child in element.children:
            if child.tag in EXTRAS:
                self.notes += _extras(child)
            elif child.tag not in children:
                hint = closest(child.tag, children | EXTRAS)
                self.add(f"<{child.tag}> is not allowed in <{element.tag}>", child.where, hint)

    def listed(self, element: XmlElement, group: str, tag: str) -> Iterator[XmlElement]:
        """The elements called *tag* in each *group* of *element*, which may hold nothing else."""
        for found in element.all(group):
            self.expect(found, NOTHING, {tag})
            yield from found.all(tag)

    def new(self, element: XmlElement, taken: Container[str], what: str, attribute: str = "name") -> str:
        """The name (or other attribute) of *element*, a *what*; a problem if it has none, or one that is *taken*."""
        name = element.required(attribute, self.problems)
        if name in taken:
            self.add(f"{what} '{shortened(name)}' is there twice", element.where)
        return name

    def finite(self, element: XmlElement, name: str) -> float | None:
        """The attribute as a finite number; None if it is not there, and a problem if it is no such number."""
        value = element.real(name, self.problems)
        if value is not None and not math.isfinite(value):
            self.add(f"<{element.tag}>: '{name}' cannot be {value:g}", element.where)
            return None
        return value

    def positive(self, element: XmlElement, name: str) -> float | None:
        """The attribute as a positive number; None if it is not there, and a problem if it is no such number."""
        value = self.finite(element, name)
        if value is not None and value <= 0:
            self.add(f"<{element.tag}>: '{name}' must be positive, not {value:g}", element.where)
            return None
        return value


def _extras(element: XmlElement) -> list[Problem]:
    if element.tag != "Annotations":
        return [Problem(f"<{element.tag}> is not used", element.where)]
    return [
        Problem(f"the annotation '{shortened(annotation.get('type'))}' is not used", annotation.where)
        for annotation in element.all("Annotation")
        if annotation.get("type") != OWN_ANNOTATION and not any(a.tag in STEP_ELEMENTS for a in annotation.walk())
    ]


@dataclass(frozen=True, slots=True)
class Scope:
    """The units and enumerations one file defines."""

    units: Mapping[str, UnitDefinition]
    enumerations: Mapping[str, Mapping[str, int]]


def own_elements(element: XmlElement, found: Findings) -> XmlElement:
    """*element* without what is in the namespaces of others, but for what stands where others may write."""
    children: list[XmlElement] = []
    for child in element.children:
        if child.namespace and not (child.namespace.startswith(_STANDARD) or child.namespace in _PREFIXES):
            found.ignore(f"<{child.tag}> is of the namespace '{shortened(child.namespace)}'", child.where)
        else:
            children.append(child if child.tag in _OPEN else own_elements(child, found))
    return replace(element, children=tuple(children))


def require_root(root: XmlElement, tag: str, namespace: str, found: Findings) -> None:
    """Raise DseError unless *root* is SSP's element *tag* in a version that is known."""
    if root.tag != tag:
        raise fail(f"<{tag}> is expected here, not <{root.tag}>", root.where, "it is not a file of this kind")
    if root.namespace != namespace and root.namespace not in _PREFIXES:
        what = f"<{tag}> is in the namespace '{shortened(root.namespace)}', not '{namespace}'"
        if not root.namespace.startswith(_STANDARD):
            raise fail(what, root.where, "drafts before SSP 1.0 are not supported; export it as SSP 1.0 or 2.0")
        found.ignore(what, root.where)
    # OMSimulator leaves it out where one file is written into another; then the namespace has to do.
    version = root.get("version", "1.0")
    if not re.fullmatch(r"[12]\.\d+(?:-.*)?", version):
        what = f"the version '{shortened(version)}' of SSP is not supported"
        raise fail(what, root.where, "export it as SSP 1.0 or 2.0")


def inline(element: XmlElement, tag: str) -> XmlElement:
    """The single child *tag* that *element* holds. Raises DseError if it holds something else."""
    if len(element.children) == 1 and element.children[0].tag == tag:
        return element.children[0]
    raise fail(f"<{element.tag}> must hold one <{tag}>", element.where)


def read_scope(root: XmlElement, found: Findings) -> Scope:
    """The units and enumerations that the file of *root* defines."""
    units: dict[str, UnitDefinition] = {}
    for element in found.listed(root, "Units", "Unit"):
        found.expect(element, {"name"}, {"BaseUnit"})
        name = found.new(element, units, "the unit")
        base = element.child("BaseUnit")
        if base is None:
            found.add(f"the unit '{shortened(name)}' has no <BaseUnit>", element.where)
        else:
            found.expect(base, {*BASE_UNITS, "factor", "offset"})
            units[name] = base_unit(base, found.problems)
    enumerations: dict[str, Mapping[str, int]] = {}
    for element in found.listed(root, "Enumerations", "Enumeration"):
        found.expect(element, {"name"}, {"Item"})
        enumerations[found.new(element, enumerations, "the enumeration")] = _items(element, found)
    return Scope(units, enumerations)


def _items(element: XmlElement, found: Findings) -> dict[str, int]:
    items: dict[str, int] = {}
    for item in element.all("Item"):
        found.expect(item, {"name", "value"})
        value = item.whole("value", found.problems)
        if value is None and "value" not in item.attributes:
            found.add("<Item> has no 'value'", item.where)
        items[found.new(item, items, "the item")] = value or 0
    return items


def unit_of(element: XmlElement, scope: Scope) -> NamedUnit | None:
    """The unit that *element* is given in, or None."""
    name = element.get("unit")
    return NamedUnit(name, scope.units.get(name)) if name else None


def read_type(element: XmlElement, scope: Scope, found: Findings) -> SignalType | None:
    """The type said in *element*, or None if none is."""
    child = _single(element, TYPES, "type", found)
    if child is None:
        return None
    if child.tag == "Clock":
        return SignalType(child.tag)
    if child.get("mime-type").startswith(_MODELICA):
        found.ignore(f"the type '{shortened(child.get('mime-type'))}' is left to the FMU", child.where)
        return None
    found.expect(child, {"unit", "name", "mime-type"})
    items = None
    if child.tag == "Enumeration":
        name = child.required("name", found.problems)
        items = scope.enumerations.get(name)
        if items is None and name:
            # Many tools leave it to the FMU to say what its items are.
            found.notes.append(Problem(f"the enumeration '{shortened(name)}' is not defined in this file", child.where))
    return SignalType(child.tag, unit_of(child, scope), items)


def _single(element: XmlElement, tags: Set[str], what: str, found: Findings) -> XmlElement | None:
    """The one child that has one of *tags*; None if there is none."""
    said = [child for child in element.children if child.tag in tags]
    if len(said) > 1:
        found.add(f"<{element.tag}> has more than one {what}", said[1].where)
    return said[0] if said else None


def read_sizes(element: XmlElement, found: Findings) -> tuple[int | None, ...]:
    """The sizes said by the <Dimension> elements in *element*; None for one that depends on something."""
    sizes = []
    for child in element.all("Dimension"):
        found.expect(child, {"size", "sizeConnector"})
        sizes.append(child.whole("size", found.problems, least=1, most=2**31))
    return tuple(sizes)


def read_transformation(element: XmlElement, found: Findings) -> Transformation | None:
    """The transformation said in *element*, or None if none is."""
    child = _single(element, TRANSFORMATIONS, "transformation", found)
    if child is None:
        return None
    if child.tag == "LinearTransformation":
        found.expect(child, {"factor", "offset"})
        factor, offset = found.finite(child, "factor"), found.finite(child, "offset")
        return Transformation(child.tag, 1.0 if factor is None else factor, offset or 0.0, where=child.where)
    found.expect(child, NOTHING, {"MapEntry"})
    entries: dict[str, str] = {}
    for entry in child.all("MapEntry"):
        found.expect(entry, {"source", "target"})
        target = entry.required("target", found.problems)
        entries[found.new(entry, entries, "the source", "source")] = target
    return Transformation(child.tag, entries=tuple(entries.items()), where=child.where)
