"""What of a package's system is recorded: the outputs of its FMUs, and those of the system itself."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence, Set as AbstractSet
from dataclasses import dataclass

from dse.domain.fmu import Variable
from dse.errors import DseError, Location, Problem, closest, fail
from dse.interchange.resolving.carry import SAME, Carry
from dse.interchange.resolving.conversion import Form
from dse.interchange.resolving.network import Endpoint, HopNetwork, Way
from dse.interchange.resolving.routes import carried, forms_along, label_of, routes_to
from dse.interchange.resolving.values import named


@dataclass(frozen=True, slots=True)
class RecordedSignal:
    """One waveform: what it is called, and the value behind it.

    *label* is the ``element.variable`` that is recorded, *way* and *variable* name its FMU's instance and variable.
    *carry* makes the signal of what was recorded. *unit* is as the package spells it. Of what *is_counted* ticks or
    bytes are recorded.
    """

    name: str
    label: str
    way: Way
    variable: str
    unit: str = ""
    carry: Carry = SAME
    is_counted: bool = False


Passed = AbstractSet[tuple[Way, str]]
"""Instances' variables that others take values from."""


def signals_of(
    network: HopNetwork, passed: Passed, record: Sequence[str], problems: list[Problem]
) -> tuple[RecordedSignal, ...]:
    """The system's own outputs and the output connectors of its components; with *record*, what that names instead.

    A clock is recorded as the number of its ticks so far, a string or binary that belongs to clocks and is *passed* on
    as the number of its bytes so far.
    """
    if record:
        found = [signal for name in record for signal in _asked(network, passed, name, problems)]
    else:
        found = [*_outer(network, problems), *_inner(network, passed)]
    unique: dict[str, RecordedSignal] = {}
    for signal in found:
        unique.setdefault(signal.name, signal)
    return tuple(unique.values())


def _inner(network: HopNetwork, passed: Passed) -> Iterator[RecordedSignal]:
    pointers = {way: model.pointers for way, model in network.models.items()}
    for node, connector in network.connectors.items():
        variable = network.variable(node)
        if variable is None or variable.name in pointers[node.way]:
            continue
        is_output = (connector.gives and connector.kind != "constant") or variable.is_timed
        if is_output and _is_recorded(network, passed, node.way, variable):
            yield from _of_variable(network, node, variable, variable.labels)


def _is_recorded(network: HopNetwork, passed: Passed, way: Way, variable: Variable) -> bool:
    """Whether *variable* has numbers, or is counted; other strings and binaries cannot be recorded."""
    if variable.kind is not None:
        return True
    is_text = variable.is_clocked and variable.size == 1 and (way, variable.name) in passed
    return network.models[way].ticks and (variable.timing is not None or is_text)


def _of_variable(
    network: HopNetwork, node: Endpoint, variable: Variable, labels: Iterable[str]
) -> Iterator[RecordedSignal]:
    """The signals of these values of *variable*."""
    form = network.form(Endpoint(node.way, variable.name))
    for label in labels:
        name = f"{'.'.join(node.way)}.{label}"
        yield RecordedSignal(name, name, node.way, variable.name, _unit(form), is_counted=variable.kind is None)


def _unit(form: Form | None) -> str:
    return form.unit.name if form and form.unit else ""


def _outer(network: HopNetwork, problems: list[Problem]) -> Iterator[RecordedSignal]:
    """The outputs of the whole system."""
    for connector in network.systems[()].connectors:
        if not connector.gives:
            continue
        for route in routes_to(network, Endpoint((), connector.name), problems):
            variable = network.variable(route.source)
            if variable is None or variable.kind is None:
                continue
            try:
                way = carried(network, route)
                form = forms_along(network, route)[-1]
                last = route.hops[-1].connection
                label = label_of(variable, route.source_indices, last.where)
                labels = (label,) if route.source_indices else variable.labels
                if route.target_indices and len(labels) > 1:
                    raise fail(f"{last}: all of {route.source} is connected to one value of an array", last.where)
            except DseError as error:
                problems += error.problems
                continue
            for one in labels:
                suffix = one.removeprefix(variable.name) if len(labels) > 1 else ""
                if route.target_indices:
                    suffix = f"[{','.join(map(str, route.target_indices))}]"
                source = f"{'.'.join(route.source.way)}.{one}"
                yield RecordedSignal(connector.name + suffix, source, route.source.way, variable.name, _unit(form), way)


def _asked(network: HopNetwork, passed: Passed, name: str, problems: list[Problem]) -> Iterator[RecordedSignal]:
    outer = {signal.name: signal for signal in _outer(network, [])}
    if name in outer:
        yield outer[name]
        return
    models = network.models
    nodes = [node for node in named(network, name) if node.way in models]
    variables = [(node, models[node.way].variable_of(node.connector)) for node in nodes]
    numbers = [(node, variable) for node, variable in variables if _is_recorded(network, passed, node.way, variable)]
    for node, variable in numbers:
        labels = variable.labels if variable.name == node.connector else (node.connector,)
        yield from _of_variable(network, node, variable, labels)
    if not numbers:
        known = [f"{'.'.join(w)}.{v.name}" for w, m in models.items() for v in m.variables.values() if v.kind]
        hint = closest(name, [*outer, *known])
        problems.append(Problem(f"there is no '{name}' to record", Location("--record"), hint))
