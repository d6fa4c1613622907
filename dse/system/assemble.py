"""A configuration's parts, their wiring and their FMUs → a system that can be simulated."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

from dse.domain.component import (
    Causality,
    Component,
    Kind,
    Parameter,
    Type,
    Value,
    as_number,
    same_signal,
)
from dse.domain.design import Connection
from dse.domain.fmu import FmuModel, Variable
from dse.domain.system import Conversion, Element, SystemStructure, Wire
from dse.errors import DseError, Location, Problem, raise_if_any
from dse.system.binding import IDENTITY, Binding, bind
from dse.system.order import along_the_flow
from dse.system.ports import find_port
from dse.system.shapes import resized


def assemble(
    name: str,
    parts: Mapping[str, Component],
    connections: Iterable[Connection],
    models: Mapping[str, FmuModel],
    values: Mapping[str, Value],
    outputs: Collection[str],
    where: Location | None = None,
) -> SystemStructure:
    """Connect the FMUs of *parts*; *where* is the bench they stand on.

    *connections* join single ports (``sensor.target.gap -> controller.target.gap``). *models* holds the FMU of
    each component by its name. *values* gives parameters and unconnected inputs as ``part.port``; *outputs*
    names the output ports that shall be readable besides those that are wired. Raises DseError with every
    mismatch of unit, type, causality or FMU.
    """
    problems: list[Problem] = []
    joined = check_wiring(parts, connections, values, problems, where)
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
    return SystemStructure(name, tuple(elements[part] for part in along_the_flow(tuple(parts), wires)), tuple(wires))


def check_wiring(
    parts: Mapping[str, Component],
    connections: Iterable[Connection],
    values: Mapping[str, Value],
    problems: list[Problem],
    where: Location | None = None,
) -> list[Connection]:
    """Check every connection and that every input has exactly one source or a value; needs no FMU.

    *where* is the bench, which may give values.
    """
    joined: list[Connection] = []
    sources: dict[str, Connection] = {}
    refused: set[str] = set()
    for connection in connections:
        try:
            _check(connection, parts)
        except DseError as error:
            problems += error.problems
            refused.add(connection.target)
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
        ends = [f"{part}.{p.name}" for p in component.interface.ports if p.causality is Causality.INPUT]
        # An input whose connection is refused is told of already.
        loose = [end for end in ends if end not in sources and end not in values and end not in refused]
        if loose:
            problems.append(_loose(part, component, loose, where))
    for end in values:
        if end in sources:
            problems.append(
                Problem(
                    f"{end} is given a value and connected to {sources[end].source}", sources[end].where, "remove one"
                )
            )
    return joined


def check_fmu(component: Component, model: FmuModel) -> None:
    """Raise DseError unless *model* has all ports and parameters of *component*, of their types and units."""
    problems: list[Problem] = []
    _element(component.name, component, model, (), (), {}, problems)
    raise_if_any(problems)


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


def _loose(part: str, component: Component, ends: list[str], where: Location | None) -> Problem:
    hint = f"add a connection '… -> {ends[0]}' or a value under 'parameters' in the test bench"
    if len(ends) == 1:
        what = f"input {ends[0]} ({component.name}) is neither connected nor given a value"
    else:
        names = ", ".join(end.removeprefix(f"{part}.") for end in ends)
        what = f"{len(ends)} inputs of {part} ({component.name}) are neither connected nor given a value: {names}"
        hint = f"for each, {hint}"
    return Problem(what, where or component.where, hint)


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
    try:
        model = resized(model, _sizes(part, component, model, values))
    except DseError as error:
        problems += error.problems
    connected = {connection.target for connection in joined}
    element = _Parts(component, model, problems)
    for port in component.interface.ports:
        end = f"{part}.{port.name}"
        bound = element.bind(port.name, port.type, str(port.causality))
        if bound is None:
            continue
        if port.causality is Causality.OUTPUT:
            if end in wanted:
                element.outputs[bound.variable.name] = bound.variable
        elif end in connected:
            element.inputs[bound.variable.name] = bound.variable
        elif end in values:
            element.give(bound, port.type, values[end])
    for parameter in component.parameters:
        given = values.get(f"{part}.{parameter.name}", parameter.start)
        if _is_built_in(component, parameter, model):
            if given != parameter.start:
                what = (
                    f"'{parameter.name}' of {component.name} is {parameter.start} by the way it is built, not {given}"
                )
                problems.append(Problem(what, parameter.where or component.where, "change it in the component's file"))
            continue
        bound = element.bind(parameter.name, parameter.type, "parameter", "structuralParameter", "input")
        if bound is not None:
            element.give(bound, parameter.type, given)
    inputs, outputs = tuple(element.inputs.values()), tuple(element.outputs.values())
    return Element(part, model, inputs, outputs, element.start, element.texts, element.conversions)


class _Parts:
    """What an element is made of, gathered port by port and parameter by parameter."""

    def __init__(self, component: Component, model: FmuModel, problems: list[Problem]) -> None:
        self._component, self._model, self._problems = component, model, problems
        self.inputs: dict[str, Variable] = {}
        self.outputs: dict[str, Variable] = {}
        self.start: dict[str, float] = {}
        self.texts: dict[str, str | bytes] = {}
        self.conversions: dict[str, Conversion] = {}

    def bind(self, name: str, type_: Type, *causalities: str) -> Binding | None:
        """The value behind *name*, its conversion noted; None if there is a problem with it."""
        try:
            bound = bind(self._component, name, type_, self._model, causalities)
        except DseError as error:
            self._problems += error.problems
            return None
        if bound.conversion != IDENTITY:
            known = self.conversions.setdefault(bound.variable.name, bound.conversion)
            if known != bound.conversion:
                what = (
                    f"the values of '{bound.variable.name}' in the FMU of {self._component.name} have different items"
                )
                self._problems.append(Problem(what, self._component.where, "give their ports the same type"))
        return bound

    def give(self, bound: Binding, type_: Type, value: Value) -> None:
        """Note the start *value*."""
        if type_.kind is Kind.TEXT:
            self.texts[bound.label] = str(value)
            return
        number = as_number(value, type_)
        items = bound.variable.items
        is_own = str(value) in bound.variable.start  # what the FMU begins with by itself is its own affair
        if type_.kind is Kind.INTEGER and items and number not in items.values() and not is_own:
            what = f"'{bound.label}' in the FMU of {self._component.name} cannot be {value}: it is an enumeration"
            known = ", ".join(f"{item_number} ({item})" for item, item_number in items.items())
            self._problems.append(Problem(what, self._component.where, f"its items: {known}"))
        self.start[bound.label] = number


def _sizes(part: str, component: Component, model: FmuModel, values: Mapping[str, Value]) -> dict[str, float]:
    """The values of structural parameters that size arrays, by variable."""
    found = {}
    for parameter in component.parameters:
        variable = model.variables.get(component.variable(parameter.name))
        if variable is not None and variable.is_structural and parameter.type.kind is Kind.INTEGER:
            found[variable.name] = float(values.get(f"{part}.{parameter.name}", parameter.start))
    return found


def _is_built_in(component: Component, parameter: Parameter, model: FmuModel) -> bool:
    """Whether the parameter's value went into the FMU when it was built, as that of a structural one does."""
    variable = model.variables.get(component.variable(parameter.name))
    is_built = component.source is not None and not component.source.is_finished
    return is_built and not parameter.tunable and variable is not None and variable.causality == "local"
