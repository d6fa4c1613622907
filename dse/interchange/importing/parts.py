"""The FMUs of a package as components whose ports fit what they are connected to."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from dse.domain.component import Component, Interface, Kind, Port, Type, same_signal
from dse.domain.design import Connection
from dse.domain.fmu import FmuModel
from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.interchange.importing.names import free_name
from dse.interchange.importing.offer import offer
from dse.interchange.resolving.resolve import ResolvedSystem
from dse.interchange.structure import Component as SspComponent
from dse.interchange.writing.connections import carries_the_same
from dse.kinds.fmu import FmuSource
from dse.system.binding import bind


@dataclass(slots=True)
class Catalogue:
    """The components of a workspace while it is made, by the content of their FMUs; *left_out* tells what they lack."""

    left_out: list[str] = field(default_factory=list)
    _names: dict[str, str] = field(default_factory=dict)
    _components: dict[str, Component] = field(default_factory=dict)
    _models: dict[str, FmuModel] = field(default_factory=dict)
    _labels: dict[str, dict[str, str]] = field(default_factory=dict)

    def component(self, place: SspComponent, element: Element) -> Component:
        """The component for what stands at *place*; the same for the same FMU."""
        model = element.model
        name = self._names.get(model.content_hash)
        if name is None:
            name = free_name(Path(place.source.partition("#")[0]).stem, self._components)
            made = offer(name, model, FmuSource(Path(f"{name}.fmu")))
            self.left_out += [f"{name}: {what}" for what in made.left_out]
            self._names[model.content_hash] = name
            self._components[name], self._models[name] = made.component, model
        elif [v.shape for v in self._models[name].variables.values()] != [v.shape for v in model.variables.values()]:
            what = f"{element.name}: two uses of its FMU have arrays of different sizes, which a workspace cannot say"
            raise DseError(Problem(what, place.where))
        return self._components[name]

    def named(self, name: str) -> Component:
        """The component called *name*, as it is by now."""
        return self._components[name]

    def model(self, component: Component) -> FmuModel:
        """The FMU of *component*."""
        return self._models[component.name]

    def replace(self, component: Component) -> None:
        """Put *component* in the place of the one of its name."""
        self._components[component.name] = component

    def components(self) -> Iterator[tuple[Component, Path]]:
        """Each component with the archive of its FMU."""
        for name, component in self._components.items():
            yield component, self._models[name].archive

    def interfaces(self) -> list[Interface]:
        """Every interface a component implements, each once."""
        return list({c.interface.name: c.interface for c in self._components.values()}.values())

    def own_name(self, component: Component, label: str) -> str | None:
        """What *component* calls the value *label* of its FMU; None if it does not have it."""
        labels = self._labels.get(component.name)
        if labels is None:
            known = (*(port.name for port in component.interface.ports), *(p.name for p in component.parameters))
            labels = self._labels[component.name] = {component.variable(own): own for own in known}
        return labels.get(label)

    def connect(
        self,
        resolved: ResolvedSystem,
        names: Mapping[str, str],
        components: dict[str, Component],
    ) -> tuple[Connection, ...]:
        """The wires as connections of ports; types of ports are changed to fit, *components* are those after it.

        Raises DseError for every wire a workspace has no words for.
        """
        problems: list[Problem] = []
        ends = []
        for wire in _single(resolved.structure):
            source, target = components[wire.source], components[wire.target]
            start, end = self.own_name(source, wire.source_variable), self.own_name(target, wire.target_variable)
            if start is None or end is None:
                lacking = (
                    f"{wire.source}.{wire.source_variable}"
                    if start is None
                    else f"{wire.target}.{wire.target_variable}"
                )
                what = f"{_text(wire)}: '{lacking}' cannot be a port of a workspace"
                where = _place(resolved, wire)
                problems.append(Problem(what, where, "ports are numbers, truth values and items of enumerations"))
            else:
                ends.append((wire, (source.name, start), (target.name, end)))
        raise_if_any(problems)
        self._agree(ends)
        for name, component in components.items():
            components[name] = self._components[component.name]
        for wire, first, last in ends:
            problems += self._misfits(resolved.structure, wire, first, last, _place(resolved, wire))
        raise_if_any(problems)
        return tuple(
            Connection(f"{names[wire.source]}.{first[1]}", f"{names[wire.target]}.{last[1]}")
            for wire, first, last in ends
        )

    def _agree(self, ends: list[tuple[Wire, tuple[str, str], tuple[str, str]]]) -> None:
        """Give ports without a unit that of what they are connected to, and items the numbers they are where needed."""
        for _ in range(len(ends) + 1):
            before = dict(self._components)
            for _, start, end in ends:
                source, target = self._type(start), self._type(end)
                if not same_signal(source, target):
                    continue
                if source.kind is target.kind is Kind.REAL:
                    if not target.unit.dimension and not self._unit(end):
                        self._retype(end, source)
                    elif not source.unit.dimension and not self._unit(start):
                        self._retype(start, target)
                elif {source.kind, target.kind} <= {Kind.ENUMERATION, Kind.INTEGER}:
                    self._retype(start, Type(Kind.INTEGER))
                    self._retype(end, Type(Kind.INTEGER))
            if before == self._components:
                return

    def _type(self, end: tuple[str, str]) -> Type:
        port = self._components[end[0]].interface.port(end[1])
        return port.type if port else Type(Kind.TEXT)

    def _unit(self, end: tuple[str, str]) -> str:
        label = self._components[end[0]].variable(end[1])
        variables = self._models[end[0]].variables
        variable = variables.get(label) or variables[label.rpartition("[")[0]]
        return variable.unit

    def _retype(self, end: tuple[str, str], type_: Type) -> None:
        component = self._components[end[0]]
        ports = tuple(Port(p.name, p.causality, type_) if p.name == end[1] else p for p in component.interface.ports)
        self._components[end[0]] = replace(component, interface=replace(component.interface, ports=ports))

    def _misfits(
        self,
        structure: SystemStructure,
        wire: Wire,
        start: tuple[str, str],
        end: tuple[str, str],
        where: Location | None,
    ) -> Iterator[Problem]:
        source, target = self._type(start), self._type(end)
        difference = same_signal(source, target)
        if difference:
            yield Problem(f"{_text(wire)}: {difference}", where, "a workspace connects what is of one type and unit")
            return
        try:
            bound = [
                bind(self._components[name], port, type_, self._models[name], ("input", "output"))
                for (name, port), type_ in ((start, source), (end, target))
            ]
        except DseError as error:
            yield from (Problem(f"{_text(wire)}: {p.what}", where, p.hint) for p in error.problems)
            return
        if not carries_the_same(wire, structure, bound[0].conversion, bound[1].conversion):
            what = f"{_text(wire)}: its transformation is nothing a workspace has words for"
            yield Problem(what, where, "let a component do it, or simulate the package as it is: dse simulate FILE.ssp")


def _single(structure: SystemStructure) -> Iterator[Wire]:
    """The wires with those of whole arrays as one for each value."""
    for wire in structure.wires:
        source = structure.element(wire.source).model.variables.get(wire.source_variable)
        target = structure.element(wire.target).model.variables.get(wire.target_variable)
        if source is not None and target is not None and source.shape:
            for start, end in zip(source.labels, target.labels, strict=True):
                yield replace(wire, source_variable=start, target_variable=end)
        else:
            yield wire


def _place(resolved: ResolvedSystem, wire: Wire) -> Location | None:
    """Where in the package *wire*, or the whole array it is one value of, is connected."""
    name = f"{wire.target}.{wire.target_variable}"
    return resolved.places.get(name) or resolved.places.get(name.rpartition("[")[0])


def _text(wire: Wire) -> str:
    return f"{wire.source}.{wire.source_variable} -> {wire.target}.{wire.target_variable}"
