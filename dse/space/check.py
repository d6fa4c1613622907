"""Everything that can be known to be wrong with a design space before a configuration is looked at."""

from __future__ import annotations

from collections.abc import Iterable

from dse.domain.component import Causality, Parameter, Type, same_signal
from dse.domain.design import Alternative, Compound, Connection, DesignSpace, Node, Optional, Part, walk
from dse.errors import DseError, Problem
from dse.loading import Instances, misfits, unknown_choices
from dse.space.configurations.wiring import PlacedPart, PortOf, port_pairs, two_sources
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places


def check_space(space: DesignSpace) -> list[Problem]:
    """What is wrong with the constraints, the alternatives' interfaces and the connections of *space*.

    Constraints that are switched off are looked at, too.
    """
    problems = misfits(space.root)
    if not problems:
        compounds = [(path, node) for path, node in walk(space.root) if isinstance(node, Compound)]
        problems += [problem for path, compound in compounds for problem in _wiring(path, compound)]
    places = Places(space)
    for constraint in space.all_constraints:
        try:
            compile_in(constraint.rule, places)
        except DseError as error:
            problems += error.problems
    return problems


def _place(node: Node, path: str, *, optional: bool) -> tuple[PlacedPart, frozenset[str]]:
    """The place with every part there, alternatives by their interface; and the paths that may be left out."""
    match node:
        case Optional():
            return _place(node.content, path, optional=True)
        case Part() | Alternative():
            name = node.name if isinstance(node, Part) else node.options[0].name
            place = PlacedPart(path, node.interface, {}, (), True, name, _parameters(node))
            return place, frozenset({path} if optional else ())
        case Compound():
            parts: dict[str, PlacedPart | None] = {}
            missing = frozenset({path} if optional else ())
            for name, child in node.parts.items():
                parts[name], below = _place(child, f"{path}.{name}" if path else name, optional=optional)
                missing |= below
            return PlacedPart(path, node.interface, parts, node.connections), missing


def _parameters(node: Part | Alternative) -> tuple[Parameter, ...]:
    """Those that whoever may stand there has, as the first has them."""
    options = (node,) if isinstance(node, Part) else node.options
    all_of_them = [option.component.parameters if isinstance(option, Part) else () for option in options]
    shared = set.intersection(*({parameter.name for parameter in each} for each in all_of_them))
    return tuple(parameter for parameter in all_of_them[0] if parameter.name in shared)


def _wiring(path: str, compound: Compound) -> Iterable[Problem]:
    scope, may_miss = _place(compound, path, optional=False)
    yield from unknown_choices(compound.connections, Instances(compound).choices)
    types = dict(_types(scope))
    driven: set[PortOf] = set()
    always: dict[PortOf, Connection] = {}
    for connection in compound.connections:
        try:
            pairs = port_pairs(connection, scope)
        except DseError as error:
            yield from error.problems
            continue
        for source, target in pairs:
            difference = same_signal(types[source], types[target])
            if difference:
                shown = f"{'.'.join(filter(None, source))} -> {'.'.join(filter(None, target))}: {difference}"
                yield Problem(shown, connection.where, "both ends must carry the same unit and type")
            driven.add(target)
            if connection.when or source[0] in may_miss or target[0] in may_miss:
                continue
            first = always.setdefault(target, connection)
            if first is not connection:
                yield two_sources(target, first, connection)
    for port in compound.interface.ports if compound.interface else ():
        if port.causality is Causality.OUTPUT and (path, port.name) not in driven:
            what = f"nothing inside '{compound.name}' gives its output '{port.name}'"
            yield Problem(what, compound.where, f"add a connection '… -> {port.name}'")


def _types(place: PlacedPart) -> Iterable[tuple[PortOf, Type]]:
    """The type of every port and parameter at and below *place*."""
    yield from (((place.path, port.name), port.type) for port in (place.interface.ports if place.interface else ()))
    yield from (((place.path, parameter.name), parameter.type) for parameter in place.parameters)
    for part in place.parts.values():
        if part:
            yield from _types(part)
