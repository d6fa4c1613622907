"""The connections of nested systems and signal dictionaries as hops between connectors, each with a direction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from dse.errors import DseError, Problem, closest, fail
from dse.interchange.resolving.conversion import Form, form_of
from dse.interchange.structure import (
    Component,
    Connection,
    Connector,
    DictionaryReference,
    SignalType,
    System,
)

Way = tuple[str, ...]
"""Names of the elements that lead to a place, from the top; () is the top itself."""

_GIVING = ("output", "calculatedParameter", "constant", "local")
_TAKING = ("input", "parameter", "structuralParameter")


@dataclass(frozen=True, slots=True)
class Node:
    """A connector of the element at *way*, or a signal of the dictionary called *dictionary* of the system there."""

    way: Way
    connector: str
    dictionary: str = ""

    def __str__(self) -> str:
        return ".".join(
            (*self.way, self.dictionary, self.connector) if self.dictionary else (*self.way, self.connector)
        )


@dataclass(frozen=True, slots=True)
class Hop:
    """From *source* to *target*; the indices pick one value of an array, () is all of it."""

    source: Node
    target: Node
    connection: Connection
    source_indices: tuple[int, ...]
    target_indices: tuple[int, ...]


@dataclass(slots=True)
class Network:
    """Everything between the FMUs.

    *components* and *systems* are by their way. *hops* are by the connector (and indices) they lead to,
    *arrivals* are those indices by connector. *forms* holds
    what connectors of systems and signals of dictionaries say of their type; *connectors* holds all connectors.
    """

    components: dict[Way, Component] = field(default_factory=dict)
    systems: dict[Way, System] = field(default_factory=dict)
    hops: dict[tuple[Node, tuple[int, ...]], Hop] = field(default_factory=dict)
    arrivals: dict[Node, list[tuple[int, ...]]] = field(default_factory=dict)
    forms: dict[Node, Form] = field(default_factory=dict)
    connectors: dict[Node, Connector] = field(default_factory=dict)


def network_of(system: System) -> Network:
    """The network of *system* and all systems in it. Raises DseError with every connection that cannot be."""
    network = Network()
    problems: list[Problem] = []
    _add(network, system, (), {}, problems)
    if problems:
        raise DseError(*problems)
    return network


Scope = Mapping[str, tuple[Way, Mapping[str, SignalType]]]
"""The signal dictionaries known in a system, by name: where each is defined, and its entries."""


def _add(network: Network, system: System, way: Way, outer: Scope, problems: list[Problem]) -> None:
    network.systems[way] = system
    scope = {**outer, **{name: (way, entries) for name, entries in system.dictionaries.items()}}
    for connector in system.connectors:
        node = Node(way, connector.name)
        network.connectors[node] = connector
        if connector.type is not None:
            network.forms[node] = form_of(connector.type)
    for element in system.elements:
        inner = (*way, element.name)
        if isinstance(element, System):
            _add(network, element, inner, scope, problems)
            continue
        for connector in element.connectors:
            network.connectors[Node(inner, connector.name)] = connector
        if isinstance(element, Component):
            network.components[inner] = element
        elif element.dictionary not in scope:
            what = f"there is no signal dictionary '{element.dictionary}'"
            problems.append(Problem(what, element.where, closest(element.dictionary, scope)))
    for connection in system.connections:
        try:
            hop = _hop(network, system, way, scope, connection)
        except DseError as error:
            problems += error.problems
            continue
        key = (hop.target, hop.target_indices)
        first = network.hops.get(key)
        if first:
            what = f"{connection}: {hop.target} has a source already: {first.source}"
            problems.append(Problem(what, connection.where, f"the other connection is at {first.connection.where}"))
        network.hops[key] = hop
        network.arrivals.setdefault(hop.target, []).append(hop.target_indices)


@dataclass(frozen=True, slots=True)
class _End:
    """One end of a connection, seen from inside the system: it gives values, takes them, or either (None)."""

    node: Node
    gives: bool | None
    indices: tuple[int, ...]


def _hop(network: Network, system: System, way: Way, scope: Scope, connection: Connection) -> Hop:
    start = _end(network, system, way, scope, connection, at_start=True)
    end = _end(network, system, way, scope, connection, at_start=False)
    if start.gives is None and end.gives is None:
        what = f"{connection}: both ends may give and take, so nothing says which way values go"
        raise fail(what, connection.where, "make one of them an input or an output")
    if start.gives is not None and start.gives == end.gives:
        both = "give values" if start.gives else "take values"
        raise fail(f"{connection}: both ends {both}", connection.where, "connect an output to an input")
    source, target = (start, end) if start.gives or end.gives is False else (end, start)
    if _is_late(network, source.node, target.node):
        what = f"{connection}: a calculated parameter that sets a parameter is not supported"
        raise fail(what, connection.where, "give the parameter a value")
    return Hop(source.node, target.node, connection, source.indices, target.indices)


def _end(network: Network, system: System, way: Way, scope: Scope, connection: Connection, *, at_start: bool) -> _End:
    name, connector = (
        (connection.start_element, connection.start_connector)
        if at_start
        else (connection.end_element, connection.end_connector)
    )
    indices = connection.start_indices if at_start else connection.end_indices
    if not name:
        own = next((c for c in system.connectors if c.name == connector), None)
        if own is None:
            hint = closest(connector, [c.name for c in system.connectors])
            raise fail(f"{connection}: system '{system.name}' has no connector '{connector}'", connection.where, hint)
        # From inside, what a system takes is given.
        gives = True if own.kind in _TAKING else False if own.kind in _GIVING else None
        return _End(Node(way, connector), gives, indices)
    element = system.element(name)
    if element is None:
        hint = closest(name, [e.name for e in system.elements])
        raise fail(f"{connection}: there is no element '{name}'", connection.where, hint)
    found = next((c for c in element.connectors if c.name == connector), None)
    if found is None:
        hint = closest(connector, [c.name for c in element.connectors])
        raise fail(f"{connection}: '{name}' has no connector '{connector}'", connection.where, hint)
    gives = True if found.kind in _GIVING else False if found.kind in _TAKING else None
    if isinstance(element, DictionaryReference):
        return _End(_signal(network, element, found, scope), gives, indices)
    if gives is None:
        what = f"{connection}: connectors of the kind inout are for references to signal dictionaries only"
        raise fail(what, connection.where)
    return _End(Node((*way, name), connector), gives, indices)


def _signal(network: Network, reference: DictionaryReference, connector: Connector, scope: Scope) -> Node:
    if reference.dictionary not in scope:
        raise fail(f"there is no signal dictionary '{reference.dictionary}'", reference.where)
    way, entries = scope[reference.dictionary]
    if connector.name not in entries:
        what = f"the signal dictionary '{reference.dictionary}' has no entry '{connector.name}'"
        raise fail(what, connector.where, closest(connector.name, entries))
    node = Node(way, connector.name, reference.dictionary)
    network.forms[node] = form_of(entries[connector.name])
    return node


def _is_late(network: Network, source: Node, target: Node) -> bool:
    """Whether a parameter would be set by what is known only after initialization."""
    given, taken = network.connectors.get(source), network.connectors.get(target)
    if given is None or taken is None or target.way not in network.components:
        return False
    is_known = given.kind in ("parameter", "structuralParameter", "input")
    return taken.kind in ("parameter", "structuralParameter") and not is_known
