"""Parameter sets and their precedence: which value every variable of an FMU, and every system's connector, is given."""

from __future__ import annotations

import math
from collections.abc import Iterator

from dse.domain.component import Kind
from dse.errors import Problem
from dse.formats import flag_of, real_of, shortened, whole_of
from dse.interchange.resolving.carry import Carry, ConversionError
from dse.interchange.resolving.conversion import KINDS, Form, carry, convert
from dse.interchange.resolving.network import Endpoint, HopNetwork, Way
from dse.interchange.structure import Assignment, NamedUnit, System, Transformation
from dse.system import find_variable
from dse.units import UnitError, parse_quantity

TYPED = "typed"
"""Type of a value that a person typed: it is read as what it is given to."""

Settled = float | str | bytes


def assignments(network: HopNetwork, notes: list[Problem], problems: list[Problem]) -> dict[Endpoint, Assignment]:
    """What the bindings of all elements give, by variable of an FMU or connector of a system.

    Of several values for one of them the later binding's counts, and that of the outer system (SSP, 5.2.3). A name that
    matches nothing is ignored, as SSP says; *notes* tell which. Of two values in one set neither counts.
    """
    given = dict(_assigned(network, (), notes))
    for node, assigned in given.items():
        if assigned.value.rival:
            what = f"{node} is given two values; the other one is at {assigned.value.rival}"
            problems.append(Problem(what, assigned.value.where, "remove one of them"))
    return given


def _assigned(network: HopNetwork, way: Way, notes: list[Problem]) -> Iterator[tuple[Endpoint, Assignment]]:
    element = network.components.get(way) or network.systems[way]
    for inner in element.parts if isinstance(element, System) else ():
        yield from _assigned(network, (*way, inner.name), notes)
    for assigned in element.assignments:
        nodes = list(named(network, assigned.target, way))
        if not nodes:
            place = ".".join(way) or "the system"
            what = f"nothing in {place} is called '{shortened(assigned.target)}'; its value is not used"
            notes.append(Problem(what, assigned.where))
        yield from ((node, assigned) for node in nodes)


def named(network: HopNetwork, name: str, way: Way = ()) -> Iterator[Endpoint]:
    """All variables and connectors at *way* that have the hierarchical *name*; there may be several."""
    if way in network.models:
        model = network.models[way]
        if name in model.variables or find_variable(name, model):
            yield Endpoint(way, name)
        return
    if Endpoint(way, name) in network.connectors:
        yield Endpoint(way, name)
    for inner in network.systems[way].parts:
        if name.startswith(f"{inner.name}."):
            yield from named(network, name.removeprefix(f"{inner.name}."), (*way, inner.name))


def settle(assigned: Assignment, target: Form, after: Carry | None = None) -> tuple[Settled, ...]:
    """What *assigned* gives to something of the form *target*, then carried on *after*. Raises ConversionError."""
    value = assigned.value
    if value.type == TYPED:
        return tuple(_typed(text, target, after) for text in value.values)
    if value.type in ("String", "Binary") or target.kind in ("String", "Binary"):
        if value.type != target.kind or assigned.transformation is not None:
            raise ConversionError(f"a value of the type {value.type} cannot be given to {target.kind}")
        return tuple(_bytes(text) if value.type == "Binary" else text for text in value.values)
    if value.type == "Enumeration":
        return tuple(_item(text, assigned.transformation, target, after) for text in value.values)
    source = Form(KINDS[value.type], value.unit)
    numbers = [_number(text, value.type) for text in value.values]
    if source.kind == Kind.REAL and target.kind == Kind.INTEGER and all(number.is_integer() for number in numbers):
        source = Form(Kind.INTEGER)
    way = carry(
        source,
        target,
        assigned.transformation,
        suppresses_unit_conversion=assigned.suppresses_unit_conversion,
    )
    way = way.then(after) if after else way
    return tuple(_applied(way, number) for number in numbers)


def _applied(way: Carry, number: float) -> float:
    value = way.apply(number)
    if math.isfinite(number) and not math.isfinite(value):
        raise ConversionError(f"{number:g} is converted to what is beyond the range of numbers")
    return value


def _item(text: str, transformation: Transformation | None, target: Form, after: Carry | None) -> float:
    if target.kind != Kind.ENUMERATION or not target.items:
        raise ConversionError(f"the item '{shortened(text)}' cannot be given to {target.kind}")
    if transformation is not None and transformation.name != "EnumerationMappingTransformation":
        raise ConversionError("the value is an item's name, which only a table of items can change")
    name = dict(transformation.entries).get(text, text) if transformation else text
    if name not in target.items:
        raise ConversionError(f"'{shortened(name)}' is none of {', '.join(target.items)}")
    number = float(target.items[name])
    return after.apply(number) if after else number


def _number(text: str, type_: str) -> float:
    kind = KINDS[type_]
    value: float | int | bool | None
    if kind == Kind.BOOLEAN:
        value = flag_of(text)
    elif kind == Kind.INTEGER:
        value = whole_of(text)
    else:
        value = real_of(text)
    if value is None:
        raise ConversionError(f"'{shortened(text)}' is not of the type {type_}")
    if not math.isfinite(value):
        raise ConversionError(f"'{shortened(text)}' is not a number that an FMU can begin with")
    return float(value)


def _bytes(text: str) -> bytes:
    try:
        return bytes.fromhex(text)
    except ValueError:
        raise ConversionError(f"'{shortened(text)}' is not a sequence of hexadecimal digits") from None


def _typed(text: str, target: Form, after: Carry | None) -> Settled:
    if target.kind == "String":
        return text
    if target.kind == "Binary":
        return _bytes(text)
    if target.kind == Kind.ENUMERATION and target.items and whole_of(text) is None:
        return _item(text, None, target, after)
    if target.kind == Kind.REAL:
        number = _quantity(text, target)
    else:
        number = _number(text, "Boolean" if target.kind == Kind.BOOLEAN else "Integer")
    return after.apply(number) if after else number


def _quantity(text: str, target: Form) -> float:
    """A number in the target's own unit, or with another unit of the same kind."""
    try:
        quantity = parse_quantity(text)
    except UnitError as error:
        raise ConversionError(str(error)) from None
    if not quantity.unit.symbol:
        return float(quantity.magnitude)
    if target.unit is None:
        raise ConversionError(f"it has no unit, so that '{text}' cannot be converted")
    unit = quantity.unit
    known = NamedUnit(unit.symbol)
    way = convert(Form(Kind.REAL, known), Form(Kind.REAL, target.unit))
    return _applied(way, float(quantity.magnitude))
