"""A configuration's parts, their wiring and their FMUs → a system that can be simulated."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from dse.domain.component import (
    Causality,
    Component,
    FmuSource,
    Kind,
    ModelicaSource,
    Parameter,
    Type,
    Value,
    as_number,
    same_signal,
)
from dse.domain.design import Connection
from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.system.ports import find_port


def assemble(
    name: str,
    parts: Mapping[str, Component],
    connections: Iterable[Connection],
    models: Mapping[str, FmuModel],
    values: Mapping[str, Value],
    outputs: Collection[str],
) -> SystemStructure:
    """Connect the FMUs of *parts*.

    *connections* join single ports (``sensor.target.gap -> controller.target.gap``). *models* holds the FMU of
    each component by its name. *values* gives parameters and unconnected inputs as ``part.port``; *outputs*
    names the output ports that shall be readable besides those that are wired. Raises DseError with every
    mismatch of unit, type, causality or FMU.
    """
    problems: list[Problem] = []
    joined = check_wiring(parts, connections, values, problems)
    wanted = {connection.source for connection in joined} | set(outputs)
    elements = {
        part: _element(part, component, models[component.name], joined, wanted, values, problems)
        for part, component in parts.items()
        if component.name in models
    }
    raise_if_any(problems)
    wires = []
    for connection in joined:
        source, source_port, _ = find_port(connection.source, parts)
        target, target_port, _ = find_port(connection.target, parts)
        wires.append(Wire(source, parts[source].variable(source_port), target, parts[target].variable(target_port)))
    return SystemStructure(name, tuple(elements[part] for part in _order(parts, wires)), tuple(wires))


def check_wiring(
    parts: Mapping[str, Component],
    connections: Iterable[Connection],
    values: Mapping[str, Value],
    problems: list[Problem],
) -> list[Connection]:
    """Check every connection and that every input has exactly one source or a value; needs no FMU."""
    joined: list[Connection] = []
    sources: dict[str, Connection] = {}
    for connection in connections:
        try:
            _check(connection, parts)
        except DseError as error:
            problems += error.problems
            continue
        first = sources.get(connection.target)
        if first:
            problems.append(
                Problem(
                    f"{connection}: the input has a source already: {first.source}",
                    connection.where,
                    f"the other connection is at {first.where}" if first.where else "",
                )
            )
            continue
        sources[connection.target] = connection
        joined.append(connection)
    for part, component in parts.items():
        for port in component.interface.ports:
            end = f"{part}.{port.name}"
            if port.causality is Causality.INPUT and end not in sources and end not in values:
                problems.append(
                    Problem(
                        f"input {end} ({component.name}) is neither connected nor given a value",
                        component.where,
                        f"add a connection '… -> {end}' or a value under 'parameters' in the test bench",
                    )
                )
    for end in values:
        if end in sources:
            problems.append(
                Problem(
                    f"{end} is given a value and connected to {sources[end].source}", sources[end].where, "remove one"
                )
            )
    return joined


def _check(connection: Connection, parts: Mapping[str, Component]) -> None:
    source_part, _, source = find_port(connection.source, parts, connection)
    target_part, _, target = find_port(connection.target, parts, connection)
    if source.causality is not Causality.OUTPUT:
        raise DseError(
            Problem(
                f"{connection}: {connection.source} is an input",
                connection.where,
                _others(source_part, parts, Causality.OUTPUT),
            )
        )
    if target.causality is not Causality.INPUT:
        raise DseError(
            Problem(
                f"{connection}: {connection.target} is an output",
                connection.where,
                _others(target_part, parts, Causality.INPUT),
            )
        )
    difference = same_signal(source.type, target.type)
    if difference:
        fitting = [
            f"{source_part}.{port.name}"
            for port in parts[source_part].interface.ports
            if port.causality is Causality.OUTPUT and not same_signal(port.type, target.type)
        ]
        hint = f"connect {' or '.join(fitting[:3])}" if fitting else "both ends must carry the same unit and type"
        raise DseError(Problem(f"{connection}: {difference}", connection.where, hint))


def _others(part: str, parts: Mapping[str, Component], causality: Causality) -> str:
    names = [port.name for port in parts[part].interface.ports if port.causality is causality]
    return f"{causality}s of {part}: {', '.join(names)}" if names else f"{part} has no {causality}"


def _element(
    part: str,
    component: Component,
    model: FmuModel,
    joined: Iterable[Connection],
    wanted: Collection[str],
    values: Mapping[str, Value],
    problems: list[Problem],
) -> Element:
    connected = {connection.target for connection in joined}
    inputs, outputs = [], []
    start: dict[str, float] = {}
    for port in component.interface.ports:
        end = f"{part}.{port.name}"
        try:
            variable = _variable(component, port.name, port.type, model, (str(port.causality),))
        except DseError as error:
            problems += error.problems
            continue
        if port.causality is Causality.OUTPUT:
            if end in wanted:
                outputs.append(variable)
        elif end in connected:
            inputs.append(variable)
        elif end in values:
            start[variable.name] = as_number(values[end], port.type)
    for parameter in component.parameters:
        if _is_built_in(component, parameter, model):
            given = values.get(f"{part}.{parameter.name}", parameter.start)
            if given != parameter.start:
                what = (
                    f"'{parameter.name}' of {component.name} is {parameter.start} by the way it is built, not {given}"
                )
                problems.append(Problem(what, parameter.where or component.where, "change it in the component's file"))
            continue
        try:
            causes = ("parameter", "structuralParameter", "input")
            variable = _variable(component, parameter.name, parameter.type, model, causes)
        except DseError as error:
            problems += error.problems
            continue
        start[variable.name] = as_number(values.get(f"{part}.{parameter.name}", parameter.start), parameter.type)
    return Element(part, model, tuple(inputs), tuple(outputs), start)


def _is_built_in(component: Component, parameter: Parameter, model: FmuModel) -> bool:
    """Whether the parameter's value went into the FMU when it was built, as that of a structural one does."""
    variable = model.variables.get(component.variable(parameter.name))
    is_fixed = isinstance(component.source, ModelicaSource) and not parameter.tunable
    return is_fixed and variable is not None and variable.causality == "local"


def _variable(component: Component, name: str, type_: Type, model: FmuModel, causalities: tuple[str, ...]) -> Variable:
    variable = model.variables.get(component.variable(name))
    where = component.where
    if type_.kind is Kind.ENUMERATION and isinstance(component.source, FmuSource):
        what = (
            f"'{name}' of {component.name} is an enumeration: those of finished FMUs are not supported in this version"
        )
        raise DseError(Problem(what, where, "their items may have any number; use a port of type int"))
    if variable is None:
        near = [v.name for v in model.variables.values() if v.causality in causalities]
        hint = f"map it: 'map: {{{name}: …}}'; the FMU has {', '.join(near[:8])}" if near else ""
        raise DseError(
            Problem(f"the FMU of {component.name} has no variable '{component.variable(name)}'", where, hint)
        )
    if variable.causality not in causalities:
        raise DseError(
            Problem(
                f"'{variable.name}' in the FMU of {component.name} is {variable.causality}, not {causalities[0]}", where
            )
        )
    fits = variable.kind is type_.kind or {variable.kind, type_.kind} == {Kind.ENUMERATION, Kind.INTEGER}
    if not fits:
        raise DseError(
            Problem(f"'{variable.name}' in the FMU of {component.name} is {variable.kind}, not {type_}", where)
        )
    if variable.unit and type_.kind is Kind.REAL:
        _check_unit(component, variable, type_, where)
    return variable


def _check_unit(component: Component, variable: Variable, type_: Type, where: Location | None) -> None:
    from dse.units import UnitError, parse_unit

    try:
        unit = parse_unit(variable.unit)
    except UnitError:
        raise DseError(
            Problem(f"'{variable.name}' in the FMU of {component.name} has the unknown unit '{variable.unit}'", where)
        ) from None
    if unit.dimension != type_.unit.dimension or not unit.is_coherent:
        raise DseError(
            Problem(
                f"'{variable.name}' in the FMU of {component.name} is in {variable.unit}, expected {type_}",
                where,
                "FMU variables must be in coherent SI units in this version",
            )
        )


def _order(parts: Mapping[str, Component], wires: Iterable[Wire]) -> list[str]:
    """Parts along the flow of signals, loops cut where the file's order says: few sweeps at initialization."""
    import networkx as nx

    graph = nx.DiGraph()
    graph.add_nodes_from(parts)
    graph.add_edges_from((wire.source, wire.target) for wire in wires)
    rank = {part: number for number, part in enumerate(parts)}
    condensed = nx.condensation(graph)
    members = {node: sorted(data["members"], key=rank.__getitem__) for node, data in condensed.nodes(data=True)}
    order = nx.lexicographical_topological_sort(condensed, key=lambda node: rank[members[node][0]])
    return [part for node in order for part in members[node]]
