"""What came of the objectives: the best designs, and how the search came to them."""

from __future__ import annotations

import numpy as np

from dse.analysis import Ranking, Standing, objectives_of, ranked, slack_of_runs, stages, unit_of_objective
from dse.domain.definition import StudyDefinition
from dse.errors import DseError
from dse.report.content.data import Floats
from dse.report.content.insight import Pick, SearchCourse, Stage
from dse.report.insight.naming import Naming
from dse.storage import RunTable
from dse.units import parse_unit

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
        units,
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
