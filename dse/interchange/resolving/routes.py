"""The way of a value through nested systems: from an FMU, or from a system's connector, to an FMU's variable."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from dse.domain.component import Kind
from dse.domain.fmu import Variable
from dse.errors import Location, Problem, fail
from dse.interchange.resolving.carry import SAME, Carry, ConversionError
from dse.interchange.resolving.conversion import Form, carry
from dse.interchange.resolving.network import Endpoint, Hop, HopNetwork


@dataclass(frozen=True, slots=True)
class Route:
    """The *hops* to one variable of an FMU (*target*), the first of them first.

    *source* is an FMU's variable or a connector of a system at which nothing arrives. The indices pick one value of an
    array, () is all of it.
    """

    source: Endpoint
    source_indices: tuple[int, ...]
    target: Endpoint
    target_indices: tuple[int, ...]
    hops: tuple[Hop, ...]


def routes_to(network: HopNetwork, target: Endpoint, problems: list[Problem]) -> Iterator[Route]:
    """The routes to all values of the FMU's variable at *target* that something arrives at."""
    arriving = network.arrivals.get(target, [])
    if () in arriving and len(arriving) > 1:
        where = network.hops[target, ()].connection.where
        problems.append(Problem(f"{target} is connected as a whole and value by value", where))
        return
    for indices in arriving:
        yield from _trace(network, target, indices, problems)


def _trace(
    network: HopNetwork, target: Endpoint, target_indices: tuple[int, ...], problems: list[Problem]
) -> Iterator[Route]:
    hops: list[Hop] = []
    node, indices = target, target_indices
    visited: set[tuple[Endpoint, tuple[int, ...]]] = set()
    while True:
        if (node, indices) in visited:
            problems.append(Problem(f"{target}: its connections lead in a circle", hops[0].connection.where))
            return
        visited.add((node, indices))
        hop = network.hops.get((node, indices))
        if hop is None and indices:
            hop = network.hops.get((node, ()))
            if hop and hop.source_indices:
                what = f"{hop.connection}: one value of an array is connected to all of {node}"
                problems.append(Problem(what, hop.connection.where))
                return
        elif hop is None and hops:
            # An array that is put together value by value on the way: each takes its own route.
            parts = [indices for indices in network.arrivals.get(node, []) if indices]
            if parts and not target_indices:
                for part in parts:
                    yield from _trace(network, target, part, problems)
                return
        if hop is None:
            break
        hops.append(hop)
        node, indices = hop.source, hop.source_indices or (indices if not hop.target_indices else ())
    if hops:
        yield Route(node, indices, target, target_indices, tuple(reversed(hops)))


def carried(network: HopNetwork, route: Route, *, beginning: int = 0) -> Carry:
    """What becomes of a value on *route* from its hop number *beginning* on. Raises DseError, at a connection."""
    forms = forms_along(network, route)
    total = SAME
    for number, hop in enumerate(route.hops[beginning:], beginning):
        source, target = forms[number], forms[number + 1]
        if source is None or target is None:
            continue
        connection = hop.connection
        try:
            total = total.then(
                carry(
                    source,
                    target,
                    connection.transformation,
                    suppresses_unit_conversion=connection.suppresses_unit_conversion,
                )
            )
        except ConversionError as error:
            where = connection.transformation.where if connection.transformation else None
            raise fail(f"{connection}: {error}", where or connection.where) from None
    return total


def forms_along(network: HopNetwork, route: Route) -> list[Form | None]:
    """The forms at the route's source and behind every hop.

    What a system's connector does not say is what is said at the FMU behind it: for an input further on, for an output
    before it (SSP, type choice).
    """
    nodes = [route.source, *(hop.target for hop in route.hops)]
    forms = [network.form(node) for node in nodes]
    backwards = range(len(nodes) - 2, -1, -1)
    for number in backwards:
        connector = network.connectors.get(nodes[number])
        if network.variable(nodes[number]) is None and (connector is None or connector.gives is False):
            forms[number] = _filled(forms[number], forms[number + 1])
    for number in range(1, len(nodes)):
        if network.variable(nodes[number]) is None:
            forms[number] = _filled(forms[number], forms[number - 1])
    return forms


def _filled(form: Form | None, near: Form | None) -> Form | None:
    if form is None or near is None:
        return near if form is None else form
    if form.kind == near.kind == Kind.REAL and form.unit is None:
        return replace(form, unit=near.unit)
    if form.kind == near.kind == Kind.ENUMERATION and form.items is None:
        return replace(form, items=near.items)
    return form


def label_of(variable: Variable, indices: tuple[int, ...], where: Location | None) -> str:
    """The label of one value of *variable*, or its name for all of it. Raises DseError for indices it has not."""
    if not indices:
        return variable.name
    fits = len(indices) == len(variable.shape) and all(
        1 <= index <= size for index, size in zip(indices, variable.shape, strict=True)
    )
    if not fits:
        shape = " x ".join(map(str, variable.shape)) or "no array"
        raise fail(f"'{variable.name}' ({shape}) has no value {', '.join(map(str, indices))}", where, "counted from 1")
    return f"{variable.name}[{','.join(map(str, indices))}]"
