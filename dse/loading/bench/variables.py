"""What a study varies: design variables and conditions, by ranges or values, and what follows from them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

from pydantic import Field

from dse.domain.bench import Derived, TestBench
from dse.domain.component import Component, Kind, Type, as_number
from dse.domain.sampler import DesignVariable, Role, Scale
from dse.errors import DseError, Location, Problems, closest, fail
from dse.expression import parse_expression
from dse.formats import Entry
from dse.loading.bench.candidates import Candidates, settable, split_name
from dse.loading.sections import Plain, Section
from dse.loading.values import read_number
from dse.units import DIMENSIONLESS, Unit

_MOST_VALUES = 10_000
_VARIED = (Kind.REAL, Kind.INTEGER, Kind.BOOLEAN, Kind.ENUMERATION)


class VariableSection(Section):
    """One design variable, or a condition."""

    hints: ClassVar[Mapping[str, str]] = {"range": "write it as [low, high]; numbers have a decimal point, no comma"}

    range: list[Plain] | None = Field(default=None, min_length=2, max_length=2)
    values: list[Plain | bool] | None = None
    derived: str | None = None
    scale: Literal["linear", "log"] = "linear"
    levels: int | None = None
    nominal: Plain | bool | None = None
    weights: list[Plain] | None = None
    title: str = ""


@dataclass(frozen=True, slots=True)
class Place:
    """A name that can be varied: what may stand there, its own name, its type, and what allows which values of it."""

    name: str
    types: Sequence[tuple[Component, Type]]
    part: str
    port: str
    where: Location

    @classmethod
    def of(cls, entry: Entry, components: Candidates) -> Place:
        """The place *entry* is called by. DseError if nothing there can be varied."""
        found = settable(entry.name, components, entry.key)
        kind = found[0][1]
        if kind.kind not in _VARIED:
            what = (
                f"'{entry.name}' is {kind}: only real, whole and true/false parameters and enumerations can be varied"
            )
            raise fail(what, entry.key)
        other = next((each for _, each in found if each.items != kind.items), None)
        if other is not None:
            raise fail(f"'{entry.name}' is {kind} in one component and {other} in another", entry.key)
        return cls(entry.name, found, *split_name(entry.name, components, entry.key), entry.key)

    @property
    def type(self) -> Type:
        """The type in the first component that has it."""
        return self.types[0][1]

    @property
    def unit(self) -> Unit:
        """The unit of bare numbers."""
        return self.type.unit

    def limits(self) -> Iterator[tuple[Component, float, float]]:
        """What each component allows, SI."""
        for component, _ in self.types:
            parameter = component.parameter(self.port)
            if parameter:
                low = -math.inf if parameter.minimum is None else parameter.minimum
                yield component, low, math.inf if parameter.maximum is None else parameter.maximum

    def require_within(self, low: float, high: float, where: Location) -> None:
        """DseError, at *where*, unless each component that has it allows *low* … *high*."""
        for component, least, most in self.limits():
            if low < least or high > most:
                what = f"the range of '{self.name}' leaves what component {component.name} allows"
                raise fail(what, where, f"it allows {self._in_unit(least)} … {self._in_unit(most)}")

    def _in_unit(self, value: float) -> str:
        return (
            f"{self.unit.from_si(value):g} {self.unit}".strip() if math.isfinite(value) else "∞" if value > 0 else "-∞"
        )

    def given(self, bench: TestBench) -> float | None:
        """The value the bench has for it, SI; None if it has none."""
        parameter = self.types[0][0].parameter(self.port)
        value = bench.parameters.get(self.name, parameter.start if parameter else None)
        for part in bench.test_components:
            value = part.parameters.get(self.port, value) if part.name == self.part else value
        return None if value is None else as_number(value, self.type)

    def title(self, given: str) -> str:
        """What it is called in a report, unless it is *given* a title."""
        parameter = self.types[0][0].parameter(self.port)
        return given or (parameter.title if parameter else "") or self.name


def read_variable(place: Place, entry: Entry, section: VariableSection, bench: TestBench, role: Role) -> DesignVariable:
    """A design variable or condition, by its range or its values. DseError with what is wrong with it."""
    if (section.range is None) == (section.values is None):
        raise fail(f"give '{place.name}' either a range or values", entry.key, "range: [low, high]")
    levels = section.levels or 0
    if section.range is not None and place.type.items:
        raise fail(f"'{place.name}' is {place.type}: it has no range", entry["range"].key, "list its values")
    if section.range is not None:
        low, high, values = _range(place, entry["range"], section.range)
        shown = f"its range {section.range[0]} … {section.range[1]}"
    else:
        values = _values(place, entry["values"], section.values or [])
        low, high = values[0], values[-1]
        shown = "its values"
    scale = Scale(section.scale)
    if scale is Scale.LOG and (low <= 0 or values):
        hint = "start the range above 0" if not values else "leave out 'scale'"
        raise fail(f"'{place.name}' cannot be on a logarithmic scale", entry["scale"].where, hint)
    if role is Role.CONDITION and not values and levels < 1:
        raise fail(f"the condition '{place.name}' needs values, or levels", entry.key, "levels: 3")
    if values and section.levels:
        if place.type.kind is not Kind.INTEGER or section.values:
            raise fail(f"'{place.name}' has values, each is a level", entry["levels"].where, "leave out 'levels'")
        values = _spread(values, section.levels)
    nominal = _nominal(place, entry, section, bench, (low, high, values), shown)
    weights: tuple[float, ...] = ()
    if section.weights is not None:
        if role is not Role.CONDITION or section.values is None:
            raise fail("only a condition with 'values' has weights", entry["weights"].key, "leave them out")
        written = [read_variable_value(place, entry["values"][i], raw) for i, raw in enumerate(section.values)]
        found = read_weights(entry["weights"], section.weights, len(values))
        weights = tuple(weight for _, weight in sorted(zip(written, found, strict=True)))
    labels = tuple(place.type.items[int(value)] for value in values) if place.type.items else ()
    return DesignVariable(
        place.name,
        low,
        high,
        len(values) or levels,
        nominal,
        place.unit,
        place.title(section.title),
        entry.key,
        scale,
        values,
        role,
        labels=labels,
        weights=weights,
    )


def read_weights(entry: Entry, written: Sequence[Plain], number: int) -> list[float]:
    """How much each of so many values of a condition counts. Raises DseError."""
    if len(written) != number:
        raise fail(f"there are {number} values and {len(written)} weights", entry.where, "give one for each value")
    weights = [read_number(raw, DIMENSIONLESS, entry[i].where) for i, raw in enumerate(written)]
    if min(weights) < 0 or not 0 < sum(weights) < math.inf:
        raise fail("a weight is at least 0, and one is larger", entry.where, "weights: [3, 2, 1]")
    return weights


def read_derived(place: Place, entry: Entry, section: VariableSection) -> Derived:
    """A parameter that follows from others. DseError unless it is real and nothing else is said of it."""
    others = section.model_fields_set - {"derived", "title"}
    if others:
        raise fail(f"'{place.name}' is derived: it has no {' and '.join(sorted(others))}", entry.key, "leave it out")
    if place.type.kind is not Kind.REAL:
        raise fail(f"'{place.name}' is {place.type}: only real parameters can be derived", entry.key)
    return Derived(place.name, parse_expression(section.derived or "", entry["derived"].origin), place.type, entry.key)


def _range(place: Place, entry: Entry, written: Sequence[Plain]) -> tuple[float, float, tuple[float, ...]]:
    """Its ends, and what lies between if it is whole."""
    low, high = (read_number(raw, place.unit, entry[i].where) for i, raw in enumerate(written))
    if not low < high:
        raise fail(f"the range of '{place.name}' is empty: {written[0]} … {written[1]}", entry.where, "low, then high")
    place.require_within(low, high, entry.where)
    if place.type.kind is Kind.REAL:
        return low, high, ()
    if place.type.kind is Kind.BOOLEAN:
        raise fail(f"'{place.name}' is true or false", entry.where, "values: [false, true]")
    first, last = math.ceil(low), math.floor(high)
    if first > last:
        raise fail(f"there is no whole number in the range of '{place.name}'", entry.where, "widen it")
    if last - first >= _MOST_VALUES:
        raise fail(f"'{place.name}' has more than {_MOST_VALUES:,} values", entry.where, "list those that matter")
    return float(first), float(last), tuple(float(value) for value in range(first, last + 1))


def _values(place: Place, entry: Entry, written: Sequence[Plain | bool]) -> tuple[float, ...]:
    problems = Problems()
    found: list[float] = []
    for i, raw in enumerate(written):
        with problems:
            found.append(read_variable_value(place, entry[i], raw))
    if problems:
        raise DseError(*problems)
    values = tuple(sorted(set(found)))
    if len(values) < len(found) or not values:
        what = (f"'{place.name}' has a value twice", "remove one") if values else ("the list is empty", "give a value")
        raise fail(what[0], entry.where, what[1])
    place.require_within(values[0], values[-1], entry.where)
    return values


def read_variable_value(place: Place, entry: Entry, raw: Plain | bool) -> float:
    """What is written at *entry* as a value of *place*, SI; of an enumeration its number. Raises DseError."""
    if isinstance(raw, bool) or place.type.kind is Kind.BOOLEAN:
        if not (isinstance(raw, bool) and place.type.kind is Kind.BOOLEAN):
            raise fail(f"'{place.name}' is {place.type}, found '{raw}'", entry.where)
        return float(raw)
    if place.type.items:
        if raw not in place.type.items:
            raise fail(
                f"'{place.name}' is {place.type}, found '{raw}'", entry.where, closest(str(raw), place.type.items)
            )
        return float(place.type.items.index(str(raw)))
    value = read_number(raw, place.unit, entry.where)
    if place.type.kind is Kind.INTEGER and value != int(value):
        raise fail(f"'{place.name}' is a whole number, found {raw}", entry.where)
    return value


def _spread(values: tuple[float, ...], levels: int) -> tuple[float, ...]:
    """*levels* of whole *values*, evenly, both ends included."""
    last = max(levels - 1, 1)
    return tuple(sorted({values[round(i * (len(values) - 1) / last)] for i in range(levels)}))


def _nominal(
    place: Place,
    entry: Entry,
    section: VariableSection,
    bench: TestBench,
    among: tuple[float, float, tuple[float, ...]],
    shown: str,
) -> float:
    low, high, values = among
    if section.nominal is not None:
        nominal = read_variable_value(place, entry["nominal"], section.nominal)
        if not low <= nominal <= high or (values and nominal not in values):
            what = f"the nominal value of '{place.name}' is outside {shown}"
            raise fail(what, entry["nominal"].where, "widen the range or change nominal")
        return nominal
    given = place.given(bench)
    if values:
        return min(values, key=lambda value: (abs(value - (given if given is not None else low)), value))
    return given if given is not None else (low + high) / 2
