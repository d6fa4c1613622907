"""What a study was to find out, in words."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict

from dse.domain.definition import DefinedVariable, StudyDefinition
from dse.domain.method import PLAIN
from dse.report.content.insight import Asked
from dse.report.insight.naming import Naming
from dse.storage import RunTable
from dse.units import parse_unit


def question_of(table: RunTable, naming: Naming) -> Asked:
    """From the definition that is stored with the runs."""
    definition = table.header.definition
    constants = [each.constants for each in definition.configurations]
    varied = {variable.name for variable in definition.variables}
    names = sorted({name for each in constants for name in each} - varied)
    same = [name for name in names if len({each.get(name) for each in constants}) == 1]
    return Asked(
        tuple(_sentences(table, naming)),
        tuple(variable.role for variable in definition.variables),
        tuple(map(_spread, definition.variables)),
        tuple(metric.expression for metric in definition.metrics if not metric.error_of),
        tuple(requirement.exercised_when or "" for requirement in definition.requirements),
        tuple((name, constants[0][name]) for name in same),
        len(names) - len(same),
        max(table.header.runs - len(table), 0),
    )


def _sentences(table: RunTable, naming: Naming) -> Iterator[str]:
    definition, simulation = table.header.definition, table.header.definition.simulation
    bench = _titled(definition.bench.name, definition.bench.title)
    design = _titled(definition.design.name, definition.design.title)
    yield f"Bench {bench} on {_many(len(definition.configurations), 'configuration')} of the design space {design}."
    plain = asdict(PLAIN)
    method = "".join(
        f", {key} {value}" for key, value in simulation.method.items() if value and value != plain.get(key)
    )
    yield (
        f"Each run simulates {simulation.stop:g} s in steps of {simulation.step:g} s, "
        f"recorded every {simulation.record_every:g} s{method}."
    )
    for name, other in definition.other_simulations.items():
        yield f"On {name}, {other.stop:g} s in steps of {other.step:g} s, recorded every {other.record_every:g} s."
    yield _sampled(definition, naming)
    if definition.objectives:
        yield f"Wanted: {' and '.join(naming.objectives(definition))}."
    for name, expression in definition.derived.items():
        yield f"{name} follows as {expression}."
    for rule in definition.constraints:
        yield f"Only points with {rule} were asked for."
    for pair in definition.correlations:
        yield f"{naming.titled(pair.one)} and {naming.titled(pair.other)} are correlated by {pair.value:g}."


def _sampled(definition: StudyDefinition, naming: Naming) -> str:
    if not definition.variables:
        return "Each configuration was run once, at its nominal parameters."
    sampler = definition.sampler.kind.replace("_", " ")
    return f"Runs were chosen by {sampler}{_options(definition, naming)}; seed {definition.seed}."


def _options(definition: StudyDefinition, naming: Naming) -> str:
    slices = definition.sampler.slices
    if slices:
        planes = "; ".join(" × ".join(map(naming.titled, names)) for names in slices)
        return f", varying together {planes}, all else at its nominal value"
    plain = {key: value for key, value in definition.sampler.options.items() if isinstance(value, int | float | str)}
    said = {key: ("no", "yes")[value] if isinstance(value, bool) else value for key, value in plain.items()}
    return "".join(f", {key.replace('_', ' ')} {value}" for key, value in said.items())


def _spread(variable: DefinedVariable) -> str:
    unit = parse_unit(variable.unit)
    if variable.distribution:
        numbers = ", ".join(f"{key} {value:g}" for key, value in variable.distribution.numbers.items())
        return f"{variable.distribution.kind}{f' ({numbers}, SI)' if numbers else ''}"
    if variable.labels:
        return ", ".join(variable.labels)
    if variable.values:
        return "only " + ", ".join(f"{unit.from_si(value):g}" for value in variable.values)
    scale = "" if variable.scale == "linear" else f"{variable.scale} scale"
    levels = f"{variable.levels} levels" if variable.levels else ""
    return ", ".join(filter(None, (levels, scale))) or "any value"


def _titled(name: str, title: str) -> str:
    return f"{name} ({title})" if title and title != name else name


def _many(count: int, noun: str) -> str:
    return f"{count} {noun}{'s' * (count != 1)}"
