"""What was studied, as plain data for the study folder: enough to show every result without the workspace."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict
from fractions import Fraction
from typing import Any

from dse import __version__
from dse.domain.bench import Figure, Metric, Requirement, Simulation, TestBench
from dse.domain.design import Configuration, DesignSpace
from dse.domain.method import PLAIN
from dse.domain.run import ERROR_BAR
from dse.domain.study import FullFactorial, LatinHypercube, Sampler, Study
from dse.domain.system import Element
from dse.space.decisions import decisions, flat
from dse.space.output.totals import summed_properties
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
        "design": {"name": bench.design.name, "title": bench.design.title, "places": list(places(bench.design))},
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
        "metrics": _metrics(bench, prepared),
        "requirements": [_requirement(requirement) for requirement in bench.requirements],
        "figures": [_figure(figure) for figure in bench.figures],
        "simulation": {
            "stop": simulation.stop,
            "step": simulation.step,
            "record_every": simulation.record_every,
            "steps": simulation.steps,
            **_method(simulation),
        },
        "configurations": [_configuration(p, bench.design) for p in prepared.values()],
        "fmus": _fmus(prepared),
    }


def places(space: DesignSpace) -> tuple[str, ...]:
    """The path of every decision, in the order of the file."""
    return tuple(dict.fromkeys(decision.path for decision in flat(decisions(space))))


def fingerprint(definition: Mapping[str, Any]) -> str:
    """SHA-256 of the definition in canonical JSON: studies with equal fingerprints give equal numbers.

    Which waveforms are kept does not matter: they can be added to a study later.
    """
    decisive = {key: value for key, value in definition.items() if key != "keep_waveforms"}
    text = json.dumps(decisive, sort_keys=True, separators=(",", ":"), ensure_ascii=False)
    return hashlib.sha256(text.encode()).hexdigest()


def describe_configuration(configuration: Configuration, space: DesignSpace) -> dict[str, Any]:
    """A configuration's choices, its components, and the sums its design space speaks of.

    These are the properties that a constraint adds up (``sum(cost) <= …``): adding up others, a range or a field of
    view, would make no sense. Each is in the unit the first component gives it in.
    """
    totals: dict[str, dict[str, Any]] = {}
    for name in summed_properties(space):
        given = [c.properties[name] for c in configuration.parts.values() if name in c.properties]
        if given:
            unit = given[0].unit
            value = (sum((quantity.si for quantity in given), Fraction(0)) - unit.offset) / unit.factor
            totals[name] = {"value": float(value), "unit": unit.symbol}
    return {
        "id": configuration.id,
        "choices": dict(configuration.choices),
        "components": {path: component.name for path, component in configuration.parts.items()},
        "totals": totals,
    }


def _configuration(prepared: PreparedBench, space: DesignSpace) -> dict[str, Any]:
    elements = {element.name: sorted(element.start.items()) for element in prepared.system.elements}
    wires = [f"{w.source}.{w.source_variable} -> {w.target}.{w.target_variable}" for w in prepared.system.wires]
    inside = {e.name: _inside(e) for e in prepared.system.elements if e.texts or e.conversions}
    return {
        **describe_configuration(prepared.configuration, space),
        "start": elements,
        **({"inside": inside} if inside else {}),
        "wires": wires,
        "columns": list(prepared.columns),
        "constants": dict(sorted(prepared.constants.items())),
    }


def _inside(element: Element) -> dict[str, Any]:
    """Texts an element is given, and how its numbers are converted."""
    conversions = {name: asdict(conversion) for name, conversion in sorted(element.conversions.items())}
    return {"texts": dict(sorted(element.texts.items())), "conversions": conversions}


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


def _method(simulation: Simulation) -> dict[str, Any]:
    """What is not plain about the algorithm; nothing if all is."""
    return {} if simulation.method == PLAIN else {"method": asdict(simulation.method)}


def _metrics(bench: TestBench, prepared: Mapping[str, PreparedBench]) -> list[dict[str, Any]]:
    metrics = [_metric(metric, bench.requirements, prepared) for metric in bench.metrics]
    if not bench.simulation.check_step:
        return metrics
    bars = [
        {
            **metric,
            "name": f"{metric['name']}{ERROR_BAR}",
            "title": f"{metric['title']}, error bar",
            "error_of": metric["name"],
        }
        for metric in metrics
    ]
    return [*metrics, *bars]


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
