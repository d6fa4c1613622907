"""Connections of containers → connections between single ports of components.

A connection end is a port or a group of ports, the second one also a tunable parameter of a component. Inside a
compound an end without a part's name belongs to the compound's own interface; from outside a compound with an
interface shows only that, one without shows its parts. Groups connect port by port, each signal from the side that
gives it, so that one arrow can carry a shaft's torque forth and its speed back. A connection with an end on a part
that is left out vanishes. One that begins at an optional part replaces, where the part is present, one that begins at a
part that is always there; so does one that depends on a choice, where that is made.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from dse.domain.component import NO_INTERFACE, Causality, Component, Interface, Parameter, Port
from dse.domain.design import Alternative, Compound, Connection, DesignSpace, Node, Optional, Part
from dse.domain.labels import is_part, shapes, spelled
from dse.errors import DseError, Problem, closest, fail, raise_if_any, some_of
from dse.space.decisions import Choices

PortOf = tuple[str, str]
"""A port as (path of its place, name)."""


@dataclass(frozen=True, slots=True)
class PlacedPart:
    """What stands at *path*, with the parts inside it; a part that is left out is None. *name* is for messages.

    *optionals*: how many optional containers it is in.
    """

    path: str
    interface: Interface | None
    parts: Mapping[str, PlacedPart | None]
    connections: tuple[Connection, ...] = ()
    is_component: bool = False
    name: str = ""
    parameters: tuple[Parameter, ...] = ()
    optionals: int = 0


def wire(
    space: DesignSpace,
    choices: Choices,
    test_components: Mapping[str, Component] | None = None,
    connections: Iterable[Connection] = (),
) -> tuple[Connection, ...]:
    """All connections of one configuration, each from a component's output to a component's input or parameter.

    With a bench's *test_components* and the bench's *connections* those are resolved too.
    Stable in the order of the files. Raises DseError with every end that cannot be found or has two sources.
    """
    made = [connection for connection in connections if _is_made(connection, "", choices)]
    ways, components = _ways(_with_bench(_chosen(space.root, "", choices), test_components or {}, made))
    return tuple(
        Connection(".".join(source), ".".join(target), connection.where, when=connection.when)
        for source, target, connection in ways
        if target[0] in components
    )


def architecture_outputs(space: DesignSpace, choices: Choices) -> dict[str, str]:
    """The output of a component behind each output of an architecture with an interface, by their dotted paths.

    ``powertrain.co2`` is ``powertrain.engine.co2`` where the chosen powertrain is a compound. Raises DseError like
    `wire`.
    """
    root = _chosen(space.root, "", choices)
    outputs = {
        (place.path, port.name)
        for _, place in _levels(root, 0)
        if place.interface is not None and not place.is_component
        for port in place.interface.ports
        if port.causality is Causality.OUTPUT
    }
    return (
        {".".join(here): ".".join(source) for source, here, _ in _ways(root)[0] if here in outputs} if outputs else {}
    )


_Onward = Mapping[PortOf, Sequence[tuple[PortOf, int, Connection]]]
"""Where each port's signal goes next, with the depth of the connection."""


def _ways(root: PlacedPart) -> tuple[list[tuple[PortOf, PortOf, Connection]], set[str]]:
    """Each output of a component with every port it reaches and the outermost connection on the way there.

    And the paths of all components.
    """
    problems: list[Problem] = []
    drivers: dict[PortOf, tuple[PortOf, int, Connection]] = {}
    ranks: dict[PortOf, tuple[bool, int]] = {}
    onward: dict[PortOf, list[tuple[PortOf, int, Connection]]] = {}
    components: set[str] = set()
    optionals = {place.path: place.optionals for _, place in _levels(root, 0)}
    for depth, place in _levels(root, 0):
        if place.is_component:
            components.add(place.path)
        for connection in place.connections:
            try:
                pairs = port_pairs(connection, place)
            except DseError as error:
                problems += error.problems
                continue
            for source, target in pairs:
                first = drivers.pop(target, None)
                rank = connection.when is not None, optionals[source[0]]
                if first and rank == ranks[target]:
                    problems.append(two_sources(target, first[2], connection))
                if first and rank < ranks[target]:
                    drivers[target] = first
                    continue
                made = connection if connection.when or not rank[1] else replace(connection, when=(source[0], ()))
                drivers[target], ranks[target] = (source, depth, made), rank
    raise_if_any(problems)
    for target, (source, depth, connection) in drivers.items():
        onward.setdefault(source, []).append((target, depth, connection))
    sources = [source for source in onward if source[0] in components]
    return [(source, *end) for source in sources for end in _reached(source, onward, components)], components


def _reached(source: PortOf, onward: _Onward, components: set[str]) -> Iterator[tuple[PortOf, Connection]]:
    reached = list(reversed(onward[source]))
    while reached:
        here, depth, connection = reached.pop()
        yield here, connection
        if here[0] not in components:
            for target, next_depth, following in reversed(onward.get(here, ())):
                outer = (next_depth, following) if next_depth < depth else (depth, connection)
                reached.append((target, *outer))


def _with_bench(
    root: PlacedPart, test_components: Mapping[str, Component], connections: Iterable[Connection]
) -> PlacedPart:
    """The design's root with the test components beside its parts."""
    bench = {
        name: PlacedPart(name, c.interface if c.interface != NO_INTERFACE else None, {}, (), True, name, c.parameters)
        for name, c in test_components.items()
    }
    return PlacedPart("", None, {**root.parts, **bench}, (*root.connections, *connections))


def port_pairs(connection: Connection, scope: PlacedPart) -> list[tuple[PortOf, PortOf]]:
    """The connection port by port as (giving, receiving), empty if an end is left out. Raises DseError."""
    source, target = _end(connection, connection.source, scope), _end(connection, connection.target, scope)
    if source is None or target is None:
        return []
    _check_shapes(connection, source, target)
    forth: list[tuple[PortOf, PortOf]] = []
    back: list[tuple[PortOf, PortOf]] = []
    bare: list[str] = []
    for name, port in target.ports.items():
        other = source.ports.get(name)
        if target.gives(port):
            if other and not source.gives(other):
                back.append((target.of(port), source.of(other)))
        elif other and source.gives(other):
            forth.append((source.of(other), target.of(port)))
        else:
            bare.append(connection.target + name)
    bare += [
        connection.source + name
        for name, port in source.ports.items()
        if not source.gives(port) and name not in target.ports
    ]
    if not forth:
        where = connection.place(connection.source)
        raise fail(f"{connection}: no signal goes this way", where, _backwards(source, target))
    if bare:
        raise fail(
            f"{connection}: nothing is given to {some_of(bare)}",
            connection.place(connection.target),
            f"{connection.source} has {_names(source)}, {connection.target} has {_names(target)}",
        )
    return forth + back


def _check_shapes(connection: Connection, source: _End, target: _End) -> None:
    """Raise DseError if an array is connected to one of another shape, or to a single value."""
    if source.ports.keys() == target.ports.keys():
        return
    given, taken = shapes(source.ports), shapes(target.ports)
    for name, shape in given.items():
        if shape != taken.get(name, shape):
            what = f"{connection}: shapes differ: {connection.source}{name.replace('[]', '')} is {spelled(shape)}"
            what = f"{what}, {connection.target}{name.replace('[]', '')} is {spelled(taken[name])}"
            hint = "arrays of equal shape can be connected, and single values: sensor.ranges[2] -> controller.gap"
            raise fail(what, connection.place(connection.target), hint)


def two_sources(target: PortOf, first: Connection, second: Connection) -> Problem:
    """The problem that both connections lead to *target*."""
    at = f" at {first.where}" if first.where else ""
    return Problem(f"{second}: {'.'.join(target)} has a source already", second.where, f"the other is {first}{at}")


@dataclass(frozen=True, slots=True)
class _End:
    place: PlacedPart
    ports: Mapping[str, Port]
    inside: bool

    def gives(self, port: Port) -> bool:
        # Inside a compound its own inputs are what can be read.
        return (port.causality is Causality.OUTPUT) is not self.inside

    def of(self, port: Port) -> PortOf:
        return self.place.path, port.name


def _chosen(node: Node, path: str, choices: Choices) -> PlacedPart:
    place = _place(node, path, choices)
    assert place is not None  # noqa: S101  # the root is a compound, never optional
    return place


def _place(node: Node, path: str, choices: Choices, optionals: int = 0) -> PlacedPart | None:
    match node:
        case Part():
            return PlacedPart(path, node.interface, {}, (), True, node.name, node.component.parameters, optionals)
        case Compound():
            parts = {
                name: _place(child, f"{path}.{name}" if path else name, choices, optionals)
                for name, child in node.parts.items()
            }
            here = f"{path}." if path else ""
            made = tuple(one for one in node.connections if _is_made(one, here, choices))
            return PlacedPart(path, node.interface, parts, made, optionals=optionals)
        case Alternative():
            option = next(option for option in node.options if option.name == choices[path])
            return _place(option, path, choices, optionals)
        case Optional():
            return _place(node.content, path, choices, optionals + 1) if path in choices else None


def _is_made(connection: Connection, here: str, choices: Choices) -> bool:
    """Whether what *connection* depends on is chosen; *here* is where its paths begin."""
    if connection.when is None:
        return True
    path, names = connection.when
    chosen = choices.get(here + path)
    return chosen is not None and (not names or chosen in names)


def _levels(place: PlacedPart, depth: int) -> Iterable[tuple[int, PlacedPart]]:
    yield depth, place
    for part in place.parts.values():
        if part:
            yield from _levels(part, depth + 1)


def _end(connection: Connection, text: str, scope: PlacedPart) -> _End | None:
    steps = text.split(".")
    place: PlacedPart | None = scope
    taken = 0
    if steps[0] in scope.parts:
        place, taken = scope.parts[steps[0]], 1
        while place is not None and place.interface is None:
            if place.is_component:
                where = connection.place(text)
                what = f"{connection}: '{place.name}' has no interface, so nothing can be connected to it"
                raise fail(what, where, f"add implements: … to the component '{place.name}'")
            if taken == len(steps) or steps[taken] not in place.parts:
                missing = steps[taken] if taken < len(steps) else ""
                raise fail(
                    f"{connection}: '{'.'.join(steps[:taken])}' has no part '{missing}'",
                    connection.place(text, taken),
                    closest(missing, place.parts),
                )
            place, taken = place.parts[steps[taken]], taken + 1
    elif scope.interface is None:
        where = connection.place(text)
        raise fail(f"{connection}: unknown part '{steps[0]}'", where, closest(steps[0], scope.parts))
    if place is None or place.interface is None:
        return None
    name = ".".join(steps[taken:])
    found = place.interface.group(name) if name else ()
    parameters = [] if found or not name else [p for p in place.parameters if is_part(p.name, name)]
    if parameters and text is connection.target:
        found = _tuned(connection, place, parameters)
    if not found:
        owner = ".".join(steps[:taken]) or "this compound"
        known = {".".join(port.name.split(".")[: i + 1]) for port in place.interface.ports for i in range(9)}
        what = f"has no port '{name}'" if name else "is without a port"
        if taken == 0:
            known |= set(scope.parts)
        shown = f"{connection}: {owner} ({place.interface.name}) {what}"
        hint = "it is a parameter: connections can end there, not begin" if parameters else closest(name, known)
        raise fail(shown, connection.place(text, taken if name else 0), hint)
    return _End(place, {port.name[len(name) :]: port for port in found}, place is scope)


def _tuned(connection: Connection, place: PlacedPart, parameters: Iterable[Parameter]) -> tuple[Port, ...]:
    """The *parameters* of a component as what a connection ends at. Raises DseError unless a run may change them."""
    where = connection.place(connection.target)
    for parameter in parameters:
        if not parameter.tunable:
            what = f"{connection}: the parameter '{parameter.name}' of {place.name} is not tunable"
            hint = "a connection can end at what the component reads in its steps; give this one a value"
            raise fail(what, where, hint)
        if not parameter.type.kind.is_number:
            what = f"{connection}: the parameter '{parameter.name}' of {place.name} is a text, the same for all runs"
            raise fail(what, where, "give it a value")
    return tuple(Port(parameter.name, Causality.INPUT, parameter.type) for parameter in parameters)


def _backwards(source: _End, target: _End) -> str:
    if any(target.gives(port) for port in target.ports.values()) and not any(map(source.gives, source.ports.values())):
        return "turn the arrow around"
    return f"one side has {_names(source)}, the other {_names(target)}"


def _names(end: _End) -> str:
    return some_of([f"{name.removeprefix('.') or port.name} ({port.causality})" for name, port in end.ports.items()])
