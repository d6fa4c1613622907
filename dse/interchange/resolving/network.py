"""The connections of nested systems and signal dictionaries as hops between connectors, each with a direction."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from dse.domain.fmu import FmuModel, Variable
from dse.errors import DseError, Problem, closest, fail, raise_if_any
from dse.interchange.resolving.carry import ConversionError
from dse.interchange.resolving.conversion import Form, form_of, form_of_variable, merged
from dse.interchange.structure import (
    Connector,
    DictionaryReference,
    End,
    SignalType,
    SspComponent,
    SspConnection,
    System,
)

Models = Mapping[tuple[Path, str], FmuModel]
"""The FMUs of a package by `SspComponent.key`."""

Way = tuple[str, ...]
"""Names of the elements that lead to a place, from the top; () is the top itself."""


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A connector of the element at *way*, or a signal of the dictionary called *dictionary* of the system there."""

    way: Way
    connector: str
    dictionary: str = ""

    def __str__(self) -> str:
        return ".".join(name for name in (*self.way, self.dictionary, self.connector) if name)


@dataclass(frozen=True, slots=True)
class Hop:
    """From *source* to *target*; the indices pick one value of an array, () is all of it."""

    source: Endpoint
    target: Endpoint
    connection: SspConnection
    source_indices: tuple[int, ...]
    target_indices: tuple[int, ...]


@dataclass(slots=True)
class HopNetwork:
    """The FMUs of a package and everything between them.

    *components*, their *models*, and *systems* are by their way. *hops* are by the connector (and indices) they lead
    to, *arrivals* are those indices by connector. *forms* holds what connectors of systems and signals of dictionaries
    say of their type; *connectors* holds all connectors.
    """

    components: dict[Way, SspComponent] = field(default_factory=dict)
    models: dict[Way, FmuModel] = field(default_factory=dict)
    systems: dict[Way, System] = field(default_factory=dict)
    hops: dict[tuple[Endpoint, tuple[int, ...]], Hop] = field(default_factory=dict)
    arrivals: dict[Endpoint, list[tuple[int, ...]]] = field(default_factory=dict)
    forms: dict[Endpoint, Form] = field(default_factory=dict)
    connectors: dict[Endpoint, Connector] = field(default_factory=dict)

    def variable(self, node: Endpoint) -> Variable | None:
        """The FMU's variable behind *node*; None if it is a connector of a system."""
        model = self.models.get(node.way) if not node.dictionary else None
        return model.variables.get(node.connector) if model else None

    def form(self, node: Endpoint) -> Form | None:
        """How values are given at *node*, as far as that is said there. Raises DseError for a contradiction."""
        variable = self.variable(node)
        if variable is None:
            return self.forms.get(node)
        connector = self.connectors.get(node)
        said = form_of(connector.type) if connector and connector.type else None
        try:
            return merged(form_of_variable(variable, self.models[node.way]), said)
        except ConversionError as error:
            raise fail(f"{node}: {error}", connector.where if connector else None) from None


def network_of(system: System, models: Models) -> HopNetwork:
    """The network of *system* and all systems in it. Raises DseError with every connection that cannot be."""
    network = HopNetwork()
    problems: list[Problem] = []
    _add(network, system, (), {}, models, problems)
    raise_if_any(problems)
    return network


_Dictionaries = Mapping[str, tuple[Way, Mapping[str, SignalType]]]
"""The signal dictionaries known in a system, by name: where each is defined, and its entries."""


@dataclass(frozen=True, slots=True)
class _Scope:
    """A system where it stands, with the signal dictionaries of its own and of the systems around it."""

    network: HopNetwork
    system: System
    way: Way
    dictionaries: _Dictionaries


def _add(
    network: HopNetwork, system: System, way: Way, outer: _Dictionaries, models: Models, problems: list[Problem]
) -> None:
    own = {name: (way, entries) for name, entries in system.dictionaries.items()}
    scope = _Scope(network, system, way, {**outer, **own})
    network.systems[way] = system
    for connector in system.connectors:
        node = Endpoint(way, connector.name)
        network.connectors[node] = connector
        if connector.type is not None:
            network.forms[node] = form_of(connector.type)
    for element in system.elements:
        inner = (*way, element.name)
        if isinstance(element, System):
            _add(network, element, inner, scope.dictionaries, models, problems)
            continue
        network.connectors |= {Endpoint(inner, connector.name): connector for connector in element.connectors}
        if isinstance(element, SspComponent):
            network.components[inner], network.models[inner] = element, models[element.key]
        elif element.dictionary not in scope.dictionaries:
            what = f"there is no signal dictionary '{element.dictionary}'"
            problems.append(Problem(what, element.where, closest(element.dictionary, scope.dictionaries)))
    for connection in system.connections:
        try:
            hop = _hop(scope, connection)
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


def _hop(scope: _Scope, connection: SspConnection) -> Hop:
    ends = [(*_placed(scope, connection, end), end.indices) for end in (connection.start, connection.end)]
    (_, start_gives, _), (_, end_gives, _) = ends
    if start_gives is None and end_gives is None:
        what = f"{connection}: both ends may give and take, so the direction of values is undefined"
        raise fail(what, connection.where, "make one of them an input or an output")
    # A clock that ticks by itself is an input, and gives its ticks to others all the same (FMI-LS-BUS 1.0, 4.2.4).
    start_ticks, end_ticks = (_is_timed(scope.network, node) for node, _, _ in ends)
    if start_gives == end_gives and (start_gives or start_ticks == end_ticks):
        both = "give values" if start_gives else "take values"
        raise fail(f"{connection}: both ends {both}", connection.where, "connect an output to an input")
    if end_ticks if start_gives == end_gives else not (start_gives or end_gives is False):
        ends.reverse()
    (source, _, source_indices), (target, _, target_indices) = ends
    if _is_late(scope.network, source, target):
        what = f"{connection}: a calculated parameter that sets a parameter is not supported"
        raise fail(what, connection.where, "give the parameter a value")
    return Hop(source, target, connection, source_indices, target_indices)


def _is_timed(network: HopNetwork, node: Endpoint) -> bool:
    variable = network.variable(node)
    return variable is not None and variable.is_timed


def _placed(scope: _Scope, connection: SspConnection, end: End) -> tuple[Endpoint, bool | None]:
    """The connector at *end*, and whether it gives values as seen from inside of the system; None for either."""
    system = scope.system
    if not end.element:
        own = _connector(connection, end, f"system '{system.name}'", system.connectors)
        # From inside, what a system takes is given.
        return Endpoint(scope.way, end.connector), None if own.gives is None else not own.gives
    element = system.element(end.element)
    if element is None:
        hint = closest(end.element, [e.name for e in system.elements])
        raise fail(f"{connection}: there is no element '{end.element}'", connection.where, hint)
    connector = _connector(connection, end, f"'{end.element}'", element.connectors)
    if isinstance(element, DictionaryReference):
        return _signal(scope, element, connector), connector.gives
    if connector.gives is None:
        what = f"{connection}: connectors of the kind inout are for references to signal dictionaries only"
        raise fail(what, connection.where)
    return Endpoint((*scope.way, end.element), end.connector), connector.gives


def _connector(connection: SspConnection, end: End, owner: str, connectors: Iterable[Connector]) -> Connector:
    known = {connector.name: connector for connector in connectors}
    if end.connector not in known:
        what = f"{connection}: {owner} has no connector '{end.connector}'"
        raise fail(what, connection.where, closest(end.connector, known))
    return known[end.connector]


def _signal(scope: _Scope, reference: DictionaryReference, connector: Connector) -> Endpoint:
    if reference.dictionary not in scope.dictionaries:
        raise fail(f"there is no signal dictionary '{reference.dictionary}'", reference.where)
    way, entries = scope.dictionaries[reference.dictionary]
    if connector.name not in entries:
        what = f"the signal dictionary '{reference.dictionary}' has no entry '{connector.name}'"
        raise fail(what, connector.where, closest(connector.name, entries))
    node = Endpoint(way, connector.name, reference.dictionary)
    scope.network.forms[node] = form_of(entries[connector.name])
    return node


def _is_late(network: HopNetwork, source: Endpoint, target: Endpoint) -> bool:
    """Whether a parameter would be set by what is known only after initialization."""
    given, taken = network.connectors.get(source), network.connectors.get(target)
    if given is None or taken is None or target.way not in network.components:
        return False
    return taken.kind in ("parameter", "structuralParameter") and given.gives is not False
