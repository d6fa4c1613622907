"""What the columns of a table of runs are called, and their units."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from decimal import Decimal
from enum import StrEnum
from typing import Any

from dse.domain.definition import StudyDefinition
from dse.domain.run import ERROR_BAR
from dse.units import Unit, coherent, parse_unit

_NAMED = ("N", "Pa", "J", "W", "V")


def choice_columns(definition: StudyDefinition) -> dict[str, str]:
    """The column of what is chosen at each place of the configurations, by path: ``sensor``.

    It is ``choice(sensor)`` where something that was varied or measured is called so.
    """
    order = {path: number for number, path in enumerate(definition.design.places)}
    paths = dict.fromkeys(path for configuration in definition.configurations for path in configuration.choices)
    taken = {"run", "configuration", "outcome", "problem", "check", "verdict"}
    taken |= {variable.name for variable in definition.variables} | {metric.name for metric in definition.metrics}
    return {
        path: f"choice({path})" if path in taken else path
        for path in sorted(paths, key=lambda path: order.get(path, len(order)))
    }


def total_columns(definition: StudyDefinition) -> dict[str, str]:
    """The column of each sum of a property over a configuration, by the property's name: ``sum(cost)``."""
    names = dict.fromkeys(name for configuration in definition.configurations for name in configuration.totals)
    return {name: f"sum({name})" for name in names}


class Units(StrEnum):
    """In which units numbers leave a study: those that are shown, or SI."""

    SHOWN = "shown"
    SI = "si"


@dataclass(frozen=True, slots=True)
class Scale:
    """The *unit*, called *symbol*, in which SI numbers of a column leave the study."""

    symbol: str
    unit: Unit
    is_difference: bool = False
    """Whether the unit's offset does not count: 20 degC are 20 K apart from 0 degC."""

    def of(self, si: Any) -> Any:
        """A number, or an array of numbers, in the unit; larger ones are never smaller there."""
        offset = 0.0 if self.is_difference else float(self.unit.offset)
        return (si - offset) / float(self.unit.factor)

    def point(self, value: Any) -> Any:
        """A variable's value in the unit, if that is not SI as a decimal number that reads back exactly."""
        is_itself = isinstance(value, bool | str) or self.unit.is_coherent or not math.isfinite(value)
        return value if is_itself else self.unit.written(value)

    def number(self, value: Any) -> Any:
        """A variable's value in the unit, as plain data."""
        found = self.point(value)
        return float(found) if isinstance(found, Decimal) else found

    def text(self, si: float) -> str:
        """A number with its unit."""
        return f"{self.of(si)!r} {self.symbol}".rstrip()


def scales_of(definition: StudyDefinition, units: Units) -> dict[str, Scale]:
    """The scale of each variable, metric, error bar, margin (``R1.margin``), sum and waveform of a figure."""
    return {name: _scale(symbol, units, is_difference) for name, symbol, is_difference in _declared(definition)}


def units_of(definition: StudyDefinition) -> dict[str, str]:
    """The SI unit of each variable, metric, error bar, margin (``R1.margin``), sum and waveform of a figure, if any."""
    return {name: scale.symbol for name, scale in scales_of(definition, Units.SI).items()}


def titles_of(definition: StudyDefinition, columns: Iterable[str]) -> dict[str, str]:
    """What *columns* are called in words, of those that have a title."""
    titles = {variable.name: variable.title for variable in definition.variables}
    titles |= {metric.name: metric.title for metric in definition.metrics}
    for entry in definition.requirements:
        if entry.title != entry.name:
            titles |= {f"{entry.name}.{what}": f"{entry.title}, {what}" for what in ("verdict", "margin")}
    return {name: titles[name] for name in columns if titles.get(name, name) != name}


def verdict_column(definition: StudyDefinition) -> str:
    """The column of a run's verdict on all requirements: ``verdict``, unless a metric is called so."""
    return "verdict(run)" if any(metric.name == "verdict" for metric in definition.metrics) else "verdict"


def _declared(definition: StudyDefinition) -> Iterator[tuple[str, str, bool]]:
    """Columns with the units they are shown in, and whether they are differences."""
    for figure in definition.figures:
        yield figure.current, figure.unit, False
    for variable in definition.variables:
        yield variable.name, variable.unit, False
    metrics = {metric.name: metric.unit for metric in definition.metrics}
    for metric in definition.metrics:
        yield metric.name, metric.unit, bool(metric.error_of)
        if not metric.error_of:
            yield f"{metric.name}{ERROR_BAR}", metric.unit, True
    sums: dict[str, str] = {}
    for configuration in definition.configurations:
        for name, total in configuration.totals.items():
            sums.setdefault(name, total.unit)
    for name, column in total_columns(definition).items():
        yield column, sums[name], False
    # A requirement may be written without a unit; its margin has that of its metric.
    for requirement in definition.requirements:
        yield f"{requirement.name}.margin", metrics[requirement.metric], True


def _scale(symbol: str, units: Units, is_difference: bool) -> Scale:
    unit = parse_unit(symbol)
    return Scale(str(unit), unit, is_difference) if units is Units.SHOWN else Scale(si_unit(symbol), coherent(unit))


def headed(names: Iterable[str], units: Mapping[str, str]) -> list[str]:
    """Headings of a table for people and spreadsheets: ``name [unit]``, or the name alone where there is no unit."""
    return [f"{name} [{units[name]}]" if units.get(name) else name for name in names]


def si_unit(symbol: str) -> str:
    """The coherent SI unit of the same dimension: ``m/s`` for ``km/h``, nothing for ``%``."""
    unit = coherent(parse_unit(symbol))
    # Of kWh the coherent unit is spelt kg.m2/s2, which nobody reads.
    named = (name for name in _NAMED if symbol != unit.symbol and parse_unit(name).dimension == unit.dimension)
    return next(named, str(unit))
