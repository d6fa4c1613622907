"""A package's system and its FMUs → a system that can be simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from dse.domain.component import Kind
from dse.domain.fmu import Experiment, FmuModel, Variable
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import DseError, Location, Problem, closest, fail, raise_if_any
from dse.interchange.resolving.conversion import Carry, ConversionError
from dse.interchange.resolving.matching import connector_problems, interface_problems
from dse.interchange.resolving.network import Network, Node, Way, network_of
from dse.interchange.resolving.routes import Route, Surroundings, carried, forms_along, label_of, routes_to
from dse.interchange.resolving.signals import Signal, signals_of
from dse.interchange.resolving.values import TYPED, Assigned, Settled, assignments, named, settle
from dse.interchange.structure import ParameterValue, SspSystem
from dse.system.order import along_the_flow
from dse.system.shapes import resized

Models = Mapping[tuple[Path, str], FmuModel]
"""The FMUs of a package by `Component.key`."""


@dataclass(frozen=True, slots=True)
class ResolvedSystem:
    """A package ready to be simulated.

    Values are in the FMUs' own units; wires convert. *signals* is what is recorded. *experiment* is what the package
    says; *notes* tell what in the package is not used. *places* say where in the package a wire's target
    (``element.variable``) is connected, or a start value is given.
    """

    structure: SystemStructure
    signals: tuple[Signal, ...]
    experiment: Experiment
    notes: tuple[Problem, ...] = ()
    places: Mapping[str, Location] = field(default_factory=dict)

    @property
    def record(self) -> tuple[str, ...]:
        """The outputs to record, as ``element.variable``, each once."""
        return tuple(dict.fromkeys(signal.label for signal in self.signals))


@dataclass(slots=True)
class _Parts:
    """What is known of one element while the system is put together.

    *driven* are start values that come over connections, *wired* the values that arrive all the time, by label.
    """

    model: FmuModel
    inputs: set[str] = field(default_factory=set)
    outputs: set[str] = field(default_factory=set)
    start: dict[str, float] = field(default_factory=dict)
    texts: dict[str, str | bytes] = field(default_factory=dict)
    places: dict[str, Location] = field(default_factory=dict)
    driven: set[str] = field(default_factory=set)
    wired: set[str] = field(default_factory=set)


def system_of(
    ssp: SspSystem,
    models: Models,
    *,
    settings: Mapping[str, str] | None = None,
    record: Sequence[str] = (),
) -> ResolvedSystem:
    """Flatten *ssp*, whose components' FMUs are *models*.

    An element is called by its way (``outer.inner``). *settings* are further values by hierarchical name, as a person
    types them; they count most. *record* names variables to record besides the output connectors, or instead of them if
    it is not empty. Raises DseError with every connection, value and name that does not fit, each where it stands.
    """
    problems: list[Problem] = []
    notes = list(ssp.notes)
    network = network_of(ssp.system)
    by_way = {way: models[component.key] for way, component in network.components.items()}
    problems += interface_problems(network, by_way)
    given = assignments(ssp.system, network, by_way, notes)
    given |= _typed(ssp, by_way, settings or {}, problems)
    by_way = _resized(network, by_way, given, problems)
    surroundings = Surroundings(network, by_way)
    problems += connector_problems(surroundings)
    raise_if_any(problems)
    parts = {way: _Parts(model) for way, model in by_way.items()}
    wires = _connect(surroundings, parts, given, problems)
    _give(surroundings, parts, given, problems)
    signals = signals_of(surroundings, record, problems)
    for signal in signals:
        parts[signal.way].outputs.add(signal.variable)
    names = _names(network, problems)
    raise_if_any(problems)
    elements = {names[way]: _element(names[way], part) for way, part in parts.items()}
    structure = SystemStructure(
        ssp.name, tuple(elements[name] for name in along_the_flow(list(elements), wires)), tuple(wires)
    )
    said = ssp.experiment
    places = {f"{names[way]}.{label}": where for way, part in parts.items() for label, where in part.places.items()}
    unique = tuple(dict.fromkeys(notes))
    return ResolvedSystem(structure, signals, Experiment(said.start, said.stop, said.step), unique, places)


def _names(network: Network, problems: list[Problem]) -> dict[Way, str]:
    names: dict[Way, str] = {}
    for way, component in network.components.items():
        name = ".".join(way)
        if name in names.values():
            what = f"two components are called '{name}'"
            problems.append(Problem(what, component.where, "rename one, or the system it is in"))
        names[way] = name
    return names


def _typed(
    ssp: SspSystem, models: Mapping[Way, FmuModel], settings: Mapping[str, str], problems: list[Problem]
) -> dict[Node, Assigned]:
    given: dict[Node, Assigned] = {}
    for name, text in settings.items():
        here = Location(f"--set {name}={text}")
        nodes = list(named(ssp.system, (), name, models))
        if not nodes:
            known = [c.name for c in ssp.system.connectors]
            known += [f"{'.'.join(way)}.{v}" for way, model in models.items() for v in model.variables]
            problems.append(Problem(f"there is no '{name}' to set", here, closest(name, known)))
        value = ParameterValue(name, TYPED, (text,), here)
        given |= {node: Assigned(value, None, False, here) for node in nodes}
    return given


def _resized(
    network: Network, models: Mapping[Way, FmuModel], given: Mapping[Node, Assigned], problems: list[Problem]
) -> dict[Way, FmuModel]:
    """The FMUs with the sizes their arrays have by the structural parameters that are given."""
    found = dict(models)
    surroundings = Surroundings(network, models)
    for way, model in models.items():
        sizes: dict[str, float] = {}
        for variable in model.variables.values():
            node = Node(way, variable.name)
            if variable.is_structural and node in given:
                for value in _settled(surroundings, node, given[node], None, problems)[:1]:
                    sizes[variable.name] = float(value) if isinstance(value, float) else 0.0
        try:
            found[way] = resized(model, sizes)
        except DseError as error:
            where = network.components[way].where
            problems += [Problem(problem.what, where, problem.hint) for problem in error.problems]
    return found


def _connect(
    surroundings: Surroundings, parts: Mapping[Way, _Parts], given: Mapping[Node, Assigned], problems: list[Problem]
) -> list[Wire]:
    wires = []
    targets = dict.fromkeys(node for node, _ in surroundings.network.hops if node.way in parts and not node.dictionary)
    for target in targets:
        for route in routes_to(surroundings, target, problems):
            try:
                if surroundings.variable(route.source) is None:
                    _give_along(surroundings, parts, given, route, problems)
                else:
                    wires.append(_wire(surroundings, parts, route))
            except DseError as error:
                problems += error.problems
    return wires


def _wire(surroundings: Surroundings, parts: Mapping[Way, _Parts], route: Route) -> Wire:
    source, target = surroundings.variable(route.source), surroundings.variable(route.target)
    assert source is not None  # noqa: S101  # both ends are variables of FMUs, checked before
    assert target is not None  # noqa: S101
    first, last = route.hops[0].connection, route.hops[-1].connection
    source_label = label_of(source, route.source_indices, first.where)
    target_label = label_of(target, route.target_indices, last.where)
    sizes = [
        () if indices else v.shape for v, indices in ((source, route.source_indices), (target, route.target_indices))
    ]
    if sizes[0] != sizes[1]:
        shapes = [" x ".join(map(str, size)) or "one value" for size in sizes]
        raise fail(f"{last}: shapes differ: {shapes[0]} and {shapes[1]}", last.where)
    way = carried(surroundings, route)
    try:
        factor, offset = way.numbers
    except ConversionError as error:
        raise fail(f"{last}: {error}", last.where) from None
    parts[route.source.way].outputs.add(source.name)
    parts[route.target.way].inputs.add(target.name)
    parts[route.target.way].places[target_label] = last.where
    parts[route.target.way].wired |= {target_label} if route.target_indices else set(target.labels)
    return Wire(
        ".".join(route.source.way),
        source_label,
        ".".join(route.target.way),
        target_label,
        factor,
        offset,
        tuple((float(a), float(b)) for a, b in sorted(way.table.items())) if way.table else (),
    )


def _give_along(
    surroundings: Surroundings,
    parts: Mapping[Way, _Parts],
    given: Mapping[Node, Assigned],
    route: Route,
    problems: list[Problem],
) -> None:
    """Give an FMU's variable what is given to a system's connector on the way to it, the outermost first."""
    nodes = [route.source, *(hop.target for hop in route.hops[:-1])]
    for number, node in enumerate(nodes):
        if node in given:
            after = carried(surroundings, route, beginning=number)
            form = forms_along(surroundings, route)[number]
            assigned = given[node]
            try:
                values = settle(assigned, form, after) if form else ()
            except ConversionError as error:
                raise fail(f"{node}: {error}", assigned.where) from None
            variable = surroundings.variable(route.target)
            if variable is not None and variable.is_structural:
                what = f"{route.target}: a structural parameter that is set over a connection is not supported"
                raise fail(what, route.hops[-1].connection.where, f"give {route.target} the value itself")
            if variable is not None:
                labels = [label_of(variable, route.target_indices, assigned.where)] if route.target_indices else None
                part = parts[route.target.way]
                _store(part, variable, labels, values, assigned, problems)
                part.driven |= set(labels or variable.labels)
            return
    # Nothing is given: the FMU's own start stays.


def _give(
    surroundings: Surroundings, parts: Mapping[Way, _Parts], given: Mapping[Node, Assigned], problems: list[Problem]
) -> None:
    """Start values of the FMUs' own variables; a whole array before single values of it.

    What comes over a connection from a system's connector counts more, but for what a person typed.
    """
    wholes = [node for node in given if surroundings.variable(node) is not None]
    singles = [node for node in given if node.way in parts and surroundings.variable(node) is None]
    for node in (*wholes, *singles):
        assigned, part = given[node], parts[node.way]
        name = node.connector if node in wholes else node.connector.rpartition("[")[0]
        variable = part.model.variables[name]
        is_wired = part.wired >= ({*variable.labels} if node in wholes else {node.connector})
        if variable.causality == "independent" or variable.variability == "constant" or is_wired:
            # What arrives over a wire replaces it before it is ever used.
            continue
        if {node.connector, *variable.labels} & part.driven and assigned.value.type != TYPED:
            continue
        values = _settled(surroundings, Node(node.way, name), assigned, None, problems)
        _store(part, variable, None if node in wholes else [node.connector], values, assigned, problems)


def _settled(
    surroundings: Surroundings, node: Node, assigned: Assigned, after: Carry | None, problems: list[Problem]
) -> tuple[Settled, ...]:
    try:
        form = surroundings.form(node)
        return settle(assigned, form, after) if form else ()
    except ConversionError as error:
        problems.append(Problem(f"{node}: {error}", assigned.where))
    except DseError as error:
        problems += error.problems
    return ()


def _store(
    part: _Parts,
    variable: Variable,
    labels: list[str] | None,
    values: Sequence[Settled],
    assigned: Assigned,
    problems: list[Problem],
) -> None:
    names = labels if labels is not None else list(variable.labels)
    if not values:
        return
    if len(values) == 1 < len(names):
        values = [*values] * len(names)
    if len(values) != len(names):
        what = f"'{variable.name}' has {len(names)} values, {len(values)} are given"
        problems.append(Problem(what, assigned.where))
        return
    for name, value in zip(names, values, strict=True):
        if name in part.wired:
            continue
        part.places[name] = assigned.where
        part.start.pop(name, None)
        part.texts.pop(name, None)
        if isinstance(value, float):
            part.start[name] = value
        else:
            part.texts[name] = value


def _element(name: str, part: _Parts) -> Element:
    variables = part.model.variables
    return Element(
        name,
        part.model,
        tuple(v for v in variables.values() if v.name in part.inputs),
        tuple(v for v in variables.values() if v.name in part.outputs),
        dict(sorted(part.start.items())),
        dict(sorted(part.texts.items())),
        {v.name: _negated(v) for v in variables.values() if v.is_negated and _is_used(v, part)},
    )


def _is_used(variable: Variable, part: _Parts) -> bool:
    return variable.name in part.inputs | part.outputs | set(part.start)


def _negated(variable: Variable) -> Conversion:
    """FMI 1.0 calls a variable by a second name that stands for the value with the other sign."""
    if variable.kind is Kind.BOOLEAN:
        return Conversion(items=((0.0, 1.0), (1.0, 0.0)))
    return Conversion(factor=-1.0)
