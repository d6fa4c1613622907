"""An existing FMU as a component: its ports and parameters in words a workspace can use, and what they stand for."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from dse.domain.component import (
    OCTETS,
    Causality,
    Component,
    Interface,
    Kind,
    Parameter,
    Port,
    Source,
    Type,
    Value,
    same_media,
)
from dse.domain.fmu import FmuModel, Variable
from dse.domain.labels import array_of
from dse.domain.outline import IrregularError, Outlined, outline
from dse.errors import DseError
from dse.expression import KEYWORDS
from dse.formats import flag_of, real_of, whole_of
from dse.interchange.names import numbered
from dse.loading import is_identifier
from dse.system import unit_of
from dse.units import DIMENSIONLESS, LARGEST, LARGEST_WHOLE, Unit, UnitError, coherent, parse_unit

MOST_VALUES = 4096
"""Arrays with more values than that are left out."""

_PARAMETERS = frozenset({"parameter", "structuralParameter"})
_BOUNDED = (Kind.REAL, Kind.INTEGER)


@dataclass(frozen=True, slots=True)
class Offer:
    """What an FMU can be to a workspace: *component* with an interface of its own, and what was *left_out* and why.

    *told* says what became something else than it is in the FMU.
    *starts* are the FMU's own values of the inputs, by port, in SI.
    """

    component: Component
    starts: Mapping[str, Value]
    left_out: tuple[str, ...]
    told: tuple[str, ...] = ()


def offer(name: str, model: FmuModel, source: Source) -> Offer:
    """The FMU *model*, of *source*, as a component called *name*, with all its inputs, outputs and parameters.

    Names that the language does not know are changed to near ones; the component's map has the FMU's. Ports are in
    coherent SI units, parameters in the FMU's own. Second names of one variable (aliases) are passed over.
    """
    found: list[_Found] = []
    left_out: list[str] = []
    told: list[str] = []
    ports: list[Port] = []
    starts: dict[str, Value] = {}
    parameters: list[Parameter] = []
    pointers = model.pointers
    for variable in model.variables.values():
        is_parameter = variable.causality in _PARAMETERS
        if variable.alias_of or not (is_parameter or variable.causality in ("input", "output")):
            continue
        if variable.name in pointers:
            continue
        try:
            unit = _unit(name, variable, model)
            type_ = _type(variable, _sayable(unit) if is_parameter else coherent(unit), is_parameter=is_parameter)
            values = [_value(start, type_, unit, variable) for start in _starts(variable)]
        except _LeftOut as reason:
            left_out.append(f"{variable.name}: {reason}")
            continue
        if variable.items and type_.kind is Kind.INTEGER:
            items = ", ".join(f"{number} ({item})" for item, number in variable.items.items())
            told.append(f"{variable.name}: an int, as its items cannot be names: {items}")
        pairs = zip(variable.labels, values, strict=True)
        found += (_Found(label, variable, type_, unit, value) for label, value in pairs)
    own_names = _own_names(found)
    for one in found:
        own, causality = own_names[one.label], one.variable.causality
        if causality in _PARAMETERS:
            parameters.append(_parameter(own, one.variable, one.type, one.unit, one.value))
        else:
            ports.append(Port(own, Causality(causality), one.type))
            if causality == "input":
                starts[own] = one.value
    inputs_first = sorted(ports, key=lambda port: port.causality is Causality.OUTPUT)
    interface = Interface(name, tuple(inputs_first))
    names = _map((own, label) for label, own in own_names.items())
    component = Component(name, interface, model.title, source, tuple(parameters), names=names)
    return Offer(component, starts, tuple(left_out), tuple(told))


def implementing(offered: Offer, interfaces: Iterable[Interface], *, has_units: bool = True) -> Offer:
    """What is *offered*, with that of the *interfaces* whose ports the component has all, and which has all its inputs.

    Names of ports may differ in capitals and separators. Of several interfaces it is the one with the most ports, then
    the first by name; if there is none the component keeps its own. Outputs that the interface does not have are left
    out. An input never is: it would be held at its start value, and nobody could connect it. What *has_units* fits only
    what is of its dimension.
    """
    component = offered.component
    found = [(interface, fit) for interface in interfaces if (fit := _fit(component, interface, has_units)) is not None]
    if not has_units:  # names alone, as In1 and Out1, say too little to leave anything out
        found = [(interface, fit) for interface, fit in found if len(fit) == len(component.interface.ports)]
    if not found:
        return offered
    interface, fit = min(found, key=lambda entry: (-len(entry[0].ports), entry[0].name))
    free = [parameter for parameter in component.parameters if interface.port(parameter.name) is None]
    names = _map((port, component.variable(own)) for port, own in fit.items())
    names |= _map((parameter.name, component.variable(parameter.name)) for parameter in free)
    known = {own: port for port, own in fit.items()}
    unused = [component.variable(port.name) for port in component.interface.ports if port.name not in known]
    hidden = [component.variable(parameter.name) for parameter in component.parameters if parameter not in free]
    left_out = [
        *offered.left_out,
        *(f"{label}: an output that {interface.name} does not have" for label in unused),
        *(f"{label}: a parameter called like a port of {interface.name}" for label in hidden),
    ]
    starts = {known[own]: value for own, value in offered.starts.items() if own in known}
    changed = replace(component, interface=interface, parameters=tuple(free), names=names)
    return Offer(changed, starts, tuple(left_out), offered.told)


class _LeftOut(Exception):  # noqa: N818  # says what became of the variable
    """Why a variable cannot be a port or a parameter."""


def _unit(name: str, variable: Variable, model: FmuModel) -> Unit:
    """What the variable's numbers are in, inside of the FMU."""
    if variable.kind is not Kind.REAL or not variable.unit:
        return DIMENSIONLESS
    try:
        unit = unit_of(name, variable, model)
    except DseError as error:
        raise _LeftOut(error.problems[0].what) from None
    if variable.is_relative and unit.offset:  # a difference of temperatures: numbers of a degree, not of the scale
        return replace(coherent(unit), factor=unit.factor)
    return unit


def _type(variable: Variable, unit: Unit, *, is_parameter: bool) -> Type:
    if variable.size > MOST_VALUES:
        raise _LeftOut(f"an array of {variable.size} values")
    if variable.kind is None:
        if variable.fmi_type == "String" and not (is_parameter and variable.shape):
            return Type(Kind.TEXT)
        if variable.fmi_type == "Binary" and not is_parameter:
            return Type(Kind.BINARY, media="" if variable.media == OCTETS else variable.media)
        raise _LeftOut(f"of type {variable.fmi_type}")
    if variable.kind is Kind.ENUMERATION:
        items = tuple(variable.items)
        if not items or not all(_can_be_item(item) for item in items):
            return Type(Kind.INTEGER)
        return Type(Kind.ENUMERATION, items=items)
    return Type(variable.kind, unit)


def _can_be_item(name: str) -> bool:
    """Items are words of YAML and of expressions, not of C: `long` can be one."""
    return name.isidentifier() and name not in KEYWORDS


def _sayable(unit: Unit) -> Unit:
    """The unit itself if its symbol means it everywhere, else the coherent one."""
    try:
        is_known = parse_unit(unit.symbol) == unit
    except UnitError:
        is_known = False
    return unit if is_known else coherent(unit)


def _starts(variable: Variable) -> tuple[str, ...]:
    """One text for each value, "" for what the FMU does not say."""
    if len(variable.start) == 1:
        return variable.start * variable.size
    return (*variable.start, *[""] * variable.size)[: variable.size]


def _parameter(name: str, variable: Variable, type_: Type, unit: Unit, value: Value) -> Parameter:
    low, high = (_bound(bound, type_, unit) for bound in (variable.minimum, variable.maximum))
    if isinstance(value, float | int) and not isinstance(value, bool):
        # An FMU whose start lies outside of its own range is not mended here: the start is what it runs with.
        low = None if low is not None and value < low else low
        high = None if high is not None and value > high else high
    is_tunable = variable.variability == "tunable"
    return Parameter(name, type_, value, low, high, is_tunable, " ".join(variable.description.split()))


def _bound(number: float | None, type_: Type, unit: Unit) -> float | None:
    """In SI; None for one that bounds nothing, as the largest number there is."""
    if number is None or not math.isfinite(number) or type_.kind not in _BOUNDED:
        return None
    si = _si(number, unit)
    return float(si) if abs(si) <= LARGEST else None


def _value(start: str, type_: Type, unit: Unit, variable: Variable) -> Value:
    match type_.kind:
        case Kind.TEXT:
            return start
        case Kind.BOOLEAN:
            return bool(flag_of(start))
        case Kind.INTEGER:
            number = next(iter(variable.items.values())) if variable.items and not start else whole_of(start) or 0
            if abs(number) > LARGEST_WHOLE:
                raise _LeftOut(f"its start value {number} is too large")
            return number
        case Kind.ENUMERATION:
            by_number = {number: item for item, number in variable.items.items()}
            return by_number.get(whole_of(start) or 0, type_.items[0])
        case Kind.REAL:
            si = _si(_real(start), unit)
            if abs(si) > LARGEST:
                raise _LeftOut("its start value is beyond the range of numbers")
            return float(si)
        case Kind.BINARY:
            return start.lower()


def _real(text: str) -> float:
    value = real_of(text)
    return value if value is not None and math.isfinite(value) else 0.0


def _si(value: float, unit: Unit) -> Fraction:
    """As a person's number is read: the decimal that is written, not the binary number nearest to it."""
    return Fraction(repr(value)) * unit.factor + unit.offset


@dataclass(frozen=True, slots=True)
class _Found:
    """A value of the FMU that becomes a port or parameter."""

    label: str
    variable: Variable
    type: Type
    unit: Unit
    value: Value

    @property
    def kind(self) -> str:
        """What values of one array have in common."""
        v = self.variable
        told = (v.minimum, v.maximum, v.variability, v.description) if v.causality in _PARAMETERS else ()
        return f"{v.causality} {self.type} {told}"


def _own_names(found: Iterable[_Found]) -> dict[str, str]:
    """What a component calls each value, by label: arrays stay arrays, if they are there whole and can be named."""
    roots: dict[str, list[_Found]] = {}
    for one in found:
        roots.setdefault(one.label.partition("[")[0], []).append(one)
    taken: set[str] = set()
    names: dict[str, str] = {}
    for root, several in roots.items():
        labels = [one.label for one in several]
        parts = {root: labels} if _is_array(root, several) else {label: [label] for label in labels}
        for whole, members in parts.items():
            own = numbered(_name(whole), lambda free: _collides(free, taken))
            taken.add(own)
            names |= {label: own + label.removeprefix(whole) for label in members}
    return names


def _is_array(root: str, found: Sequence[_Found]) -> bool:
    """Whether these values, whose names begin with *root*, can be the array of that name."""
    if len(found) < 2 and not found[0].variable.shape:
        return False
    try:
        (whole,) = outline((f"x{one.label.removeprefix(root)}", one.kind) for one in found).values()
    except IrregularError:
        return False
    is_port = found[0].variable.causality not in _PARAMETERS
    return bool(whole.shape) and (is_port or not whole.members) and _can_be_named(whole)


def _can_be_named(whole: Outlined) -> bool:
    return all(is_identifier(n) and n not in KEYWORDS and _can_be_named(member) for n, member in whole.members)


def _map(pairs: Iterable[tuple[str, str]]) -> dict[str, str]:
    """The component's map of own names to labels: those of an array by the array's name."""
    found: dict[str, str] = {}
    for own, label in pairs:
        array, other = array_of(own), array_of(label)
        is_alike = array and other and own.removeprefix(array) == label.removeprefix(other)
        mine, theirs = (array, other) if is_alike else (own, label)
        if mine != theirs:
            found[mine] = theirs
    return found


def _name(label: str) -> str:
    """*label* as a dotted path of names: what no name can hold becomes an underscore."""
    return ".".join(_step(step) for step in label.split("."))


def _step(step: str) -> str:
    plain = re.sub(r"[^A-Za-z0-9_]+", "_", step).strip("_") or "x"
    if plain[0].isdigit():
        plain = f"x{plain}"
    return plain if is_identifier(plain) and plain not in KEYWORDS else f"{plain}_"


def _collides(name: str, taken: set[str]) -> bool:
    """Whether *name* is taken, or is a group of others or lies in one."""
    steps = name.split(".")
    above = {".".join(steps[:length]) for length in range(1, len(steps) + 1)}
    return bool(above & taken) or any(other.startswith(f"{name}.") for other in taken)


def _fit(component: Component, interface: Interface, has_units: bool) -> dict[str, str] | None:
    """The component's own port for each port of *interface*.

    None if the interface has no ports, if the component lacks one of them, or the interface an input of the component.
    """
    own: dict[str, list[Port]] = {}
    for port in component.interface.ports:
        own.setdefault(_spelling(port.name), []).append(port)
    fit = {}
    for port in interface.ports:
        near = [other for other in own.get(_spelling(port.name), []) if _is_like(other, port, has_units=has_units)]
        if len(near) != 1:
            return None
        fit[port.name] = near[0].name
    inputs = {port.name for port in component.interface.ports if port.causality is Causality.INPUT}
    return fit if fit and inputs <= set(fit.values()) else None


def _spelling(name: str) -> str:
    return re.sub(r"[^a-z0-9\[\],]", "", name.lower())


def _is_like(own: Port, wanted: Port, *, has_units: bool) -> bool:
    if own.causality is not wanted.causality or own.type.kind is not wanted.type.kind:
        return False
    if own.type.kind is Kind.ENUMERATION:
        return set(wanted.type.items) <= set(own.type.items)
    if not same_media(own.type.media, wanted.type.media):
        return False
    return own.type.kind is not Kind.REAL or not has_units or own.type.unit.dimension == wanted.type.unit.dimension
