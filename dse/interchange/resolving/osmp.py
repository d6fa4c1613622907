"""Binaries of FMI 2 on the wires of a package, which knows them as three integers (OSMP), or as one connector."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from dse.domain.fmu import Variable
from dse.domain.system import Element, SystemStructure, Wire


def with_binaries(system: SystemStructure) -> SystemStructure:
    """*system* with one wire in place of the three between the integers of two binaries: never are addresses wired."""
    wholes = {
        (element.name, name): (variable, place)
        for element in system.elements
        for variable in element.model.variables.values()
        for place, (name, _) in enumerate(variable.integers)
    }
    found: dict[tuple[str, str, str, str], list[Wire]] = {}
    for wire in system.wires:
        start, end = wholes.get((wire.source, wire.source_variable)), wholes.get((wire.target, wire.target_variable))
        if start and end and start[1] == end[1]:
            found.setdefault((wire.source, start[0].name, wire.target, end[0].name), []).append(wire)
    groups = {Wire(*ends): wires for ends, wires in found.items() if len(wires) == len(("lo", "hi", "size"))}
    parts = {wire for wires in groups.values() for wire in wires}
    return _rewired(system, (*(wire for wire in system.wires if wire not in parts), *groups))


def without_binaries(system: SystemStructure) -> SystemStructure:
    """The contrary: between two FMUs of FMI 2 the wires that any other program understands."""

    def spread(wire: Wire) -> Iterable[Wire]:
        start = system.element(wire.source).model.variables.get(wire.source_variable)
        end = system.element(wire.target).model.variables.get(wire.target_variable)
        if start is None or end is None or not (start.integers and end.integers):
            return (wire,)
        pairs = zip(start.integers, end.integers, strict=True)
        return (replace(wire, source_variable=given, target_variable=taken) for (given, _), (taken, _) in pairs)

    return _rewired(system, tuple(single for wire in system.wires for single in spread(wire)))


def _rewired(system: SystemStructure, wires: tuple[Wire, ...]) -> SystemStructure:
    """*system* with *wires* in place of its own, whose elements give and take what these carry."""
    if wires == system.wires:
        return system
    given = {(wire.source, wire.source_variable) for wire in wires}
    taken = {(wire.target, wire.target_variable) for wire in wires}

    def side(element: Element, variables: Iterable[Variable], is_used: Callable[[str], bool]) -> tuple[Variable, ...]:
        pointers = element.model.pointers
        kept = {v.name for v in variables if not v.integers and v.name not in pointers}
        return tuple(v for v in element.model.variables.values() if v.name in kept or is_used(v.name))

    def used(ends: set[tuple[str, str]], element: Element) -> Callable[[str], bool]:
        special = {v.name for v in element.model.variables.values() if v.integers} | element.model.pointers
        return lambda name: name in special and (element.name, name) in ends

    elements = (
        replace(e, inputs=side(e, e.inputs, used(taken, e)), outputs=side(e, e.outputs, used(given, e)))
        for e in system.elements
    )
    return replace(system, elements=tuple(elements), wires=wires)
