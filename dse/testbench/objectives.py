"""Objectives that are computed from metrics and sums of properties together: ``sum(cost) + 2 EUR/kWh * energy``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from dse.domain.component import Kind, Type
from dse.domain.definition import StudyDefinition
from dse.domain.expression import Call, Name, Node
from dse.domain.sampler import Objective, Outcomes
from dse.errors import Location
from dse.expression import parse_expression, rewritten
from dse.metrics import RowProgram, compile_number
from dse.units import Unit, parse_unit, si_unit


def compile_objective(objective: Objective, definition: StudyDefinition) -> tuple[RowProgram, Unit]:
    """What computes a composite *objective* of a study, and the unit of what it gives. Raises DseError.

    It is computed from metrics, by name, and totals, as ``sum(cost)``.
    """
    totals = {name: total.unit for each in definition.configurations for name, total in each.totals.items()}
    types: Mapping[str, Type] = {
        **{metric.name: _type(metric.unit) for metric in definition.metrics},
        **{f"sum({name})": _type(unit) for name, unit in totals.items()},
    }
    written = parse_expression(objective.name, Location("objective"))
    program, dimension = compile_number(replace(written, root=rewritten(written.root, _as_name)), types)
    return program, si_unit(dimension)


def with_composites(outcomes: Outcomes, objectives: Sequence[Objective], definition: StudyDefinition) -> Outcomes:
    """*outcomes* with a metric for each of *objectives* that is composite, called as it is written."""
    wanted = [each for each in objectives if each.is_composite]
    if not wanted:
        return outcomes
    columns = {**outcomes.metrics, **{f"sum({name})": column for name, column in outcomes.totals.items()}}
    made = {}
    for each in wanted:
        if not len(outcomes):  # of a new study whose sampler proposes configurations no sum is known yet
            made[each.name] = outcomes.done.astype(np.float64)
            continue
        program, _ = compile_objective(each, definition)
        made[each.name] = program.rows({name: columns[name] for name in program.names})
    return replace(outcomes, metrics={**outcomes.metrics, **made})


def _as_name(node: Node) -> Node:
    match node:
        case Call("sum", arguments=(Name(path=name),), span=span):
            return Name(f"sum({name})", span)
    return node


def _type(unit: str) -> Type:
    return Type(Kind.REAL, parse_unit(unit))
