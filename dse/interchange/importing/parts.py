"""The FMUs of a package as components whose ports fit what they are connected to."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from dse.domain.component import Component, Interface, Kind, Port, Type, same_signal
from dse.domain.design import Connection
from dse.domain.fmu import FmiInterface, FmuModel, Variable
from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.fmu import open_fmu
from dse.interchange.importing.fmu_component import offer
from dse.interchange.names import each_named, free_word
from dse.interchange.resolving.resolve import ResolvedSystem
from dse.interchange.structure import SspComponent, SspSystem
from dse.interchange.writing.connections import carries_the_same
from dse.kinds import FmuSource
from dse.system import bind


@dataclass(slots=True)
class Catalogue:
    """The components of a workspace while it is made, with their FMUs, by name; *left_out* tells what they lack."""

    components: dict[str, Component] = field(default_factory=dict)
    models: dict[str, FmuModel] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)
    cache: Path | None = None
    _names: dict[tuple[str, FmiInterface], str] = field(default_factory=dict)
    _labels: dict[str, dict[str, str]] = field(default_factory=dict)

    def take(self, place: SspComponent, element: Element) -> str:
        """The name of the component for what stands at *place*; the same for the same FMU in the same interface."""
        model = element.model
        name = self._names.get((model.content_hash, model.interface))
        if name is None:
            name = free_word(Path(place.source.partition("#")[0]).stem, self.components)
            is_usual = model.interface is open_fmu(place.fmu, cache=self.cache).interface
            made = offer(name, model, FmuSource(Path(f"{name}.fmu"), None if is_usual else model.interface))
            component = made.component
            self.left_out += [f"{name}: {what}" for what in made.left_out]
            self._names[model.content_hash, model.interface] = name
            self.components[name], self.models[name] = component, model
            known = (*(port.name for port in component.interface.ports), *(p.name for p in component.parameters))
            self._labels[name] = {component.variable(own): own for own in known}
        elif [v.shape for v in self.models[name].variables.values()] != [v.shape for v in model.variables.values()]:
            what = (
                f"{element.name}: two uses of its FMU have arrays of different sizes, which a workspace cannot express"
            )
            raise DseError(Problem(what, place.where))
        return name

    def own_name(self, component: str, label: str) -> str | None:
        """What *component* calls the value *label* of its FMU; None if it does not have it."""
        return self._labels[component].get(label)

    def interfaces(self) -> list[Interface]:
        """Every interface a component implements, each once."""
        return list({c.interface.name: c.interface for c in self.components.values()}.values())


@dataclass(frozen=True, slots=True)
class Parts:
    """A package's elements in words of a workspace: *names* are those of their parts, *kinds* of the components there.

    The catalogue's components change as more is known of them.
    """

    resolved: ResolvedSystem
    catalogue: Catalogue
    names: Mapping[str, str]
    kinds: Mapping[str, str]

    def component(self, element: str) -> Component:
        """What stands there."""
        return self.catalogue.components[self.kinds[element]]

    def own_name(self, element: str, label: str) -> str | None:
        """The port or parameter behind the value *label*; None if there is none."""
        return self.catalogue.own_name(self.kinds[element], label)

    def where(self, element: str, label: str) -> Location | None:
        """Where in the package the value, or the whole array it is one of, is connected or given."""
        places, name = self.resolved.places, f"{element}.{label}"
        return places.get(name) or places.get(name.rpartition("[")[0])


def take_parts(ssp: SspSystem, resolved: ResolvedSystem, catalogue: Catalogue) -> Parts:
    """The parts of *resolved*, which *ssp* was made to, their components in the *catalogue*."""
    elements = resolved.structure.elements
    kinds = {element.name: catalogue.take(ssp.places[element.name], element) for element in elements}
    return Parts(resolved, catalogue, each_named(kinds, free_word), kinds)


_PortOf = tuple[str, str]
"""A port by the names of its component and its own."""


def connect(parts: Parts) -> tuple[Connection, ...]:
    """The wires as connections of ports; types of ports are changed to fit.

    Raises DseError for every wire a workspace has no words for.
    """
    problems: list[Problem] = []
    ends: list[tuple[Wire, _PortOf, _PortOf]] = []
    for wire in _single(parts.resolved):
        if _follows(parts.resolved.structure, wire):
            continue
        start = parts.own_name(wire.source, wire.source_variable)
        end = parts.own_name(wire.target, wire.target_variable)
        if start is None or end is None:
            given, taken = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
            what = f"{_text(wire)}: '{given if start is None else taken}' cannot be a port of a workspace"
            where = parts.where(wire.target, wire.target_variable)
            problems.append(Problem(what, where, "clocks cannot be ports"))
        else:
            ends.append((wire, (parts.kinds[wire.source], start), (parts.kinds[wire.target], end)))
    raise_if_any(problems)
    _agree(parts.catalogue, [(start, end) for _, start, end in ends])
    raise_if_any(problem for wire, start, end in ends for problem in _misfits(parts, wire, start, end))
    return tuple(_together(parts, [(wire, start, end) for wire, (_, start), (_, end) in ends]))


def _follows(system: SystemStructure, wire: Wire) -> bool:
    """Whether *wire* joins clocks that tick together without it: by what belongs to them, and is wired alike."""

    def of(element: str, label: str) -> Variable | None:
        return system.element(element).model.variables.get(label)

    clock, target = of(wire.source, wire.source_variable), of(wire.target, wire.target_variable)
    if clock is None or target is None or not (clock.timing and target.timing):
        return False
    rings: set[tuple[str, int]] = set()
    for other in system.wires:
        given, taken = of(other.source, other.source_variable), of(other.target, other.target_variable)
        if given and taken and other.target == wire.target and target.reference in taken.clocks:
            rings |= {(other.source, reference) for reference in given.clocks}
    return rings == {(wire.source, clock.reference)}


def _together(parts: Parts, ends: list[tuple[Wire, str, str]]) -> Iterator[Connection]:
    """The connections, those between all values of two arrays (of structures, too) as one."""
    groups: dict[tuple[str, str, str, str], list[tuple[str, str]]] = {}
    for wire, start, end in ends:
        roots = start.partition("[")[0], end.partition("[")[0]
        is_alike = roots != (start, end) and start.removeprefix(roots[0]) == end.removeprefix(roots[1])
        given, taken = roots if is_alike else (start, end)
        groups.setdefault((wire.source, given, wire.target, taken), []).append((start, end))
    for (source, given, target, taken), pairs in groups.items():
        names = parts.names[source], parts.names[target]
        sides = [parts.component(source).interface.group(given), parts.component(target).interface.group(taken)]
        whole = [{port.name for port in side} for side in sides]
        if len(pairs) > 1 and whole == [{start for start, _ in pairs}, {end for _, end in pairs}]:
            yield Connection(f"{names[0]}.{given}", f"{names[1]}.{taken}")
        else:
            yield from (Connection(f"{names[0]}.{start}", f"{names[1]}.{end}") for start, end in pairs)


def _agree(catalogue: Catalogue, ends: list[tuple[_PortOf, _PortOf]]) -> None:
    """Give ports without a unit that of what they are connected to, and items the numbers they are where needed."""
    for _ in range(len(ends) + 1):
        before = dict(catalogue.components)
        for start, end in ends:
            source, target = _type(catalogue, start), _type(catalogue, end)
            if not same_signal(source, target):
                continue
            if source.kind is target.kind is Kind.REAL:
                if not target.unit.dimension and not _unit(catalogue, end):
                    _retype(catalogue, end, source)
                elif not source.unit.dimension and not _unit(catalogue, start):
                    _retype(catalogue, start, target)
            elif {source.kind, target.kind} <= {Kind.ENUMERATION, Kind.INTEGER}:
                _retype(catalogue, start, Type(Kind.INTEGER))
                _retype(catalogue, end, Type(Kind.INTEGER))
        if before == catalogue.components:
            return


def _type(catalogue: Catalogue, end: _PortOf) -> Type:
    port = catalogue.components[end[0]].interface.port(end[1])
    return port.type if port else Type(Kind.TEXT)


def _unit(catalogue: Catalogue, end: _PortOf) -> str:
    return catalogue.models[end[0]].variable_of(catalogue.components[end[0]].variable(end[1])).unit


def _retype(catalogue: Catalogue, end: _PortOf, type_: Type) -> None:
    component = catalogue.components[end[0]]
    alike = {port.name for port in component.interface.ports if _INDEX.sub("", port.name) == _INDEX.sub("", end[1])}
    ports = tuple(Port(p.name, p.causality, type_) if p.name in alike else p for p in component.interface.ports)
    catalogue.components[end[0]] = replace(component, interface=replace(component.interface, ports=ports))


_INDEX = re.compile(r"(?<=[\[,])\d+")
"""Values of one array differ in these only; they have one type."""


def _misfits(parts: Parts, wire: Wire, start: _PortOf, end: _PortOf) -> Iterator[Problem]:
    catalogue, where = parts.catalogue, parts.where(wire.target, wire.target_variable)
    types = [_type(catalogue, port) for port in (start, end)]
    difference = same_signal(*types)
    if difference:
        yield Problem(f"{_text(wire)}: {difference}", where, "a workspace connects what is of one type and unit")
        return
    try:
        source, target = (
            bind(catalogue.components[name], port, type_, catalogue.models[name], ("input", "output")).conversion
            for (name, port), type_ in zip((start, end), types, strict=True)
        )
    except DseError as error:
        yield from (Problem(f"{_text(wire)}: {p.what}", where, p.hint) for p in error.problems)
        return
    if not carries_the_same(wire, parts.resolved.structure, source, target):
        what = f"{_text(wire)}: its transformation is nothing a workspace has words for"
        yield Problem(what, where, "let a component do it, or simulate the package as it is: dse simulate FILE.ssp")


def _single(resolved: ResolvedSystem) -> Iterator[Wire]:
    """The wires with those of whole arrays as one for each value."""
    for wire in resolved.structure.wires:
        source = resolved.structure.element(wire.source).model.variables.get(wire.source_variable)
        target = resolved.structure.element(wire.target).model.variables.get(wire.target_variable)
        if source is not None and target is not None and source.shape:
            for start, end in zip(source.labels, target.labels, strict=True):
                yield replace(wire, source_variable=start, target_variable=end)
        else:
            yield wire


def _text(wire: Wire) -> str:
    return f"{wire.source}.{wire.source_variable} -> {wire.target}.{wire.target_variable}"
