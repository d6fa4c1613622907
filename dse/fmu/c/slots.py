"""A component's ports and parameters as the variables of the FMU that is built from it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum

from dse.domain.component import Causality, Component, Kind, Parameter, Port, Type, Value
from dse.errors import Location, Problem, raise_if_any
from dse.units import coherent


class Role(StrEnum):
    """FMI's word for what a variable is to the component."""

    INPUT = "input"
    OUTPUT = "output"
    PARAMETER = "parameter"


@dataclass(frozen=True, slots=True)
class Slot:
    """One variable: its name, its value reference and the member of the C struct behind it.

    Numbers are in the unit of *type*: a port's own, a parameter's coherent SI unit. *start* is absent from
    outputs; an enumeration's is the number of the item. *source* is the port or parameter in words, for messages.
    """

    name: str
    reference: int
    role: Role
    member: str
    type: Type
    source: str
    start: float | bool | None = None
    minimum: float | None = None
    maximum: float | None = None
    is_tunable: bool = True
    title: str = ""
    where: Location | None = None


def slots(component: Component) -> tuple[Slot, ...]:
    """Inputs, outputs and parameters, in this order and each in the order written; a slot's place is its reference.

    Raises DseError for names that C cannot say, that stand for two things, and starts that fit no value.
    """
    ports = component.interface.ports
    found = [
        *(_port(component, port) for port in ports if port.causality is Causality.INPUT),
        *(_port(component, port) for port in ports if port.causality is Causality.OUTPUT),
        *(_parameter(component, parameter) for parameter in component.parameters),
    ]
    raise_if_any(_problems(component, found))
    return tuple(replace(slot, reference=reference) for reference, slot in enumerate(found))


def _port(component: Component, port: Port) -> Slot:
    name = component.variable(port.name)
    if port.causality is Causality.OUTPUT:
        return Slot(name, 0, Role.OUTPUT, f"out.{name}", port.type, f"output '{port.name}'", where=component.where)
    start: float | bool = False if port.type.kind is Kind.BOOLEAN else 0
    return Slot(name, 0, Role.INPUT, f"in.{name}", port.type, f"input '{port.name}'", start, where=component.where)


def _parameter(component: Component, parameter: Parameter) -> Slot:
    name = component.variable(parameter.name)
    return Slot(
        name=name,
        reference=0,
        role=Role.PARAMETER,
        member=f"par.{name}",
        type=Type(parameter.type.kind, coherent(parameter.type.unit), parameter.type.items),
        source=f"parameter '{parameter.name}'",
        start=_number(parameter.type, parameter.start),
        minimum=_finite(parameter.minimum),
        maximum=_finite(parameter.maximum),
        is_tunable=parameter.tunable,
        title=parameter.title,
        where=parameter.where or component.where,
    )


def _number(kind: Type, value: Value) -> float | bool | None:
    """A start as the number C sees; None if the type has no such value."""
    match kind.kind, value:
        case Kind.ENUMERATION, str():
            return kind.items.index(value) if value in kind.items else None
        case Kind.BOOLEAN, bool():
            return value
        case Kind.INTEGER, int() | float() if not isinstance(value, bool) and _is_whole(value):
            return int(value)
        case Kind.REAL, int() | float() if not isinstance(value, bool) and math.isfinite(value):
            return float(value)
    return None


def _is_whole(value: float) -> bool:
    """Whether FMI's 32-bit integers have *value*."""
    return math.isfinite(value) and value == int(value) and -(2**31) <= value < 2**31


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _problems(component: Component, found: Iterable[Slot]) -> Iterable[Problem]:
    taken: dict[str, Slot] = {}
    for slot in found:
        if not _C_PATH.fullmatch(slot.name):
            hint = "use letters, digits, underscores and dots, or give the C member's name under 'map'"
            yield Problem(f"component '{component.name}': {slot.source} has no name in C", slot.where, hint)
        if slot.start is None and slot.role is not Role.OUTPUT:
            what = f"component '{component.name}': {slot.source} cannot start at a value that is not {slot.type}"
            yield Problem(what, slot.where)
        first = taken.setdefault(slot.name, slot)
        if first is not slot:
            what = f"component '{component.name}': {first.source} and {slot.source} are both variable '{slot.name}'"
            yield Problem(what, slot.where, "rename one, or tell them apart under 'map'")


_C_PATH = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*)*", re.ASCII)
