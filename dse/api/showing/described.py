"""What a study's definition says, in words and units for showing."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.api.showing.quantities import checked_quantity, difference, quantity

if TYPE_CHECKING:
    from dse.domain.definition import DefinedRequirement, StudyDefinition
    from dse.domain.run import Run

_NAMED = ("N", "Pa", "J", "W", "V")


@dataclass(frozen=True, slots=True)
class MetricRow:
    """A metric, with a requirement on it if there is one, as texts. A metric's further requirements have rows without
    *title* and *value*."""

    title: str
    value: str
    requirement: str = ""
    bound: str = ""
    margin: str = ""
    verdict: str = ""


def metric_rows(run: Run, definition: StudyDefinition) -> Iterator[MetricRow]:
    """Every metric in its unit, with its error bar if it was checked, and the requirements on it."""
    from dse.domain.run import ERROR_BAR

    for metric in definition.metrics:
        if metric.error_of:
            continue
        name = metric.name
        value = checked_quantity(run.metrics.get(name, math.nan), run.metrics.get(name + ERROR_BAR), metric.unit)
        requirements = [entry for entry in definition.requirements if entry.metric == name]
        if not requirements:
            yield MetricRow(metric.title, value)
        for number, requirement in enumerate(requirements):
            title, shown = ("", "") if number else (metric.title, value)
            yield MetricRow(title, shown, requirement.name, _bound(requirement), *_judged(run, requirement))


def requirement_labels(definition: StudyDefinition) -> Mapping[str, str]:
    """The requirements by name, each with its title if it has another."""
    named = {entry.name: entry.title for entry in definition.requirements}
    return {name: name if name == words else f"{name} {words}" for name, words in named.items()}


def units(definition: StudyDefinition) -> dict[str, str]:
    """The SI unit of each design variable, metric and margin (``R1.margin``), and of waveforms in figures."""
    found = {entry.current: si_unit(entry.unit) for entry in definition.figures}
    found |= {variable.name: si_unit(variable.unit) for variable in definition.variables}
    found |= {metric.name: si_unit(metric.unit) for metric in definition.metrics}
    # A requirement may be written without a unit; its margin has that of its metric.
    return found | {f"{entry.name}.margin": found[entry.metric] for entry in definition.requirements}


def si_unit(symbol: str) -> str:
    """The coherent SI unit of the same dimension: ``m/s`` for ``km/h``, nothing for ``%``."""
    from dse.units import coherent, parse_unit

    unit = coherent(parse_unit(symbol))
    # Of kWh the coherent unit is spelt kg.m2/s2, which nobody reads.
    named = (name for name in _NAMED if symbol != unit.symbol and parse_unit(name).dimension == unit.dimension)
    return next(named, unit.symbol)


def _bound(requirement: DefinedRequirement) -> str:
    bounds = ((requirement.at_most, "≤"), (requirement.at_least, "≥"))
    return ", ".join(f"{sign} {quantity(bound, requirement.unit)}" for bound, sign in bounds if bound is not None)


def _judged(run: Run, requirement: DefinedRequirement) -> tuple[str, str]:
    judgement = next(entry for entry in run.judgements if entry.requirement == requirement.name)
    return difference(judgement.margin, requirement.unit), str(judgement.verdict)
