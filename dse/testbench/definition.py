"""What was studied, as plain data for the study folder: enough to show every result without the workspace."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from dse import __version__
from dse.domain.bench import Figure, Metric, Requirement
from dse.domain.design import Configuration
from dse.domain.study import FullFactorial, LatinHypercube, Sampler, Study
from dse.testbench.prepared import PreparedBench
from dse.units import Unit


def define(study: Study, prepared: Mapping[str, PreparedBench]) -> dict[str, Any]:
    """The study as JSON data; values are SI, units are given beside them by symbol. No path and no clock."""
    bench, simulation = study.bench, study.bench.simulation
    return {
        "format": 1,
        "dse": __version__,
        "study": study.name,
        "title": study.title or bench.title or study.name,
        "bench": {"name": bench.name, "title": bench.title},
        "design": {"name": bench.design.name, "title": bench.design.title},
        "variables": [
            {
                "name": v.name,
                "title": v.title,
                "unit": v.unit.symbol,
                "low": v.low,
                "high": v.high,
                "levels": v.levels,
                "nominal": v.nominal,
            }
            for v in study.variables
        ],
        "sampler": _sampler(study.sampler),
        "keep_waveforms": str(study.keep),
        "seed": study.seed,
        "metrics": [_metric(metric, bench.requirements, prepared) for metric in bench.metrics],
        "requirements": [_requirement(requirement) for requirement in bench.requirements],
        "figures": [_figure(figure) for figure in bench.figures],
        "simulation": {
            "stop": simulation.stop,
            "step": simulation.step,
            "record_every": simulation.record_every,
            "steps": simulation.steps,
        },
        "configurations": [_configuration(p) for p in prepared.values()],
        "fmus": _fmus(prepared),
    }


def fingerprint(definition: Mapping[str, Any]) -> str:
    """SHA-256 of the definition in canonical JSON: studies with equal fingerprints give equal numbers.

    Which waveforms are kept does not matter: they can be added to a study later.
    """
    decisive = {key: value for key, value in definition.items() if key != "keep_waveforms"}
    text = json.dumps(decisive, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def describe_configuration(configuration: Configuration) -> dict[str, Any]:
    """A configuration's choices, components and summed properties (in the unit the component gives)."""
    totals: dict[str, float] = {}
    units: dict[str, str] = {}
    for component in configuration.parts.values():
        for name, quantity in component.properties.items():
            unit = units.setdefault(name, quantity.unit.symbol)
            if unit == quantity.unit.symbol:
                totals[name] = totals.get(name, 0.0) + float(quantity.magnitude)
            else:
                totals[name] = totals.get(name, 0.0) + _in_unit(float(quantity), unit)
    return {
        "id": configuration.id,
        "choices": dict(configuration.choices),
        "components": {path: component.name for path, component in configuration.parts.items()},
        "totals": {name: {"value": value, "unit": units[name]} for name, value in sorted(totals.items())},
    }


def _in_unit(value: float, symbol: str) -> float:
    from dse.units import parse_unit

    return parse_unit(symbol).from_si(value)


def _configuration(prepared: PreparedBench) -> dict[str, Any]:
    elements = {element.name: sorted(element.start.items()) for element in prepared.system.elements}
    wires = [f"{w.source}.{w.source_variable} -> {w.target}.{w.target_variable}" for w in prepared.system.wires]
    return {
        **describe_configuration(prepared.configuration),
        "start": elements,
        "wires": wires,
        "columns": list(prepared.columns),
        "constants": dict(sorted(prepared.constants.items())),
    }


def _fmus(prepared: Mapping[str, PreparedBench]) -> dict[str, str]:
    return dict(
        sorted({e.model.identifier: e.model.content_hash for p in prepared.values() for e in p.system.elements}.items())
    )


def _sampler(sampler: Sampler) -> dict[str, Any]:
    match sampler:
        case FullFactorial():
            return {"kind": "full_factorial", "slices": [list(entry) for entry in sampler.slices]}
        case LatinHypercube():
            return {"kind": "latin_hypercube", "samples": sampler.samples}


def _metric(
    metric: Metric, requirements: tuple[Requirement, ...], prepared: Mapping[str, PreparedBench]
) -> dict[str, Any]:
    # A metric without a unit of its own is shown in the unit its requirement speaks, else in SI.
    unit: Unit = metric.unit
    if not unit.symbol:
        unit = next((r.unit for r in requirements if r.metric == metric.name and r.unit.symbol), unit)
    if not unit.symbol and prepared:
        unit = next(iter(prepared.values())).program.units[metric.name]
    return {
        "name": metric.name,
        "title": metric.title or metric.name.replace("_", " "),
        "expression": metric.expression.text,
        "unit": unit.symbol,
    }


def _requirement(requirement: Requirement) -> dict[str, Any]:
    return {
        "name": requirement.name,
        "title": requirement.title or requirement.name,
        "metric": requirement.metric,
        "at_most": requirement.at_most,
        "at_least": requirement.at_least,
        "unit": requirement.unit.symbol,
        "exercised_when": requirement.exercised_when.text if requirement.exercised_when else None,
    }


def _figure(figure: Figure) -> dict[str, Any]:
    return {
        "name": figure.name,
        "title": figure.title or figure.name.replace("_", " "),
        "current": figure.current,
        "target": figure.target,
        "unit": figure.unit.symbol,
    }
