"""What a study's definition says, for showing; the one module of this room that knows its keys."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from dse.api.quantities import checked_quantity, difference, quantity

if TYPE_CHECKING:
    from dse.domain.run import Run

Definition = Mapping[str, Any]

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


def metric_rows(run: Run, definition: Definition) -> Iterator[MetricRow]:
    """Every metric in its unit, with its error bar if it was checked, and the requirements on it."""
    from dse.domain.run import ERROR_BAR

    for metric in definition["metrics"]:
        if "error_of" in metric:
            continue
        name = metric["name"]
        value = checked_quantity(run.metrics.get(name, math.nan), run.metrics.get(name + ERROR_BAR), metric["unit"])
        requirements = [entry for entry in definition["requirements"] if entry["metric"] == name]
        if not requirements:
            yield MetricRow(metric["title"], value)
        for number, requirement in enumerate(requirements):
            title_, shown = ("", "") if number else (metric["title"], value)
            yield MetricRow(title_, shown, requirement["name"], _bound(requirement), *_judged(run, requirement))


def has_requirements(definition: Definition) -> bool:
    """Whether the study has any."""
    return bool(definition["requirements"])


def title(definition: Definition) -> str:
    """The title of the study."""
    return str(definition["title"])


def choices(definition: Definition, configuration: str) -> Mapping[str, str]:
    """What is chosen where in the configuration with this id."""
    (found,) = [entry for entry in definition["configurations"] if entry["id"] == configuration]
    chosen: Mapping[str, str] = found["choices"]
    return chosen


def labels(definition: Definition) -> Mapping[str, str]:
    """The requirements by name, each with its title if it has another."""
    named = {entry["name"]: entry["title"] for entry in definition["requirements"]}
    return {name: name if name == words else f"{name} {words}" for name, words in named.items()}


def origin(definition: Definition) -> tuple[str, bool]:
    """The name of the file the study came from, and whether that is a test bench."""
    is_bench = not definition["variables"]
    return (definition["bench"]["name"] if is_bench else definition["study"]), is_bench


def units(definition: Definition) -> dict[str, str]:
    """The SI unit of each design variable, metric and margin (``R1.margin``), and of waveforms in figures."""
    found: dict[str, str] = {}
    for section, key, suffix in (
        ("figures", "current", ""),
        ("variables", "name", ""),
        ("metrics", "name", ""),
        ("requirements", "name", ".margin"),
    ):
        found |= {entry[key] + suffix: si_unit(entry["unit"]) for entry in definition[section]}
    # A requirement may be written without a unit; its margin has that of its metric.
    return found | {f"{entry['name']}.margin": found[entry["metric"]] for entry in definition["requirements"]}


def si_unit(symbol: str) -> str:
    """The coherent SI unit of the same dimension: ``m/s`` for ``km/h``, nothing for ``%``."""
    from dse.units import coherent, parse_unit

    unit = coherent(parse_unit(symbol))
    # Of kWh the coherent unit is spelt kg.m2/s2, which nobody reads.
    named = (name for name in _NAMED if symbol != unit.symbol and parse_unit(name).dimension == unit.dimension)
    return next(named, unit.symbol)


def _bound(requirement: Mapping[str, Any]) -> str:
    bounds = (("at_most", "≤"), ("at_least", "≥"))
    return ", ".join(
        f"{sign} {quantity(requirement[key], requirement['unit'])}"
        for key, sign in bounds
        if requirement[key] is not None
    )


def _judged(run: Run, requirement: Mapping[str, Any]) -> tuple[str, str]:
    judgement = next(entry for entry in run.judgements if entry.requirement == requirement["name"])
    return difference(judgement.margin, requirement["unit"]), str(judgement.verdict)
