"""The objectives of a study, and the numbers of those that are computed from metrics and properties."""

from __future__ import annotations

import numpy as np

from dse.domain.definition import DefinedObjective, StudyDefinition
from dse.domain.sampler import Objective
from dse.report.content.data import MetricColumn, ObjectiveEntry
from dse.storage import RunTable
from dse.testbench import compile_objective, with_composites


def objectives_of(definition: StudyDefinition) -> tuple[ObjectiveEntry, ...]:
    """In the order of the study."""
    return tuple(ObjectiveEntry(each.name, each.maximize, each.is_total) for each in definition.objectives)


def composites_of(definition: StudyDefinition, table: RunTable) -> tuple[MetricColumn, ...]:
    """A column for each objective that is an expression, called as it is written."""
    return tuple(_composite(each, definition, table) for each in definition.objectives if each.is_composite)


def _composite(entry: DefinedObjective, definition: StudyDefinition, table: RunTable) -> MetricColumn:
    objective = Objective(entry.name, entry.maximize, is_composite=True)
    if not len(table):
        return MetricColumn(entry.name, entry.name, "", np.zeros(0))
    _, unit = compile_objective(objective, definition)
    outcomes = table.outcomes(table.numbers.tolist(), objective.totals)
    values = with_composites(outcomes, [objective], definition).metrics[entry.name]
    return MetricColumn(entry.name, entry.name, str(unit), np.asarray(values, dtype=np.float64))
