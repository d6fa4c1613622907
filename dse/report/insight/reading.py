"""A study folder → its insight: everything is bounded, and what cannot be told is named with its reason."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np

from dse.analysis import (
    Ranking,
    Standing,
    drawn,
    essentials,
    objectives_of,
    planes,
    ranked,
    slack_of_runs,
    stages,
    unit_of_objective,
)
from dse.domain.definition import DefinedVariable, StudyDefinition
from dse.domain.method import PLAIN
from dse.errors import DseError
from dse.report.content.data import Floats, ReportContent
from dse.report.content.insight import Asked, Insight, Pick, SearchCourse, Stage
from dse.report.content.reading import MAX_WAVEFORMS, read_content
from dse.report.insight.findings import boxes_of, centres_of, insight_findings
from dse.report.insight.naming import Naming
from dse.report.insight.probability_maps import chances_of
from dse.report.insight.responses import part_of
from dse.report.insight.sample import part_of_table
from dse.storage import RunTable, StudyFolder, over_draws
from dse.units import parse_unit, short_symbol

MOST_RUNS = 20_000
"""Of more runs, findings are told of so many drawn from them, and the page says so."""


def read_report(path: Path, most: int = MAX_WAVEFORMS) -> ReportContent:
    """All that a page shows of the study at *path*: `read_content`, and what its runs tell."""
    return replace(read_content(path, most), insight=read_insight(path))


def read_insight(path: Path) -> Insight:
    """What the study at *path* asked and what its runs tell. DseError if the folder is damaged."""
    with StudyFolder.open(path) as folder:
        folder.require_definition()
        return insight_of(over_draws(folder.table()))


def insight_of(table: RunTable) -> Insight:
    """The same of a table; equal tables give equal insights."""
    import scipy.linalg  # noqa: F401  # loads its own library, which is limited only once it is there
    from threadpoolctl import threadpool_limits

    # Sums then come in the same order on any number of processors; systems this small are no faster on more.
    with threadpool_limits(limits=1, user_api="blas"):
        return _insight(table)


def _insight(table: RunTable) -> Insight:
    naming = Naming(table.header.definition)
    asked = question_of(table, naming)
    if not len(table):
        return Insight(asked)
    every = np.arange(len(table))
    looked = table if len(table) <= MOST_RUNS else part_of_table(table, drawn(every, MOST_RUNS))
    parts = planes(looked)
    findings = essentials(looked, parts)
    chances, around, withheld = chances_of(looked, parts, naming)
    search, reasons = search_of(table, naming)
    return Insight(
        asked,
        insight_findings(findings, naming),
        tuple(box for data in parts for box in boxes_of(data, findings, naming)),
        tuple(centre for data in parts for centre in centres_of(data, naming)),
        tuple(part_of(data, naming) for data in parts if len(data)),
        chances,
        around,
        search,
        (*withheld, *reasons),
        len(looked) if looked is not table else 0,
    )


# What came of the objectives: the best designs, and how the search came to them.


_MOST_PICKS = 40
_MOST_RUNS = 20_000
_STAGES = 20


def search_of(table: RunTable, naming: Naming) -> tuple[SearchCourse | None, tuple[str, ...]]:
    """None for a study without objectives, or where they cannot be ranked: with the reason."""
    definition = table.header.definition
    objectives = objectives_of(definition, (), ())
    if not objectives:
        return None, ()
    if len(table) > _MOST_RUNS:
        return None, (f"best designs: of more than {_MOST_RUNS} runs 'dse best' computes them, which takes a while",)
    try:
        # Of one objective all feasible designs, to tell when each became the best one.
        ranking = ranked(table, objectives, len(table))
    except DseError as error:
        return None, (f"best designs: {error.problems[0].what}",)
    units = tuple(unit_of_objective(definition, each) for each in objectives)
    least = slack_of_runs(table)
    return SearchCourse(
        tuple(naming.objectives(definition)),
        tuple(map(short_symbol, units)),
        tuple(_pick(each, table, least, naming, units) for each in ranking.best[:_MOST_PICKS]),
        -1 if ranking.knee is None or ranking.knee >= _MOST_PICKS else ranking.knee,
        ranking.designs,
        ranking.feasible,
        ranking.open,
        _stages(table, ranking, definition),
    ), ()


def _pick(standing: Standing, table: RunTable, least: Floats, naming: Naming, units: tuple[str, ...]) -> Pick:
    values = zip(standing.values, units, strict=True)
    rows = np.searchsorted(table.numbers, standing.runs)
    return Pick(
        standing.runs[int(np.argmin(least[rows]))],
        naming.configurations[standing.configuration],
        tuple(parse_unit(unit).from_si(value) for value, unit in values),
    )


def _stages(table: RunTable, ranking: Ranking, definition: StudyDefinition) -> tuple[Stage, ...]:
    ends = [int(table.numbers[row]) + 1 for row in np.linspace(0, len(table) - 1, _STAGES + 1)[1:].astype(int)]
    found = stages(table, ranking.objectives, ends)
    best = _best_by(ranking, ends, definition)
    return tuple(Stage(each.runs, each.feasible, each.volume, value) for each, value in zip(found, best, strict=True))


def _best_by(ranking: Ranking, ends: list[int], definition: StudyDefinition) -> list[float]:
    """Of one objective the best feasible value by each of *ends*, NaN before there is one, of several NaN."""
    if len(ranking.objectives) > 1:
        return [float("nan")] * len(ends)
    objective = ranking.objectives[0]
    unit = parse_unit(unit_of_objective(definition, objective))
    sign = -1.0 if objective.maximize else 1.0
    made = [(max(each.runs), sign * each.values[0]) for each in ranking.best]
    best = [min((value for last, value in made if last < end), default=float("nan")) for end in ends]
    return [unit.from_si(sign * value) for value in best]


# What a study was to find out, in words.


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
