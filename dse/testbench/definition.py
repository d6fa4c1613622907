"""What was studied, as it is stored with the results."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, replace
from fractions import Fraction
from pathlib import Path

from dse import __version__
from dse.domain.bench import Figure, Metric, Requirement, Simulation, TestBench
from dse.domain.definition import (
    DefinedBench,
    DefinedConfiguration,
    DefinedDesign,
    DefinedFigure,
    DefinedMetric,
    DefinedRequirement,
    DefinedSampler,
    DefinedSimulation,
    DefinedTotal,
    DefinedVariable,
    Json,
    StudyDefinition,
)
from dse.domain.design import Configuration, DesignSpace
from dse.domain.method import PLAIN
from dse.domain.run import ERROR_BAR
from dse.domain.study import Study
from dse.domain.system import Element
from dse.errors import Location
from dse.space import alternatives, summed_properties
from dse.testbench.prepared import PreparedBench
from dse.units import Unit


def define(study: Study, prepared: Mapping[str, PreparedBench]) -> StudyDefinition:
    """The study as it is stored with its results."""
    bench, simulation = study.bench, study.bench.simulation
    return StudyDefinition(
        study=study.name,
        title=study.title or bench.title or study.name,
        bench=DefinedBench(bench.name, bench.title),
        design=DefinedDesign(bench.design.name, bench.design.title, places(bench.design)),
        variables=tuple(
            DefinedVariable(v.name, v.title, v.unit.symbol, v.low, v.high, v.levels, v.nominal) for v in study.variables
        ),
        sampler=DefinedSampler(study.sampler.name, study.sampler.options(), study.sampler.grid),
        seed=study.seed,
        metrics=_metrics(bench, prepared),
        requirements=tuple(_requirement(requirement) for requirement in bench.requirements),
        simulation=DefinedSimulation(simulation.stop, simulation.step, simulation.record_every, _method(simulation)),
        configurations=tuple(_configuration(p, bench.design) for p in prepared.values()),
        explored=tuple(prepared),
        figures=tuple(_figure(figure) for figure in bench.figures),
        fmus=_fmus(prepared),
        ignored=_ignored(prepared),
        keep_waveforms=str(study.keep),
        dse=__version__,
    )


def places(space: DesignSpace) -> tuple[str, ...]:
    """The path of every decision, in the order of the file."""
    return tuple(alternatives(space))


def describe_configuration(configuration: Configuration, space: DesignSpace) -> DefinedConfiguration:
    """A configuration's choices, its components, and the sums its design space speaks of.

    These are the properties that a constraint adds up (``sum(cost) <= …``): adding up others, a range or a field of
    view, would make no sense. Each is in the unit the first component gives it in.
    """
    totals: dict[str, DefinedTotal] = {}
    for name in summed_properties(space):
        given = [c.properties[name] for c in configuration.parts.values() if name in c.properties]
        if given:
            unit = given[0].unit
            value = (sum((quantity.si for quantity in given), Fraction(0)) - unit.offset) / unit.factor
            totals[name] = DefinedTotal(float(value), unit.symbol)
    components = {path: component.name for path, component in configuration.parts.items()}
    return DefinedConfiguration(configuration.id, dict(configuration.choices), components, totals)


def _configuration(prepared: PreparedBench, space: DesignSpace) -> DefinedConfiguration:
    elements = prepared.system.elements
    return replace(
        describe_configuration(prepared.configuration, space),
        start={element.name: dict(sorted(element.start.items())) for element in elements},
        inside={e.name: _inside(e) for e in elements if e.texts or e.conversions},
        wires=tuple(f"{w.source}.{w.source_variable} -> {w.target}.{w.target_variable}" for w in prepared.system.wires),
        columns=prepared.recording.columns,
        constants=dict(sorted(prepared.constants.items())),
    )


def _inside(element: Element) -> Json:
    """Texts an element is given, and how its numbers are converted."""
    conversions = {name: asdict(conversion) for name, conversion in sorted(element.conversions.items())}
    texts = {name: text.hex() if isinstance(text, bytes) else text for name, text in sorted(element.texts.items())}
    return _plain({"texts": texts, "conversions": conversions})


def _plain(data: object) -> Json:
    """*data* as it comes back from where it is stored."""
    return json.loads(json.dumps(data))


def _fmus(prepared: Mapping[str, PreparedBench]) -> dict[str, str]:
    return dict(
        sorted({e.model.identifier: e.model.content_hash for p in prepared.values() for e in p.system.elements}.items())
    )


def _ignored(prepared: Mapping[str, PreparedBench]) -> tuple[str, ...]:
    """What was passed over, in files named from the archive on: where that lies is no matter of the study."""
    models = {e.model.archive: e.model for p in prepared.values() for e in p.system.elements if e.model.ignored}
    found = {
        str(replace(problem, where=problem.where and _inside_archive(problem.where, archive)))
        for archive, model in models.items()
        for problem in model.ignored
    }
    return tuple(sorted(found))


def _inside_archive(where: Location, archive: Path) -> Location:
    """*where* with its file as ``supplier.fmu/modelDescription.xml``."""
    _, name, inner = where.file.rpartition(archive.name)
    return replace(where, file=f"{name}{inner}")


def _method(simulation: Simulation) -> Json:
    """What is not plain about the algorithm and what FMUs are told of it; nothing if all is."""
    told = {} if simulation.tolerance is None else {"fmu_tolerance": simulation.tolerance}
    return _plain(told if simulation.method == PLAIN else asdict(simulation.method) | told)


def _metrics(bench: TestBench, prepared: Mapping[str, PreparedBench]) -> tuple[DefinedMetric, ...]:
    metrics = tuple(_metric(metric, bench.requirements, prepared) for metric in bench.metrics)
    if not bench.simulation.check_step:
        return metrics
    bars = (replace(m, name=f"{m.name}{ERROR_BAR}", title=f"{m.title}, error bar", error_of=m.name) for m in metrics)
    return (*metrics, *bars)


def _metric(
    metric: Metric, requirements: tuple[Requirement, ...], prepared: Mapping[str, PreparedBench]
) -> DefinedMetric:
    # A metric without a unit of its own is shown in the unit its requirement speaks, else in SI.
    unit: Unit = metric.unit
    if not unit.symbol:
        unit = next((r.unit for r in requirements if r.metric == metric.name and r.unit.symbol), unit)
    if not unit.symbol and prepared:
        unit = next(iter(prepared.values())).program.units[metric.name]
    title = metric.title or metric.name.replace("_", " ")
    return DefinedMetric(metric.name, title, unit.symbol, metric.expression.text)


def _requirement(requirement: Requirement) -> DefinedRequirement:
    return DefinedRequirement(
        requirement.name,
        requirement.title or requirement.name,
        requirement.metric,
        requirement.unit.symbol,
        requirement.at_most,
        requirement.at_least,
        requirement.exercised_when.text if requirement.exercised_when else None,
    )


def _figure(figure: Figure) -> DefinedFigure:
    title = figure.title or figure.name.replace("_", " ")
    return DefinedFigure(figure.name, title, figure.unit.symbol, figure.current, figure.target)
