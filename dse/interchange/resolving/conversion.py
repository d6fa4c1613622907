"""What becomes of a value between two connectors: units, enumerations and transformations, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction

from dse.domain.component import Kind
from dse.domain.fmu import FmuModel, UnitDefinition, Variable
from dse.fmu import VALUE_KINDS
from dse.formats import flag_of, whole_of
from dse.interchange.resolving.carry import SAME, Carry, ConversionError
from dse.interchange.structure import NamedUnit, SignalType, Transformation
from dse.units import SI_SYMBOLS, UnitError, counts_otherwise, is_rounded, parse_unit


@dataclass(frozen=True, slots=True)
class Form:
    """How a value is given at one place; what is None is not said there.

    *kind* is a `Kind`, or String, Binary or Clock. Of a relative value (a difference of temperatures) only the unit's
    factor counts, not its offset.
    """

    kind: str
    unit: NamedUnit | None = None
    items: Mapping[str, int] | None = None
    is_relative: bool = False


KINDS: Mapping[str, str] = {name: kind or name for name, kind in VALUE_KINDS.items()}
"""The kind of each of SSP's types, which are called as FMI's; its own name for what is no number."""


def form_of(type_: SignalType) -> Form:
    """How a connector of this type gives its values."""
    return Form(KINDS[type_.name], type_.unit, type_.items)


def form_of_variable(variable: Variable, model: FmuModel) -> Form:
    """How the FMU gives the values of *variable*."""
    unit = NamedUnit(variable.unit, model.units.get(variable.unit)) if variable.unit else None
    return Form(variable.kind or variable.fmi_type, unit, variable.items or None, variable.is_relative)


def carry(
    source: Form, target: Form, transformation: Transformation | None, *, suppresses_unit_conversion: bool
) -> Carry:
    """What takes a value in the form *source* to the form *target*. Raises ConversionError.

    Units are converted first, so that the transformation is given a value in the target's unit (SSP, 5.3.2).
    """
    if transformation is None:
        if suppresses_unit_conversion:
            _require_kinds(source, target)
            return SAME
        return convert(source, target)
    if transformation.name == "LinearTransformation":
        if source.kind not in (Kind.REAL, Kind.INTEGER) or target.kind != Kind.REAL:
            raise ConversionError(
                f"a linear transformation is for real values, not from {source.kind} to {target.kind}"
            )
        before = SAME if suppresses_unit_conversion else convert(source, target)
        return before.then(Carry.of(transformation.factor, transformation.offset))
    return Carry(table=_table(source, target, transformation))


def convert(source: Form, target: Form) -> Carry:
    """The conversion of kinds, units and items that needs no transformation. Raises ConversionError."""
    _require_kinds(source, target)
    if source.kind == target.kind == Kind.REAL:
        way = _units(source.unit, target.unit)
        return replace(way, offset=Fraction(0)) if source.is_relative or target.is_relative else way
    if source.kind == target.kind == Kind.ENUMERATION and source.items and target.items:
        return _items(source.items, target.items)
    return SAME


_FITTING = {
    (Kind.INTEGER, Kind.REAL),
    (Kind.ENUMERATION, Kind.INTEGER),
    (Kind.INTEGER, Kind.ENUMERATION),
}
"""Kinds that may be connected though they differ: every value of the one is a value of the other."""


def _require_kinds(source: Form, target: Form) -> None:
    if source.kind != target.kind and (source.kind, target.kind) not in _FITTING:
        raise ConversionError(f"types differ: {source.kind} and {target.kind}")


def _units(source: NamedUnit | None, target: NamedUnit | None) -> Carry:
    if (
        source is None
        or target is None
        or (source.name == target.name and not (source.definition and target.definition))
    ):
        return SAME
    a, b = definition(source), definition(target)
    if _dimension(a) != _dimension(b):
        raise ConversionError(f"units differ: {source.name} and {target.name}")
    if counts_otherwise(source.name, target.name):
        raise ConversionError(f"units differ by 2 pi: {source.name} and {target.name}")
    factor = Fraction(a.factor) / Fraction(b.factor)
    return Carry(factor, (Fraction(a.offset) - Fraction(b.offset)) / Fraction(b.factor))


def definition(unit: NamedUnit) -> UnitDefinition:
    """What *unit* is in SI: as its file defines it, or by its name. Raises ConversionError.

    Tools round the factors they write (0.27778 for km/h): one that is close to the usual meaning stands for that.
    """
    usual = _usual(unit.name)
    if unit.definition is None:
        if usual is None:
            raise ConversionError(f"the unit '{unit.name}' is defined nowhere")
        return usual
    if usual is None or _dimension(usual) != _dimension(unit.definition):
        return unit.definition
    written = unit.definition
    is_usual = is_rounded(usual.factor, written.factor) and is_rounded(usual.offset, written.offset)
    return usual if is_usual else written


def is_known(unit: NamedUnit) -> bool:
    """Whether *unit* has a meaning: its file defines it, or its name is usual."""
    return unit.definition is not None or _usual(unit.name) is not None


def _usual(name: str) -> UnitDefinition | None:
    try:
        known = parse_unit(name)
    except UnitError:
        return None
    if any(base not in SI_SYMBOLS or exponent.denominator != 1 for base, exponent in known.dimension):
        return None
    exponents = {SI_SYMBOLS[base]: int(exponent) for base, exponent in known.dimension}
    return UnitDefinition(float(known.factor), float(known.offset), exponents)


def _dimension(unit: UnitDefinition) -> dict[str, int]:
    # Angles have no dimension: 1/s and rad/s are connected everywhere.
    return {name: n for name, n in unit.exponents.items() if n and name != "rad"}


def _items(source: Mapping[str, int], target: Mapping[str, int]) -> Carry:
    if source == target:
        return SAME
    lost = [name for name in source if name not in target]
    if lost:
        raise ConversionError(
            f"enumerations differ: the source's item '{lost[0]}' is none of {', '.join(target)}; "
            "an EnumerationMappingTransformation defines its meaning"
        )
    return Carry(table={value: target[name] for name, value in source.items()})


def _table(source: Form, target: Form, transformation: Transformation) -> dict[int, int]:
    match transformation.name:
        case "BooleanMappingTransformation":
            if (source.kind, target.kind) != (Kind.BOOLEAN, Kind.BOOLEAN):
                raise ConversionError(f"a Boolean table is not for {source.kind} and {target.kind}")
            listed = _entries(transformation, flag_of, "neither true nor false")
            return {value: listed.get(value, value) for value in (0, 1)}
        case "IntegerMappingTransformation":
            whole = (Kind.INTEGER, Kind.ENUMERATION)
            if source.kind not in whole or target.kind not in whole:
                raise ConversionError(f"an integer table is not for {source.kind} and {target.kind}")
            table = _entries(transformation, whole_of, "no whole number")
            values = set(source.items.values()) if source.items else set()
            table = {value: table.get(value, value) for value in sorted({*table, *values})}
            strange = [
                table[value] for value in values or table if target.items and table[value] not in target.items.values()
            ]
            if strange:
                raise ConversionError(f"{strange[0]} is the value of no item of the target")
            return table
    if (source.kind, target.kind) != (Kind.ENUMERATION, Kind.ENUMERATION):
        raise ConversionError(f"a table of items is not for {source.kind} and {target.kind}")
    if not source.items or not target.items:
        raise ConversionError("a table of items needs enumerations with defined items")
    named = dict(transformation.entries)
    for name in named:
        if name not in source.items:
            raise ConversionError(f"'{name}' is not an item of the source: {', '.join(source.items)}")
    meant = {value: named.get(name, name) for name, value in source.items.items()}
    for name in meant.values():
        if name not in target.items:
            raise ConversionError(f"'{name}' is not an item of the target: {', '.join(target.items)}")
    return {value: target.items[name] for value, name in meant.items()}


def _entries(transformation: Transformation, read: Callable[[str], int | None], otherwise: str) -> dict[int, int]:
    for text in (text for entry in transformation.entries for text in entry):
        if read(text) is None:
            raise ConversionError(f"'{text}' is {otherwise}")
    return {int(read(a) or 0): int(read(b) or 0) for a, b in transformation.entries}


def merged(form: Form, said: Form | None) -> Form:
    """*form*, which an FMU gives, with what its connector says besides. Raises ConversionError if they contradict."""
    if said is None:
        return form
    if said.kind != form.kind and {said.kind, form.kind} != {Kind.INTEGER, Kind.ENUMERATION}:
        raise ConversionError(f"the connector is {said.kind}, the FMU's variable {form.kind}")
    if form.unit is None:
        return replace(form, unit=said.unit)
    if said.unit and said.unit.name != form.unit.name and not _units(said.unit, form.unit).is_linear_identity:
        raise ConversionError(f"the connector is in {said.unit.name}, the FMU's variable in {form.unit.name}")
    return form
