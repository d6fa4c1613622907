"""A component's ports and parameters as the variables of the FMU that is built from it."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from dse.domain.component import Causality, Component, Kind, Parameter, Port, Type, Value
from dse.domain.labels import Shape, array_of, c_member, element_names, shapes
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
    The values of an array are slots one after another; the first has the array's *shape*.
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
    shape: Shape = ()

    @property
    def array(self) -> str:
        """The name of the array it is a value of, "" for none."""
        return array_of(self.name)


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
    firsts = _firsts(found)
    return tuple(
        replace(slot, reference=reference, shape=firsts.get(slot.name, ())) for reference, slot in enumerate(found)
    )


def _firsts(found: Sequence[Slot]) -> dict[str, Shape]:
    """The first value of every array that is there whole and in order, with the array's shape."""
    members: dict[str, list[str]] = {}
    for slot in found:
        if slot.array:
            members.setdefault(slot.array, []).append(slot.name)
    sizes = {array: shapes(name.removeprefix(array) for name in names)[""] for array, names in members.items()}
    return {
        names[0]: sizes[array] for array, names in members.items() if names == list(element_names(array, sizes[array]))
    }


def _port(component: Component, port: Port) -> Slot:
    name, source, where = component.variable(port.name), f"{port.causality} '{port.name}'", component.where
    member = c_member(name)
    if port.causality is Causality.OUTPUT:
        return Slot(name, 0, Role.OUTPUT, f"out.{member}", port.type, source, where=where)
    start: float | bool = False if port.type.kind is Kind.BOOLEAN else 0
    return Slot(name, 0, Role.INPUT, f"in.{member}", port.type, source, start, where=where)


def _parameter(component: Component, parameter: Parameter) -> Slot:
    name = component.variable(parameter.name)
    return Slot(
        name=name,
        reference=0,
        role=Role.PARAMETER,
        member=f"par.{c_member(name)}",
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
            yield Problem(what, slot.where, "rename one, or distinguish them under 'map'")


_STEP = r"[A-Za-z_]\w*(\[[1-9][0-9]*(,[1-9][0-9]*)*\])?"
_C_PATH = re.compile(rf"{_STEP}(\.{_STEP})*", re.ASCII)
