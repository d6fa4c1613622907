"""OpenSCENARIO XML 1.0 to 1.3 → elements whose attributes are values, with parameters and catalogues resolved."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import isinf
from pathlib import Path
from typing import TypeVar

from dse.errors import DseError, Location, Problem, closest, fail
from dse.formats import XmlElement, read_xml, shortened, shown, xml_content
from dse.world.openscenario.expressions import Number, Value, constant, read_value, tunable

T = TypeVar("T")

NUMERIC = frozenset({"double", "int", "integer", "unsignedInt", "unsignedShort", "boolean"})
_CATALOGS = {
    "Vehicle": "VehicleCatalog", "Pedestrian": "PedestrianCatalog", "MiscObject": "MiscObjectCatalog",
    "Controller": "ControllerCatalog", "Environment": "EnvironmentCatalog", "Maneuver": "ManeuverCatalog",
    "Trajectory": "TrajectoryCatalog", "Route": "RouteCatalog",
}  # fmt: skip
_MOST_CATALOG_FILES = 1000
_MAY_BE_INFINITE = frozenset({
    "value", "delay", "duration", "tolerance", "distanceForward", "distanceBackward", "from", "to", "maxSpeed",
    "maxAcceleration", "maxDeceleration", "maxLateralAcc", "maxAccelerationRate", "maxDecelerationRate",
})  # fmt: skip
MOST_ELEMENTS = 10_000
# Counted before a file is read as XML, which takes seconds if it has that many. Each action of a storyboard may have a
# private action, and so may <Init>.
_COUNTED = {
    re.compile(rb"<!--.*?-->|<(?:Story|Act|ManeuverGroup|Maneuver|Event|Action)[\s/>]", re.DOTALL): (
        MOST_ELEMENTS,
        f"a storyboard has at most {MOST_ELEMENTS} elements",
    ),
    re.compile(rb"<!--.*?-->|<PrivateAction[\s/>]", re.DOTALL): (
        2 * MOST_ELEMENTS,
        f"a scenario has at most {2 * MOST_ELEMENTS} private actions",
    ),
}
_REFERENCE = re.compile(r"\$[A-Za-z_]")


@dataclass(slots=True)
class Context:
    """What is common to a scenario: its *path*, values *given* from outside, and what was found on the way.

    *fixed* are names of parameters that are not tunable, as something depends on them that is decided when the FMU is
    built. *ignored* are elements that do not matter to a simulation. *files* are the road network and the catalogues
    that it uses, each with its name, or that of its folder, as it is written.
    """

    path: Path
    given: Mapping[str, str]
    fixed: frozenset[str]
    inside: Path | None = None
    found_fixed: set[str] = field(default_factory=set)
    ignored: list[Problem] = field(default_factory=list)
    catalogs: dict[tuple[str, str], tuple[XmlElement, Path, str]] = field(default_factory=dict)
    files: dict[Path, str] = field(default_factory=dict)

    def file(self, name: str, where: Location, what: str) -> Path:
        """The file or folder *name*, seen from the scenario. Raises DseError: not there, or outside the workspace."""
        missing = fail(f"{what} '{shortened(name)}' does not exist", where)
        try:
            path = (self.path.parent / name.replace("\\", "/")).resolve()
            is_there = path.is_file() or path.is_dir()
        except (OSError, RuntimeError) as error:  # a name that is too long, links in a circle
            raise missing from error
        if self.inside is not None and not path.is_relative_to(self.inside.resolve()):
            raise fail(f"{what} '{shortened(name)}' is outside the workspace", where)
        if not is_there:
            raise missing
        return path


@dataclass(frozen=True, slots=True, eq=False)
class Node:
    """An element with the parameters that its attributes may name."""

    element: XmlElement
    scope: Mapping[str, Value]
    context: Context

    @property
    def tag(self) -> str:
        """The name of the element."""
        return self.element.tag

    @property
    def where(self) -> Location:
        """Where it is in its file."""
        return self.element.where

    def has(self, name: str) -> bool:
        """Whether the attribute is there and not empty."""
        return self.element.get(name).strip() != ""

    def value(self, name: str) -> Value:
        """The value of an attribute. Raises DseError located at the element where it is missing or wrong."""
        if name not in self.element.attributes:
            raise fail(f"<{self.tag}> has no '{name}'", self.where)
        return read_value(self.element.get(name), self.scope, self.where)

    def number(self, name: str, default: float | None = None) -> Number:
        """The attribute as a number, or *default*."""
        if default is not None and not self.has(name):
            return constant(default)
        value = self.value(name)
        if isinstance(value, str):
            raise fail(f"<{self.tag}>: '{name}' is '{shortened(value)}', not a number", self.where)
        if isinf(value.value) and name not in _MAY_BE_INFINITE:
            raise fail(f"<{self.tag}>: '{name}' is infinite", self.where)
        return value

    def real(self, name: str, default: float | None = None) -> float:
        """The attribute as a number that is decided when the FMU is built."""
        return self._decided(self.number(name, default)).value

    def whole(self, name: str, default: int | None = None) -> int:
        """The attribute as a whole number that is decided when the FMU is built."""
        value = self.real(name, default)
        if not abs(value) <= 1e9 or value != round(value):
            raise fail(f"<{self.tag}>: '{name}' is {value:g}, not a whole number", self.where)
        return round(value)

    def text(self, name: str, default: str | None = None) -> str:
        """The attribute as a text."""
        if default is not None and not self.has(name):
            return default
        value = self.value(name)
        if isinstance(value, str):
            return value
        raw = self.element.get(name).strip()
        self._decided(value)
        return raw if not raw.startswith("$") else f"{value.value:g}"

    def flag(self, name: str, *, default: bool = False) -> bool:
        """The attribute as a truth value."""
        if not self.has(name):
            return default
        value = self.value(name)
        if isinstance(value, str) or self._decided(value).value not in (0.0, 1.0):
            raise fail(
                f"<{self.tag}>: '{name}' is '{shortened(self.element.get(name))}', not true or false", self.where
            )
        return value.value == 1.0

    def word(self, name: str, words: Mapping[str, T], default: str | None = None) -> T:
        """What *words* has for the attribute. Raises DseError for one that is not supported."""
        text = self.text(name, default)
        if text not in words:
            raise fail(f"<{self.tag}>: {name} '{shortened(text)}' is not supported", self.where, closest(text, words))
        return words[text]

    def child(self, *tags: str) -> Node | None:
        """The first child with one of these tags, or None."""
        found = next((child for child in self.element.children if child.tag in tags), None)
        return None if found is None else Node(found, self.scope, self.context)

    def need(self, *tags: str) -> Node:
        """The first child with one of these tags. Raises DseError where there is none."""
        found = self.child(*tags)
        if found is None:
            raise fail(f"<{self.tag}> has no <{'> or <'.join(tags)}>", self.where)
        return found

    def all(self, tag: str) -> Iterator[Node]:
        """The children with this tag, in order."""
        return (Node(child, self.scope, self.context) for child in self.element.all(tag))

    def children(self) -> Iterator[Node]:
        """All children, in order."""
        return (Node(child, self.scope, self.context) for child in self.element.children)

    def only(self) -> Node:
        """Its first child: the choice that the element makes. Raises DseError where it is empty."""
        for child in self.children():
            return child
        raise fail(f"<{self.tag}> is empty", self.where)

    def unsupported(self) -> DseError:
        """What to raise where the element is not supported."""
        return fail(f"<{self.tag}> is not supported", self.where)

    def ignore(self, because: str) -> None:
        """Note that the element does not matter to a simulation."""
        self.context.ignored.append(Problem(f"<{self.tag}>: {because}", self.where))

    def with_parameters(self, assigned: Mapping[str, Value] | None = None) -> Node:
        """The element with its own <ParameterDeclarations>; *assigned* values go before their defaults."""
        declared = self.child("ParameterDeclarations")
        if declared is None and not assigned:
            return self
        scope = dict(self.scope)
        for each in declared.all("ParameterDeclaration") if declared else ():
            name = each.element.get("name")
            value = (assigned or {}).get(name)
            scope[name] = read_value(each.element.get("value"), scope, each.where) if value is None else value
        return Node(self.element, scope, self.context)

    def resolved(self) -> Node:
        """A <CatalogReference> as the entry that it means; each with its own parameters."""
        if self.tag != "CatalogReference":
            return self.with_parameters()
        catalog, entry = self.text("catalogName"), self.text("entryName")
        assigned = {
            each.element.get("parameterRef").removeprefix("$"): each.value("value")
            for group in self.all("ParameterAssignments")
            for each in group.all("ParameterAssignment")
        }
        found = self.context.catalogs.get((catalog, entry))
        if found is None:
            names = [f"{a}/{b}" for a, b in self.context.catalogs]
            what = f"no catalogue '{shortened(catalog)}' has an entry '{shortened(entry)}'"
            raise fail(what, self.where, closest(f"{catalog}/{entry}", names) if names else "no catalogue was found")
        element, path, name = found
        self.context.files[path] = name
        return Node(element, {}, self.context).with_parameters(assigned)

    def _decided(self, number: Number) -> Number:
        self.context.found_fixed.update(number.names)
        return number


@dataclass(frozen=True, slots=True)
class Parameter:
    """A declared parameter that an FMU can be given: its *start*, bounds (None: open) and type of OpenSCENARIO."""

    name: str
    type: str
    start: float
    least: float | None
    most: float | None
    where: Location

    def allows(self, value: float) -> bool:
        """Whether *value* is within its bounds."""
        return not ((self.least is not None and value < self.least) or (self.most is not None and value > self.most))


@dataclass(frozen=True, slots=True, eq=False)
class Document:
    """A scenario file: its *root*, the *parameters* that can be tuned, and those *decided* when the FMU is built."""

    root: Node
    parameters: tuple[Parameter, ...]
    decided: Mapping[str, str]


def open_document(context: Context) -> Document:
    """The scenario of *context*. Raises DseError located in the file: not OpenSCENARIO 1.x, no storyboard, …"""
    element = _read(context.path)
    root = Node(element, {}, context)
    if root.tag != "OpenSCENARIO":
        raise fail(f"an OpenSCENARIO file begins with <OpenSCENARIO>, not with <{shortened(root.tag)}>", root.where)
    header = root.child("FileHeader")
    if header is not None and header.text("revMajor", "1") != "1":
        raise fail(
            f"OpenSCENARIO {header.text('revMajor')} is not supported", header.where, "supported: XML 1.0 to 1.3"
        )
    if root.child("ParameterValueDistribution") is not None:
        raise fail(
            "this is a distribution of parameters, not a scenario", root.where, "give the scenario that it names"
        )
    scope: dict[str, Value] = {}
    parameters: dict[str, Parameter] = {}
    decided: dict[str, str] = {}
    declared = root.child("ParameterDeclarations")
    names = [each.element.get("name") for each in declared.all("ParameterDeclaration")] if declared else []
    for name in context.given:
        if name not in names:
            raise fail(f"the scenario has no parameter '{shortened(name)}'", root.where, closest(name, names))
    for each in declared.all("ParameterDeclaration") if declared else ():
        name, type_, text = each.element.get("name"), each.element.get("parameterType"), each.element.get("value")
        if not name:
            raise fail("<ParameterDeclaration> has no 'name'", each.where)
        text = context.given.get(name, text)
        value = read_value(text, scope, each.where)
        depends = _REFERENCE.search(text) is not None
        if isinstance(value, Number) and type_ in NUMERIC and not depends and name not in context.fixed:
            parameters[name] = Parameter(name, type_, value.value, *_bounds(each, scope), each.where)
            value = tunable(name, value.value)
        elif not depends:
            decided[name] = text
        if name in scope:
            each.ignore(f"'{shortened(name)}' was declared before; the last declaration holds")
        scope[name] = value
    root = Node(element, scope, context)
    _find_catalogs(root)
    return Document(root, tuple(parameters.values()), decided)


def _read(path: Path) -> XmlElement:
    content, file = xml_content(path, shown(path)), shown(path)
    for pattern, (most, what) in _COUNTED.items():
        tags = (found for found in pattern.finditer(content) if not found[0].startswith(b"<!"))
        if beyond := next(itertools.islice(tags, most, None), None):
            at = beyond.start()
            raise fail(what, Location(file, content.count(b"\n", 0, at) + 1, at - content.rfind(b"\n", 0, at)))
    return read_xml(content, file)


def _bounds(declaration: Node, scope: Mapping[str, Value]) -> tuple[float | None, float | None]:
    """The range that all constraint groups allow together: of several groups one has to fit."""
    ranges = []
    for group in declaration.all("ConstraintGroup"):
        low, high = None, None
        for each in group.all("ValueConstraint"):
            value = read_value(each.element.get("value"), scope, each.where)
            rule = each.element.get("rule")
            if isinstance(value, Number) and not value.names:
                if rule in {"greaterThan", "greaterOrEqual", "equalTo"}:
                    low = value.value if low is None else max(low, value.value)
                if rule in {"lessThan", "lessOrEqual", "equalTo"}:
                    high = value.value if high is None else min(high, value.value)
        ranges.append((low, high))
    if not ranges:
        return None, None
    lows, highs = [low for low, _ in ranges], [high for _, high in ranges]
    known_lows, known_highs = [low for low in lows if low is not None], [high for high in highs if high is not None]
    return (
        min(known_lows) if len(known_lows) == len(ranges) else None,
        max(known_highs) if len(known_highs) == len(ranges) else None,
    )


def _find_catalogs(root: Node) -> None:
    """All entries of the catalogues that the scenario names; folders that do not exist have none."""
    locations = root.child("CatalogLocations")
    for location in locations.children() if locations else ():
        if location.tag not in _CATALOGS.values():
            raise location.unsupported()
        directory = location.need("Directory")
        name = directory.text("path")
        try:
            folder = root.context.file(name, directory.where, "the folder")
        except DseError as error:
            if "outside" in str(error):
                raise
            continue
        files = sorted(folder.glob("*.xosc")) if folder.is_dir() else [folder]
        if len(files) > _MOST_CATALOG_FILES:
            raise fail(f"a folder of catalogues has at most {_MOST_CATALOG_FILES} files", directory.where)
        for file in files:
            catalog = _read(file).child("Catalog")
            for entry in catalog.children if catalog is not None else ():
                # Some files are found by their own name only.
                for called in (catalog.get("name"), file.stem):  # type: ignore[union-attr]
                    root.context.catalogs.setdefault((called, entry.get("name")), (entry, file, name))
