"""A finished FMU as a component: its ports and parameters in words a workspace can use, and what they stand for."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from dse.domain.component import Causality, Component, FmuSource, Interface, Kind, Parameter, Port, Type, Value
from dse.domain.fmu import FmuModel, Variable
from dse.errors import DseError
from dse.loading.expression_tokens import KEYWORDS
from dse.loading.names import is_identifier
from dse.system.binding import unit_of
from dse.units import DIMENSIONLESS, Unit, coherent

MOST_VALUES = 64
"""Arrays with more values than that are left out."""

_PARAMETERS = frozenset({"parameter", "structuralParameter"})


@dataclass(frozen=True, slots=True)
class Offer:
    """What an FMU can be to a workspace: *component* with an interface of its own, and what was *left_out* and why.

    *starts* are the FMU's own values of the inputs.
    """

    component: Component
    starts: Mapping[str, Value]
    left_out: tuple[str, ...]


def offer(name: str, model: FmuModel, file: Path) -> Offer:
    """The FMU *model* in *file* as a component called *name*, with all its inputs, outputs and parameters.

    Names that the language does not know are changed to near ones; the component's map has the FMU's. Ports are in
    coherent SI units, parameters in the FMU's own. Second names of one variable (aliases) are passed over.
    """
    taken: set[str] = set()
    names: dict[str, str] = {}
    left_out: list[str] = []
    ports: list[Port] = []
    starts: dict[str, Value] = {}
    parameters: list[Parameter] = []
    for variable in model.variables.values():
        is_parameter = variable.causality in _PARAMETERS
        if variable.alias_of or not (is_parameter or variable.causality in ("input", "output")):
            continue
        try:
            type_ = _type(name, variable, model, is_parameter=is_parameter)
        except _LeftOut as reason:
            left_out.append(f"{variable.name}: {reason}")
            continue
        for place, label in enumerate(variable.labels):
            own = _free(_name(label), taken)
            taken.add(own)
            if own != label:
                names[own] = label
            if is_parameter:
                parameters.append(_parameter(own, variable, type_, place))
            else:
                ports.append(Port(own, Causality(variable.causality), type_))
                starts[own] = _parameter(own, variable, type_, place).start
    inputs_first = sorted(ports, key=lambda port: port.causality is Causality.OUTPUT)
    interface = Interface(name, tuple(inputs_first))
    source = FmuSource(file)
    component = Component(name, interface, model.title, source, tuple(parameters), names=names)
    return Offer(component, starts, tuple(left_out))


def implementing(offered: Offer, interfaces: Iterable[Interface]) -> Component:
    """The component *offered*, with that of the *interfaces* whose ports it has all.

    Names of ports may differ in capitals and separators. Of several interfaces it is the one with the most ports, then
    the first by name; if there is none the component keeps its own. Inputs that the interface does not have become
    parameters, outputs are left out.
    """
    component = offered.component
    found = [(interface, fit) for interface in interfaces if (fit := _fit(component, interface)) is not None]
    if not found:
        return component
    interface, fit = min(found, key=lambda entry: (-len(entry[0].ports), entry[0].name))
    names = {port: component.variable(own) for port, own in fit.items() if component.variable(own) != port}
    rest = [p for p in component.interface.ports if p.name not in fit.values() and p.causality is Causality.INPUT]
    extra = tuple(Parameter(port.name, port.type, offered.starts[port.name]) for port in rest)
    free = [parameter for parameter in (*component.parameters, *extra) if interface.port(parameter.name) is None]
    names |= {p.name: component.names[p.name] for p in free if p.name in component.names}
    return Component(component.name, interface, component.title, component.source, tuple(free), names=names)


class _LeftOut(Exception):  # noqa: N818  # says what became of the variable
    """Why a variable cannot be a port or a parameter."""


def _type(name: str, variable: Variable, model: FmuModel, *, is_parameter: bool) -> Type:
    if variable.size > MOST_VALUES:
        raise _LeftOut(f"an array of {variable.size} values")
    if variable.kind is None:
        if is_parameter and variable.fmi_type == "String" and not variable.shape:
            return Type(Kind.TEXT)
        raise _LeftOut(f"of type {variable.fmi_type}")
    if variable.kind is Kind.ENUMERATION:
        items = tuple(variable.items)
        if not items or not all(is_identifier(item) and item not in KEYWORDS for item in items):
            return Type(Kind.INTEGER)
        return Type(Kind.ENUMERATION, items=items)
    if variable.kind is not Kind.REAL:
        return Type(variable.kind)
    if not variable.unit:
        return Type(Kind.REAL)
    try:
        unit = unit_of(name, variable, model)
    except DseError as error:
        raise _LeftOut(error.problems[0].what) from None
    return Type(Kind.REAL, _sayable(unit) if is_parameter else coherent(unit))


def _sayable(unit: Unit) -> Unit:
    """The unit itself if its symbol means it everywhere, else the coherent one."""
    from dse.units import UnitError, parse_unit

    try:
        is_known = parse_unit(unit.symbol) == unit
    except UnitError:
        is_known = False
    return unit if is_known else coherent(unit)


def _parameter(name: str, variable: Variable, type_: Type, place: int) -> Parameter:
    start = variable.start[0] if len(variable.start) == 1 else (*variable.start, *[""] * (place + 1))[place]
    value = _value(start, type_, variable)
    low, high = (
        None if bound is None or type_.kind not in (Kind.REAL, Kind.INTEGER) else _si(bound, type_.unit)
        for bound in (variable.minimum, variable.maximum)
    )
    if isinstance(value, float | int) and not isinstance(value, bool):
        # An FMU whose start lies outside of its own range is not mended here: the start is what it runs with.
        low = None if low is not None and value < low else low
        high = None if high is not None and value > high else high
    is_tunable = variable.variability == "tunable"
    return Parameter(name, type_, value, low, high, is_tunable, _title(variable.description))


def _value(start: str, type_: Type, variable: Variable) -> Value:
    match type_.kind:
        case Kind.TEXT:
            return start
        case Kind.BOOLEAN:
            return start.strip() in ("true", "1")
        case Kind.INTEGER:
            return _whole(start)
        case Kind.ENUMERATION:
            by_number = {number: item for item, number in variable.items.items()}
            return by_number.get(_whole(start), type_.items[0])
        case Kind.REAL:
            return _si(_real(start), type_.unit)


def _whole(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        return 0


def _real(text: str) -> float:
    try:
        value = float(text)
    except ValueError:
        return 0.0
    return value if math.isfinite(value) else 0.0


def _si(value: float, unit: Unit) -> float:
    return unit.to_si(value) if unit is not DIMENSIONLESS else value


def _title(text: str) -> str:
    return " ".join(text.split())


def _name(label: str) -> str:
    """*label* as a dotted path of names: what no name can hold becomes an underscore."""
    steps = [_step(step) for step in label.split(".")]
    return ".".join(steps)


def _step(step: str) -> str:
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", step).strip("_") or "x"
    if plain[0].isdigit():
        plain = f"x{plain}"
    return plain if is_identifier(plain) and plain not in KEYWORDS else f"{plain}_"


def _free(name: str, taken: set[str]) -> str:
    """*name*, with a number if it is taken, or if it is a group of others or lies in one."""
    candidates: Iterator[str] = (name if number == 1 else f"{name}_{number}" for number in range(1, len(taken) + 3))
    return next(candidate for candidate in candidates if not _collides(candidate, taken))


def _collides(name: str, taken: set[str]) -> bool:
    steps = name.split(".")
    above = {".".join(steps[:length]) for length in range(1, len(steps) + 1)}
    return bool(above & taken) or any(other.startswith(f"{name}.") for other in taken)


def _fit(component: Component, interface: Interface) -> dict[str, str] | None:
    """The component's own port for each port of *interface*; None if one is lacking or nothing is asked for."""
    own: dict[str, list[Port]] = {}
    for port in component.interface.ports:
        own.setdefault(_spelling(port.name), []).append(port)
    fit = {}
    for port in interface.ports:
        near = [other for other in own.get(_spelling(port.name), []) if _is_like(other, port)]
        if len(near) != 1:
            return None
        fit[port.name] = near[0].name
    return fit or None


def _spelling(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def _is_like(own: Port, wanted: Port) -> bool:
    if own.causality is not wanted.causality or own.type.kind is not wanted.type.kind:
        return False
    if own.type.kind is Kind.ENUMERATION:
        return set(wanted.type.items) <= set(own.type.items)
    return own.type.kind is not Kind.REAL or own.type.unit.dimension == wanted.type.unit.dimension
