"""What the columns of a table of runs are called, and their units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from dse.domain.definition import StudyDefinition
from dse.domain.run import ERROR_BAR

_NAMED = ("N", "Pa", "J", "W", "V")


def choice_columns(definition: StudyDefinition) -> dict[str, str]:
    """The column of what is chosen at each place of the configurations, by path: ``sensor``.

    It is ``choice(sensor)`` where something that was varied or measured is called so.
    """
    order = {path: number for number, path in enumerate(definition.design.places)}
    paths = dict.fromkeys(path for configuration in definition.configurations for path in configuration.choices)
    taken = {"run", "configuration", "outcome", "problem", "check"}
    taken |= {variable.name for variable in definition.variables} | {metric.name for metric in definition.metrics}
    return {
        path: f"choice({path})" if path in taken else path
        for path in sorted(paths, key=lambda path: order.get(path, len(order)))
    }


def total_columns(definition: StudyDefinition) -> dict[str, str]:
    """The column of each sum of a property over a configuration, by the property's name: ``sum(cost)``."""
    names = dict.fromkeys(name for configuration in definition.configurations for name in configuration.totals)
    return {name: f"sum({name})" for name in names}


def units_of(definition: StudyDefinition) -> dict[str, str]:
    """The SI unit of each variable, metric, error bar, margin (``R1.margin``), sum and waveform of a figure, if any."""
    found = {entry.current: si_unit(entry.unit) for entry in definition.figures}
    found |= {variable.name: si_unit(variable.unit) for variable in definition.variables}
    found |= {metric.name: si_unit(metric.unit) for metric in definition.metrics}
    found |= {f"{metric.name}{ERROR_BAR}": found[metric.name] for metric in definition.metrics if not metric.error_of}
    sums = {
        name: total.unit for configuration in definition.configurations for name, total in configuration.totals.items()
    }
    found |= {column: si_unit(sums[name]) for name, column in total_columns(definition).items()}
    # A requirement may be written without a unit; its margin has that of its metric.
    return found | {f"{entry.name}.margin": found[entry.metric] for entry in definition.requirements}


def headed(names: Iterable[str], units: Mapping[str, str]) -> list[str]:
    """Headings of a table for people and spreadsheets: ``name [unit]``, or the name alone where there is no unit."""
    return [f"{name} [{units[name]}]" if units.get(name) else name for name in names]


def si_unit(symbol: str) -> str:
    """The coherent SI unit of the same dimension: ``m/s`` for ``km/h``, nothing for ``%``."""
    from dse.units import coherent, parse_unit

    unit = coherent(parse_unit(symbol))
    # Of kWh the coherent unit is spelt kg.m2/s2, which nobody reads.
    named = (name for name in _NAMED if symbol != unit.symbol and parse_unit(name).dimension == unit.dimension)
    return next(named, unit.symbol)
