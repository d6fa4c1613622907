"""A component's port or parameter as a value of its FMU: which one, and how its numbers are converted."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from fractions import Fraction

from dse.domain.component import Component, Kind, Type, same_media
from dse.domain.fmu import FmuModel, UnitDefinition, Variable
from dse.domain.system import Conversion
from dse.errors import DseError, Location, Problem, closest, fail
from dse.units import Unit, UnitError, counts_otherwise, is_rounded, parse_unit

IDENTITY = Conversion()

_SWAPPED = Conversion(items=((0.0, 1.0), (1.0, 0.0)))
"""Of a truth value that is the contrary of what lies behind its reference."""


@dataclass(frozen=True, slots=True)
class Binding:
    """The value called *label* of *variable*; numbers outside of the FMU are those of the port's type, in SI."""

    variable: Variable
    label: str
    conversion: Conversion = IDENTITY


def bind(component: Component, name: str, type_: Type, model: FmuModel, causalities: tuple[str, ...]) -> Binding:
    """What stands behind the port or parameter *name* of *component* in its FMU, of one of FMI's *causalities*.

    Raises DseError at the component: no such variable, another causality, kind or unit, other items.
    """
    where = component.where
    label = component.variable(name)
    variable = find_variable(label, model)
    if variable is None:
        raise DseError(_missing(component, name, label, model, causalities))
    if variable.causality not in causalities:
        found = variable.causality or "local"
        raise fail(f"'{label}' in the FMU of {component.name} is {found}, not {causalities[0]}", where)
    if label in model.pointers:
        whole = next(v.name for v in model.variables.values() if any(label == name for name, _ in v.integers))
        what = f"'{label}' in the FMU of {component.name} is a part of the binary '{whole}'"
        raise fail(what, where, f"give the port the type binary and map it: 'map: {{{name}: {whole}}}'")
    if not same_media(variable.media, type_.media):
        what = f"'{label}' in the FMU of {component.name} holds {variable.media}, not {type_.media}"
        raise fail(what, where, "map another binary, or change the port's type")
    if not _fits(variable, type_):
        found = str(variable.kind or variable.fmi_type.lower())
        raise fail(f"'{label}' in the FMU of {component.name} is {found}, not {type_}", where)
    conversion = _SWAPPED if variable.is_negated and type_.kind is Kind.BOOLEAN else IDENTITY
    if type_.kind is Kind.REAL:
        conversion = _of_unit(component, variable, label, type_, model)
    elif type_.kind is Kind.INTEGER and variable.is_negated:
        conversion = Conversion(-1.0)
    elif type_.kind is Kind.ENUMERATION and variable.items:
        conversion = _of_items(component, variable, label, type_)
    return Binding(variable, label, conversion)


def unit_of(name: str, variable: Variable, model: FmuModel, where: Location | None = None) -> Unit:
    """The unit of *variable* as the FMU defines it, else by its usual meaning; *name* is the component's.

    Tools round the factors they write (0.27778 for km/h): one that is close to the usual meaning stands for that.
    Raises DseError at *where* for a unit that nobody defines.
    """
    usual: Unit | None = None
    with suppress(UnitError):
        usual = parse_unit(variable.unit)
    defined = model.units.get(variable.unit)
    if defined is None:
        if usual is None:
            what = f"'{variable.name}' in the FMU of {name} has the unknown unit '{variable.unit}'"
            raise fail(what, where, "the FMU does not define it either")
        return usual
    dimension = parse_unit(_coherent(defined)).dimension
    if usual is not None and usual.dimension == dimension and _are_close(usual, defined):
        return usual
    return Unit(variable.unit, Fraction(defined.factor), Fraction(defined.offset), dimension)


def find_variable(label: str, model: FmuModel) -> Variable | None:
    """The scalar called *label*, or the array one of whose values is; None if there is none."""
    try:
        variable = model.variable_of(label)
    except KeyError:
        return None
    return variable if label in variable.labels else None


def _missing(component: Component, name: str, label: str, model: FmuModel, causalities: tuple[str, ...]) -> Problem:
    array = model.variables.get(label)
    if array is not None:
        what = f"'{label}' in the FMU of {component.name} is an array of shape {'x'.join(map(str, array.shape))}"
        return Problem(what, component.where, f"map one of its values: 'map: {{{name}: \"{array.labels[0]}\"}}'")
    whole = model.variables.get(label.rpartition("[")[0])
    if whole is not None and whole.shape:
        sizes = "x".join(map(str, whole.shape))
        what = f"the FMU of {component.name} has no '{label}': '{whole.name}' has {sizes} values"
        sized_by = ", ".join(f"'{parameter}'" for parameter in dict.fromkeys(whole.sized_by) if parameter)
        return Problem(what, component.where, f"its size is set by {sized_by}" if sized_by else "")
    near = [v.name for v in model.variables.values() if v.causality in causalities]
    hint = f"map it: 'map: {{{name}: …}}'; {closest(label, near)}" if near else ""
    return Problem(f"the FMU of {component.name} has no variable '{label}'", component.where, hint)


def _fits(variable: Variable, type_: Type) -> bool:
    """Whether the variable takes values of the type; an enumeration and an integer do by the numbers of the items."""
    if not type_.kind.is_number:
        return variable.fmi_type == ("String" if type_.kind is Kind.TEXT else "Binary")
    return variable.kind is type_.kind or {variable.kind, type_.kind} == {Kind.ENUMERATION, Kind.INTEGER}


def _of_unit(component: Component, variable: Variable, label: str, type_: Type, model: FmuModel) -> Conversion:
    sign = -1.0 if variable.is_negated else 1.0
    if not variable.unit:
        return Conversion(sign) if variable.is_negated else IDENTITY
    unit = unit_of(component.name, variable, model, component.where)
    if unit.dimension != type_.unit.dimension or counts_otherwise(unit.symbol, type_.unit.symbol):
        what = f"'{label}' in the FMU of {component.name} is in {variable.unit}, expected {type_}"
        raise fail(what, component.where, "give the port a unit of the same dimension, or map another variable")
    found = Conversion(sign * float(unit.factor), 0.0 if variable.is_relative else float(unit.offset))
    return found if found != IDENTITY else IDENTITY


def _coherent(unit: UnitDefinition) -> str:
    return ".".join(f"{base}{power}" for base, power in sorted(unit.exponents.items()) if base != "rad") or "1"


def _are_close(usual: Unit, defined: UnitDefinition) -> bool:
    return is_rounded(float(usual.factor), defined.factor) and is_rounded(float(usual.offset), defined.offset)


def _of_items(component: Component, variable: Variable, label: str, type_: Type) -> Conversion:
    lacking = [item for item in type_.items if item not in variable.items]
    if lacking:
        what = f"'{label}' in the FMU of {component.name} has no item '{lacking[0]}'"
        raise fail(what, component.where, f"its items: {', '.join(variable.items)}")
    pairs = tuple((float(variable.items[item]), float(number)) for number, item in enumerate(type_.items))
    return Conversion(items=pairs) if any(inside != outside for inside, outside in pairs) else IDENTITY
