"""What was studied, as it is stored with the results."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from fractions import Fraction
from itertools import chain
from pathlib import Path

from dse import __version__
from dse.domain.bench import Figure, Metric, Requirement, Simulation, TestBench
from dse.domain.definition import (
    DefinedAllocation,
    DefinedBench,
    DefinedConfiguration,
    DefinedCorrelation,
    DefinedDesign,
    DefinedDistribution,
    DefinedFigure,
    DefinedLoad,
    DefinedMetric,
    DefinedObjective,
    DefinedReplicates,
    DefinedRequirement,
    DefinedSampler,
    DefinedSimulation,
    DefinedTotal,
    DefinedVariable,
    Json,
    StudyDefinition,
)
from dse.domain.design import Allocation, Alternative, Compound, Configuration, DesignSpace, Node, Optional
from dse.domain.method import PLAIN
from dse.domain.run import ERROR_BAR
from dse.domain.sampler import DesignVariable, Grid, Role
from dse.domain.study import Study
from dse.domain.system import Element
from dse.errors import Location
from dse.space import alternatives, summed_properties
from dse.testbench.multi_bench import Prepared, singly
from dse.units import DIMENSIONLESS, OwnUnits, Unit


def define(study: Study, prepared: Mapping[str, Prepared], space: str = "") -> StudyDefinition:
    """The study as it is stored with its results.

    Of a sampler that proposes configurations *space* is what names the design space, and *prepared* is what there is.
    """
    bench, benches, draws = study.bench, study.benches, study.replicates
    figures = {figure.name: figure for bench in benches for figure in bench.figures}
    metrics = _metrics(study, prepared)
    defined = StudyDefinition(
        study=study.name,
        title=study.title or bench.title or study.name,
        bench=DefinedBench(" + ".join(b.name for b in benches), " + ".join(b.title for b in benches if b.title)),
        design=DefinedDesign(bench.design.name, bench.design.title, places(bench.design)),
        variables=tuple(_variable(variable) for variable in study.variables),
        sampler=DefinedSampler(study.sampler.name, study.sampler.options(), _grid(study, prepared.values())),
        seed=study.seed,
        metrics=metrics,
        requirements=tuple(_requirement(requirement, metrics, benches) for requirement in study.requirements),
        simulation=_simulation(bench.simulation),
        other_simulations={other.name: _simulation(other.simulation) for other in study.others},
        configurations=tuple(configuration_of(each, study) for each in prepared.values()),
        explored=() if space else tuple(prepared),
        space=space,
        figures=tuple(_figure(figure) for figure in figures.values()),
        fmus=fmus_of(prepared),
        ignored=_ignored(prepared),
        keep_waveforms=str(study.keep),
        dse=__version__,
        objectives=tuple(DefinedObjective(o.name, o.maximize, o.is_total, o.is_composite) for o in study.objectives),
        derived={each.name: each.expression.text for each in bench.derived},
        constraints=tuple(constraint.text for constraint in study.constraints),
        correlations=tuple(DefinedCorrelation(*pair, value) for pair, value in sorted(study.correlations.items())),
        replicates=DefinedReplicates(draws.at_least, draws.at_most, draws.confidence) if draws else None,
    )
    return replace(defined, units=_units(defined, bench.design.units))


def _units(definition: StudyDefinition, known: OwnUnits) -> OwnUnits:
    """Those of the *known* units that texts of *definition* may use."""
    texts = [*definition.derived.values(), *definition.constraints, *(each.name for each in definition.objectives)]
    texts += [each.expression for each in definition.metrics]
    texts += [each.exercised_when or "" for each in definition.requirements]
    words = set(re.findall(r"[^\W\d_]+", " ".join(texts)))
    return {name: symbol for name, symbol in sorted(known.items()) if name in words}


def places(space: DesignSpace) -> tuple[str, ...]:
    """The path of every decision, in the order of the file."""
    return tuple(alternatives(space))


def describe_configuration(
    configuration: Configuration, space: DesignSpace, also: Iterable[str] = ()
) -> DefinedConfiguration:
    """A configuration's choices, its components, and the sums its design space speaks of.

    These are the properties that a constraint adds up (``sum(cost) <= …``), and those asked for *also*: adding up
    others, a range or a field of view, would make no sense. Each is in the unit the first component gives it in.
    """
    totals: dict[str, DefinedTotal] = {}
    for name in dict.fromkeys((*summed_properties(space), *also)):
        given = [c.properties[name] for c in configuration.parts.values() if name in c.properties]
        if given:
            unit = given[0].unit
            value = (sum((quantity.si for quantity in given), Fraction(0)) - unit.offset) / unit.factor
            totals[name] = DefinedTotal(float(value), unit.symbol)
    components = {path: component.name for path, component in configuration.parts.items()}
    allocations = tuple(
        _allocated(configuration, path, allocation)
        for path, allocation in _allocations(space.root, "", configuration.choices)
    )
    return DefinedConfiguration(
        configuration.id, dict(configuration.choices), components, totals, allocations=allocations
    )


def _allocations(node: Node, path: str, choices: Mapping[str, str]) -> Iterator[tuple[str, Allocation]]:
    """The allocations below *node* that are there with *choices*, with their paths."""
    match node:
        case Compound(parts=parts, allocation=allocation):
            if allocation:
                yield path, allocation
            for name, part in parts.items():
                yield from _allocations(part, f"{path}.{name}" if path else name, choices)
        case Optional(content=content):
            if path in choices:
                yield from _allocations(content, path, choices)
        case Alternative(options=options):
            for option in options:
                if option.name == choices.get(path):
                    yield from _allocations(option, path, choices)


def _allocated(configuration: Configuration, place: str, allocation: Allocation) -> DefinedAllocation:
    """The *allocation* at *place* as *configuration* has it, loads in the unit of the first capacity."""
    before = place[: place.rfind(".") + 1]
    hosts = {
        host: [part for at, part in configuration.parts.items() if f"{at}.".startswith(f"{before}{path}.")]
        for host, path in allocation.hosts.items()
    }
    hosts = {host: parts for host, parts in hosts.items() if parts}
    on: dict[str, tuple[str, ...]] = {}
    for function, host, path, name in allocation.pairs:
        found = configuration.choices.get(f"{place}.{path}")
        if found and name in ("", found):
            on[function] = (*on.get(function, ()), host)
    loads = []
    for load, capacity in allocation.loads:
        amounts = {
            function: allocation.stated[function][load]
            if function in allocation.stated
            else configuration.parts[f"{before}{allocation.functions[function]}"].properties[load]
            for function in on
        }
        given = {
            host: [p.properties[capacity] for p in parts if capacity in p.properties] for host, parts in hosts.items()
        }
        unit = next((q.unit for q in (*chain(*given.values()), *amounts.values())), DIMENSIONLESS)
        loads.append(
            DefinedLoad(
                load,
                capacity,
                str(unit),
                {function: float(amount.si / unit.factor) for function, amount in amounts.items()},
                {host: float(sum((q.si for q in some), Fraction(0)) / unit.factor) for host, some in given.items()},
            )
        )
    return DefinedAllocation(place, tuple(hosts), tuple(on), on, tuple(loads))


def _variable(variable: DesignVariable) -> DefinedVariable:
    given = variable.distribution
    return DefinedVariable(
        variable.name,
        variable.title,
        variable.unit.symbol,
        variable.low,
        variable.high,
        variable.levels,
        variable.nominal,
        str(variable.scale),
        variable.values,
        str(variable.role),
        DefinedDistribution(given.kind, dict(given.numbers), given.values) if given else None,
        variable.labels,
        variable.weights,
    )


def _grid(study: Study, prepared: Iterable[Prepared]) -> Grid | None:
    """The sampler's grid, each slice at every condition; none where points of it are missing, or not everywhere."""
    grid, names = study.sampler.grid, {variable.name for variable in study.sampled}
    if grid is None or study.constraints or not all(names <= each.settings.keys() for each in prepared):
        return None
    conditions = tuple(variable.name for variable in study.variables if variable.role is Role.CONDITION)
    return tuple((*slice_, *conditions) for slice_ in grid)


def configuration_of(prepared: Prepared, study: Study) -> DefinedConfiguration:
    """A configuration of *study* as it is stored: parts of the second bench and later ones as ``NAME/part``."""
    benches = singly(prepared)
    before = ["", *(f"{bench.name}/" for bench in study.others)]
    elements = {f"{at}{e.name}": e for at, b in zip(before, benches, strict=True) for e in b.system.elements}
    wires = [
        f"{at}{w.source}.{w.source_variable} -> {w.target}.{w.target_variable}"
        for at, bench in zip(before, benches, strict=True)
        for w in bench.system.wires
    ]
    totals = [name for objective in study.objectives for name in objective.totals]
    return replace(
        describe_configuration(prepared.configuration, study.bench.design, totals),
        start={name: dict(sorted(element.start.items())) for name, element in elements.items()},
        inside={name: _inside(e) for name, e in elements.items() if e.texts or e.conversions},
        wires=tuple(wires),
        columns=tuple(dict.fromkeys(name for bench in benches for name in bench.recording.columns)),
        constants=dict(sorted(prepared.constants.items())),
        streams=tuple(f"{at}{s.name}" for at, bench in zip(before, benches, strict=True) for s in bench.streams),
    )


def _inside(element: Element) -> Json:
    """Texts an element is given, and how its numbers are converted."""
    conversions = {name: asdict(conversion) for name, conversion in sorted(element.conversions.items())}
    texts = {name: text.hex() if isinstance(text, bytes) else text for name, text in sorted(element.texts.items())}
    return _plain({"texts": texts, "conversions": conversions})


def _plain(data: object) -> Json:
    """*data* as it comes back from where it is stored."""
    return json.loads(json.dumps(data))


def fmus_of(prepared: Mapping[str, Prepared]) -> dict[str, str]:
    """Content hashes of the FMUs of *prepared*, by their names."""
    return dict(sorted({e.model.identifier: e.model.content_hash for e in _elements(prepared)}.items()))


def _elements(prepared: Mapping[str, Prepared]) -> Iterator[Element]:
    return (e for each in prepared.values() for bench in singly(each) for e in bench.system.elements)


def _ignored(prepared: Mapping[str, Prepared]) -> tuple[str, ...]:
    """What was passed over, in files named from the archive on: where that lies is no matter of the study."""
    models = {e.model.archive: e.model for e in _elements(prepared) if e.model.ignored}
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


def _simulation(simulation: Simulation) -> DefinedSimulation:
    return DefinedSimulation(simulation.stop, simulation.step, simulation.record_every, _method(simulation))


def _method(simulation: Simulation) -> Json:
    """What is not plain about the algorithm and what FMUs are told of it; nothing if all is."""
    told = {} if simulation.tolerance is None else {"fmu_tolerance": simulation.tolerance}
    return _plain(told if simulation.method == PLAIN else asdict(simulation.method) | told)


def _metrics(study: Study, prepared: Mapping[str, Prepared]) -> tuple[DefinedMetric, ...]:
    written = {metric.name: _written(metric.name, study.benches) for metric in study.metrics}
    metrics = tuple(_metric(metric, written[metric.name], study.requirements, prepared) for metric in study.metrics)
    if not study.bench.simulation.check_step:
        return metrics
    bars = (replace(m, name=f"{m.name}{ERROR_BAR}", title=f"{m.title}, error bar", error_of=m.name) for m in metrics)
    return (*metrics, *bars)


def _written(name: str, benches: Sequence[TestBench]) -> str:
    """The expression of a metric; where benches differ in it, or some do not have it, each one's."""
    texts = {bench.name: metric.text for bench in benches for metric in bench.metrics if metric.name == name}
    if len(set(texts.values())) == 1 and len(texts) == len(benches):
        return texts[benches[0].name]
    return "; ".join(f"{bench}: {text}" for bench, text in texts.items())


def _metric(
    metric: Metric, written: str, requirements: tuple[Requirement, ...], prepared: Mapping[str, Prepared]
) -> DefinedMetric:
    # A metric without a unit of its own is shown in the unit its requirement speaks, else in SI.
    unit: Unit = metric.unit
    if not unit.symbol:
        unit = next((r.unit for r in requirements if r.metric == metric.name and r.unit.symbol), unit)
    if not unit.symbol and prepared:
        benches = singly(next(iter(prepared.values())))
        unit = next(b.program.units[metric.name] for b in benches if metric.name in b.program.units)
    title = metric.title or metric.name.replace("_", " ")
    return DefinedMetric(metric.name, title, unit.symbol, written)


def _requirement(
    requirement: Requirement, metrics: Sequence[DefinedMetric], benches: Sequence[TestBench]
) -> DefinedRequirement:
    # Bounds and margins are shown in the unit of the values they are compared with.
    unit = next(metric.unit for metric in metrics if metric.name == requirement.metric)
    on = tuple(bench.name for bench in benches if any(one.name == requirement.name for one in bench.requirements))
    return DefinedRequirement(
        requirement.name,
        requirement.title or requirement.name,
        requirement.metric,
        unit,
        requirement.at_most,
        requirement.at_least,
        requirement.exercised_when.text if requirement.exercised_when else None,
        requirement.met_in,
        () if len(on) == len(benches) else on,
        **asdict(requirement.trace),
    )


def _figure(figure: Figure) -> DefinedFigure:
    title = figure.title or figure.name.replace("_", " ")
    return DefinedFigure(figure.name, title, figure.unit.symbol, figure.current, figure.target)
