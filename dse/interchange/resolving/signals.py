"""What of a package's system is recorded: the outputs of its FMUs, and those of the system itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from dse.domain.component import Kind
from dse.domain.fmu import Variable
from dse.errors import DseError, Location, Problem, closest
from dse.interchange.resolving.conversion import SAME, Carry
from dse.interchange.resolving.network import Node, Way
from dse.interchange.resolving.routes import Surroundings, carried, forms_along, label_of, routes_to
from dse.interchange.resolving.values import named


@dataclass(frozen=True, slots=True)
class Signal:
    """One waveform: what it is called, and the value behind it.

    *label* is the ``element.variable`` that is recorded, *way* and *variable* name its FMU's instance and variable.
    *carry* makes the signal of what was recorded. *unit* is as the package spells it; *items* are those of an
    enumeration.
    """

    name: str
    label: str
    way: Way
    variable: str
    kind: str
    unit: str = ""
    carry: Carry = SAME


def signals_of(surroundings: Surroundings, record: Sequence[str], problems: list[Problem]) -> tuple[Signal, ...]:
    """The system's own outputs and the output connectors of its components; with *record*, what that names instead."""
    if record:
        found = [signal for name in record for signal in _asked(surroundings, name, problems)]
    else:
        found = [*_outer(surroundings, problems), *_inner(surroundings)]
    unique: dict[str, Signal] = {}
    for signal in found:
        unique.setdefault(signal.name, signal)
    return tuple(unique.values())


def _inner(surroundings: Surroundings) -> Iterator[Signal]:
    for node, connector in surroundings.network.connectors.items():
        variable = surroundings.variable(node)
        if variable is not None and connector.kind in ("output", "calculatedParameter", "local"):
            yield from _of_variable(surroundings, node.way, variable)


def _of_variable(surroundings: Surroundings, way: Way, variable: Variable, only: str | None = None) -> Iterator[Signal]:
    """One signal for each number in *variable*; strings, binaries and clocks cannot be recorded."""
    if variable.kind is None:
        return
    form = surroundings.form(Node(way, variable.name))
    unit = form.unit.name if form and form.unit else ""
    for label in variable.labels if only is None else (only,):
        name = f"{'.'.join(way)}.{label}"
        yield Signal(name, name, way, variable.name, str(variable.kind), unit)


def _outer(surroundings: Surroundings, problems: list[Problem]) -> Iterator[Signal]:
    """The outputs of the whole system."""
    top = surroundings.network.systems[()]
    for connector in top.connectors:
        if connector.kind not in ("output", "calculatedParameter", "local", "constant"):
            continue
        for route in routes_to(surroundings, Node((), connector.name), problems):
            variable = surroundings.variable(route.source)
            if variable is None or variable.kind is None:
                continue
            try:
                way = carried(surroundings, route)
                form = forms_along(surroundings, route)[-1]
                last = route.hops[-1].connection
                label = label_of(variable, route.source_indices, last.where)
            except DseError as error:
                problems += error.problems
                continue
            labels = variable.labels if not route.source_indices else (label,)
            suffixes = (
                [f"[{','.join(map(str, route.target_indices))}]"]
                if route.target_indices
                else [one.removeprefix(variable.name) if len(labels) > 1 else "" for one in labels]
            )
            unit = form.unit.name if form and form.unit else ""
            kind = form.kind if form else str(variable.kind)
            for one, suffix in zip(labels, suffixes, strict=True):
                source = f"{'.'.join(route.source.way)}.{one}"
                yield Signal(connector.name + suffix, source, route.source.way, variable.name, str(kind), unit, way)


def _asked(surroundings: Surroundings, name: str, problems: list[Problem]) -> Iterator[Signal]:
    known = {signal.name: signal for signal in _outer(surroundings, [])}
    if name in known:
        yield known[name]
        return
    top = surroundings.network.systems[()]
    found = False
    for node in named(top, (), name, surroundings.models):
        model = surroundings.models.get(node.way)
        variable = model.variables.get(node.connector) if model else None
        array = model.variables.get(node.connector.rpartition("[")[0]) if model else None
        chosen, only = (variable, None) if variable else (array, node.connector)
        if chosen is not None and chosen.kind in (Kind.REAL, Kind.INTEGER, Kind.BOOLEAN, Kind.ENUMERATION):
            found = True
            yield from _of_variable(surroundings, node.way, chosen, only)
    if not found:
        known_names = [*known]
        for way, model in surroundings.models.items():
            known_names += [f"{'.'.join(way)}.{v.name}" for v in model.variables.values() if v.kind is not None]
        problems.append(Problem(f"there is no '{name}' to record", Location("--record"), closest(name, known_names)))
