"""An SSP package as a workspace: its FMUs as components, its system as a design, each variant as a bench."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from dse.domain.bench import Simulation
from dse.domain.component import Causality, Component, Interface, Kind, Type, Value
from dse.domain.design import Alternative, Compound, Connection, DesignSpace, Node, Part
from dse.domain.system import Element
from dse.errors import DseError, Location, Problem, fail, raise_if_any
from dse.formats import shown
from dse.interchange.importing.files import write_new
from dse.interchange.importing.parts import Catalogue, Parts, connect, take_parts
from dse.interchange.names import free_word
from dse.interchange.prepared import read_package, timing_of
from dse.interchange.resolving.carry import Carry
from dse.interchange.resolving.resolve import system_of
from dse.interchange.structure import SspSystem
from dse.interchange.writing.values import starts
from dse.loading import write_bench, write_design, write_fmu_component, write_interfaces
from dse.space import open_space
from dse.system import bind


@dataclass(frozen=True, slots=True)
class ImportedBench:
    """A variant as a bench. *configuration* is the id of what it is about, "" if that is the first there is."""

    variant: str
    name: str
    configuration: str = ""


@dataclass(frozen=True, slots=True)
class ImportedWorkspace:
    """What was written, the benches that can be simulated, and what of the package could not be kept."""

    files: tuple[Path, ...]
    benches: tuple[ImportedBench, ...]
    left_out: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Variant:
    """One variant in the words of a workspace; *told* is what of it could not be kept."""

    ssp: SspSystem
    bench: str
    parts: Mapping[str, Component]
    connections: tuple[Connection, ...]
    parameters: Mapping[str, tuple[Value, Type]]
    simulation: Simulation
    told: tuple[str, ...]

    @property
    def title(self) -> str:
        """What the package calls it, unless the bench is called so."""
        return "" if self.ssp.name == self.bench else self.ssp.name


def import_ssp(
    path: Path, folder: Path, *, stop: float | None = None, step: float | None = None, cache: Path | None = None
) -> ImportedWorkspace:
    """Make the workspace *folder* of the package at *path*; nothing that is there is overwritten.

    Benches simulate to *stop* in steps of *step* (seconds); None for what the package says.

    Raises DseError with what a workspace has no words for (a transformation on a connection, a wire of strings, a start
    value of what is no parameter), each where it stands in the package; nothing is written then.
    """
    first, _ = read_package(path, None, cache)
    catalogue = Catalogue(cache=cache)
    variants: list[_Variant] = []
    problems: list[Problem] = []
    for name in dict.fromkeys((first.variant, *first.variants)):
        try:
            ssp, models = read_package(path, name, cache)
            resolved = system_of(ssp, models)
            timing = timing_of(ssp.experiment, models.values(), stop, step, Location(shown(path)))
            every = ssp.experiment.record_every if (stop, step) == (None, None) else None
            simulation = Simulation(
                timing.stop, timing.step, (), every or timing.step, tolerance=ssp.experiment.tolerance
            )
            taken = [variant.bench for variant in variants]
            variants.append(_variant(ssp, take_parts(ssp, resolved, catalogue), simulation, taken))
        except DseError as error:
            problems += error.problems
    raise_if_any(problems)
    spaces, benches = _designs(variants, catalogue)
    texts: dict[Path, str] = {}
    archives: dict[Path, Path] = {}
    for component in catalogue.components.values():
        own = folder / "components" / component.name
        archives[own / f"{component.name}.fmu"] = catalogue.models[component.name].archive
        texts[own / "component.yaml"] = write_fmu_component(component, f"{component.name}.fmu")
    texts[folder / "components" / "interfaces.yaml"] = write_interfaces(catalogue.interfaces())
    for space in spaces:
        texts[folder / "designs" / f"{space.name}.yaml"] = write_design(space)
    for variant, (_, design) in zip(variants, benches, strict=True):
        metrics = _metrics(variant)
        text = write_bench(variant.bench, variant.title, design, variant.parameters, variant.simulation, metrics)
        texts[folder / "testbenches" / f"{variant.bench}.yaml"] = text
    write_new(texts, archives)
    told = dict.fromkeys((*catalogue.left_out, *(text for variant in variants for text in variant.told)))
    return ImportedWorkspace(tuple(sorted((*texts, *archives))), tuple(bench for bench, _ in benches), tuple(told))


def _variant(ssp: SspSystem, parts: Parts, simulation: Simulation, taken: list[str]) -> _Variant:
    connections = connect(parts)
    parameters = given_values(parts)
    told = [str(note) for note in (*parts.resolved.notes, *parts.resolved.ignored)]
    simulation = replace(simulation, record=_record(parts, told))
    # Variants are told apart by their files, as with 'dse simulate --variant'; the first is the system itself.
    name = ssp.name if ssp.variant == next(iter(ssp.variants)) else ssp.variant
    own = {parts.names[place]: parts.component(place) for place in ssp.places}
    return _Variant(ssp, free_word(name, taken), own, connections, parameters, simulation, tuple(told))


def _record(parts: Parts, told: list[str]) -> tuple[str, ...]:
    record: list[str] = []
    for signal in parts.resolved.signals:
        element = ".".join(signal.way)
        own = parts.own_name(element, signal.label.removeprefix(f"{element}."))
        if own is None or signal.is_counted or parts.component(element).interface.port(own) is None:
            told.append(f"'{signal.name}' is not recorded: it is not an output that a port can be")
            continue
        record.append(f"{parts.names[element]}.{own}")
        if signal.name != signal.label and not signal.carry.is_linear_identity:
            told.append(f"the system's output '{signal.name}' is recorded as {record[-1]}, without its transformation")
    return tuple(dict.fromkeys(record))


def _designs(
    variants: list[_Variant], catalogue: Catalogue
) -> tuple[list[DesignSpace], list[tuple[ImportedBench, str]]]:
    """The designs, and each variant's bench with the design it is about.

    Variants that differ only in what stands at their places, or in values, share a design.
    """
    shared: list[list[_Variant]] = []
    for variant in variants:
        group = next((g for g in shared if _fits(variant, g[0], catalogue)), None)
        if group is None:
            shared.append([variant])
        else:
            group.append(variant)
    spaces: list[DesignSpace] = []
    designs: dict[str, tuple[str, str]] = {}
    for group in shared:
        space = _space(group, catalogue)
        spaces.append(space)
        found = list(open_space(space).configurations())
        for variant in group:
            wanted = {place: component.name for place, component in variant.parts.items()}
            meant = next(c for c in found if {path: part.name for path, part in c.parts.items()} == wanted)
            designs[variant.bench] = space.name, "" if meant is found[0] else meant.id
    benches = [(ImportedBench(v.ssp.variant, v.bench, designs[v.bench][1]), designs[v.bench][0]) for v in variants]
    return spaces, benches


def _fits(variant: _Variant, first: _Variant, catalogue: Catalogue) -> bool:
    """Whether *variant* is *first* with other components at some places; they then implement the same interfaces."""
    if [*variant.parts] != [*first.parts] or set(map(str, variant.connections)) != set(map(str, first.connections)):
        return False
    changed: dict[str, Component] = {}
    for place, component in variant.parts.items():
        own = first.parts[place]
        if component.interface == own.interface:
            continue
        if not _offers(component, own.interface):
            return False
        changed[component.name] = replace(component, interface=own.interface)
    if changed.keys() & {component.name for component in first.parts.values()}:
        return False
    for component in changed.values():
        catalogue.components[component.name] = component
    return True


def _offers(component: Component, interface: Interface) -> bool:
    """Whether *component* has the ports of *interface*, by the same names, and no inputs besides."""
    ports, wanted = set(component.interface.ports), set(interface.ports)
    return wanted <= ports and all(port.causality is Causality.OUTPUT for port in ports - wanted)


def _space(group: list[_Variant], catalogue: Catalogue) -> DesignSpace:
    first = group[0]
    parts: dict[str, Node] = {}
    for place in first.parts:
        options = dict.fromkeys(variant.parts[place].name for variant in group)
        nodes = tuple(Part(catalogue.components[name]) for name in options)
        parts[place] = nodes[0] if len(nodes) == 1 else Alternative(nodes)
    return DesignSpace(first.bench, Compound(first.bench, parts, first.connections), title=first.title)


def _metrics(variant: _Variant) -> dict[str, tuple[str, str]]:
    """Where each recorded real value ends: something to look at and to explore, until a person asks for more."""
    found: dict[str, tuple[str, str]] = {}
    for signal in variant.simulation.record:
        place, _, name = signal.partition(".")
        port = variant.parts[place].interface.port(name)
        if port is not None and port.type.kind is Kind.REAL:
            found[free_word(f"{signal} at the end", found)] = f"final({signal})", port.type.unit.symbol
    return found


# Start values of a package as parameters of a bench.


def given_values(parts: Parts) -> dict[str, tuple[Value, Type]]:
    """What the bench gives, by ``part.port``: values of the package, and inputs that nothing is connected to.

    Raises DseError for every value that is given to what is no parameter and no input.
    """
    found: dict[str, tuple[Value, Type]] = {}
    problems: list[Problem] = []
    for element in sorted(parts.resolved.structure.elements, key=lambda e: parts.names[e.name]):
        component = parts.component(element.name)
        types = {port.name: port.type for port in component.interface.ports}
        types |= {parameter.name: parameter.type for parameter in component.parameters}
        for label, value in {**_loose(element, component), **element.start, **element.texts}.items():
            own = parts.own_name(element.name, label)
            where = parts.resolved.places.get(f"{element.name}.{label}")
            if own is None:
                what = "is given a value, but is neither a parameter nor an input that a workspace can give"
                hint = "leave the value out, or simulate the package as it is: dse simulate FILE.ssp"
                problems.append(Problem(f"{element.name}.{label} {what}", where, hint))
                continue
            try:
                outside = _outside(parts, component, own, types[own], value)
            except DseError as error:
                problems += [Problem(p.what, p.where or where, p.hint) for p in error.problems]
                continue
            parameter = component.parameter(own)
            if parameter is None or parameter.start != outside:
                found[f"{parts.names[element.name]}.{own}"] = outside, types[own]
    raise_if_any(problems)
    return found


def _loose(element: Element, component: Component) -> dict[str, float | str | bytes]:
    """What the FMU starts its inputs with that nothing is connected to."""
    connected = {label for variable in element.inputs for label in variable.labels}
    inputs = [port for port in component.interface.ports if port.causality is Causality.INPUT]
    labels = [label for port in inputs if (label := component.variable(port.name)) not in connected]
    nothing: dict[str, float | str | bytes] = {"String": "", "Binary": b""}
    variables = {label: element.model.variable_of(label) for label in labels}
    return {label: starts(v).get(label, nothing.get(v.fmi_type, 0.0)) for label, v in variables.items()}


def _outside(parts: Parts, component: Component, own: str, type_: Type, value: float | str | bytes) -> Value:
    if isinstance(value, str | bytes):
        return value if isinstance(value, str) else value.hex()
    causes = ("parameter", "structuralParameter", "input")
    conversion = bind(component, own, type_, parts.catalogue.models[component.name], causes).conversion
    # A number that is none of the items is none outside either.
    number = dict(conversion.items).get(value, -1.0) if conversion.items else Carry.outwards(conversion).apply(value)
    match type_.kind:
        case Kind.BOOLEAN:
            return bool(number)
        case Kind.INTEGER:
            return int(number)
        case Kind.ENUMERATION:
            if not (number.is_integer() and 0 <= number < len(type_.items)):
                raise fail(f"{component.name}.{own}: {value:g} is the value of no item")
            return type_.items[int(number)]
    return number
