"""Why clocks of a system, or wires between them, cannot be simulated."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from dse.cosim.wiring.links import clock_wires
from dse.domain.fmu import FmiInterface, Special
from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import Problem


def clock_problems(system: SystemStructure) -> Iterable[Problem]:
    """Why clocks of *system*, or wires between them, cannot be simulated."""
    for element in system.elements:
        for variable in element.model.variables.values():
            if variable.is_timed and not variable.alias_of and (why := _cannot_tick(element)):
                yield Problem(f"{element.name}.{variable.name}: it is a clock that ticks by itself, {why}")
    for wire in clock_wires(system):
        yield from _wrong_ends(system, wire)


def _cannot_tick(element: Element) -> str:
    if element.model.ticks:
        return ""
    if element.model.interface is not FmiInterface.CO_SIMULATION:
        return "which is supported for co-simulation only"
    if Special.NO_EVENT_MODE in element.model.special:
        return "and its component has event_mode: off"
    return "but its FMU has no event mode (hasEventMode) to tick in"


def _wrong_ends(system: SystemStructure, wire: Wire) -> Iterator[Problem]:
    source, target = (
        system.element(name).model.variables.get(variable)
        for name, variable in ((wire.source, wire.source_variable), (wire.target, wire.target_variable))
    )
    names = f"{wire.source}.{wire.source_variable}", f"{wire.target}.{wire.target_variable}"
    if source is None or target is None or source.timing is None or target.timing is None:
        yield Problem(f"{names[0]} -> {names[1]}: a clock can be wired to a clock only")
        return
    for name, part in ((names[0], wire.source), (names[1], wire.target)):
        if not system.element(part).model.ticks:
            yield Problem(f"{name}: clocks are supported for co-simulation with event mode only")
    if source.causality != "output" and not source.is_timed:
        yield Problem(f"{names[0]}: a wire starts at a clock that neither is an output nor ticks by itself")
    if target.causality != "input":
        yield Problem(f"{names[1]}: a wire ends at what is not an input")
    elif target.is_timed:
        yield Problem(f"{names[1]}: it ticks by itself ({target.timing.kind}), so no wire can end there")
