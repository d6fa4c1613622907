"""Objectives that are computed from metrics and sums of properties together: ``sum(cost) + 2 EUR/kWh * energy``.

``expected(EXPRESSION)`` in one is the mean over all cases of a design, each with the product of its conditions'
weights; in a case it is the mean over what is uncertain. It is the same number in all runs of the design, so that the
worst condition, by which objectives are judged otherwise, has that value too. With weights 3 and 1 of two benches, and
a risk of 0.1 on the first and 0.5 on the second, it is (3 * 0.1 + 1 * 0.5) / 4 = 0.2.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Kind, Type
from dse.domain.definition import StudyDefinition
from dse.domain.expression import Call, Name, Node
from dse.domain.sampler import Objective, Outcomes, Role
from dse.errors import Location, fail
from dse.expression import descend, parse_expression, rewritten, show_expression
from dse.metrics import RowProgram, compile_number
from dse.storage import groups_of
from dse.units import Unit, own_units, parse_unit, si_unit

_EXPECTED = "expected"


def compile_objective(objective: Objective, definition: StudyDefinition) -> tuple[RowProgram, Unit]:
    """What computes a composite *objective* of a study, and the unit of what it gives. Raises DseError.

    It is computed from metrics, by name, from totals, as ``sum(cost)``, and from ``expected(…)``, as it is written.
    """
    totals = {name: total.unit for each in definition.configurations for name, total in each.totals.items()}
    types: dict[str, Type] = {
        **{metric.name: _type(metric.unit) for metric in definition.metrics},
        **{f"sum({name})": _type(unit) for name, unit in totals.items()},
    }
    with own_units(definition.units):
        written = parse_expression(objective.name, Location("objective"))
    root = rewritten(written.root, _as_name)
    for inner in _expectations(root):
        _, unit = compile_objective(Objective(inner, is_composite=True), definition)
        types[f"{_EXPECTED}({inner})"] = Type(Kind.REAL, unit)
        if definition.replicates is not None:
            _require_means(inner, definition)
    program, dimension = compile_number(replace(written, root=root), types)
    return program, si_unit(dimension)


def with_composites(outcomes: Outcomes, objectives: Sequence[Objective], definition: StudyDefinition) -> Outcomes:
    """*outcomes* with a metric for each of *objectives* that is composite, called as it is written.

    For expected values they are all those of a design.
    """
    wanted = [each for each in objectives if each.is_composite]
    if not wanted:
        return outcomes
    made = {each.name: _rows(each.name, outcomes, definition) for each in wanted}
    return replace(outcomes, metrics={**outcomes.metrics, **made})


def _rows(text: str, outcomes: Outcomes, definition: StudyDefinition) -> NDArray[np.float64]:
    if not len(outcomes):  # of a new study whose sampler proposes configurations no sum is known yet
        return outcomes.done.astype(np.float64)
    program, _ = compile_objective(Objective(text, is_composite=True), definition)
    columns = {**outcomes.metrics, **{f"sum({name})": column for name, column in outcomes.totals.items()}}
    for name in program.names:
        if name not in columns:
            inner = name.removeprefix(f"{_EXPECTED}(").removesuffix(")")
            columns[name] = _expected(_rows(inner, outcomes, definition), outcomes, definition)
    return np.asarray(program.rows({name: columns[name] for name in program.names}), dtype=np.float64)


def _expected(values: NDArray[np.float64], outcomes: Outcomes, definition: StudyDefinition) -> NDArray[np.float64]:
    """The expected value of *values*, (n,), of the design that each row belongs to, (n,)."""
    points = {name: np.asarray(column, dtype=np.float64) for name, column in outcomes.points.items()}
    decided = [points[each.name] for each in definition.variables if each.role == Role.DESIGN]
    given = [each for each in definition.variables if each.role == Role.CONDITION]
    _, names = np.unique(np.array(outcomes.configurations, dtype=np.str_), return_inverse=True)
    own = np.nan_to_num(np.column_stack([names.reshape(-1), *decided]).astype(np.float64), nan=np.inf)
    design = groups_of(own)
    case = groups_of(np.column_stack([design, *(points[each.name] for each in given)]).astype(np.float64))
    first = np.unique(case, return_index=True)[1]
    weights = np.ones(len(first))
    for each in given:
        if each.weights:
            weights *= np.array(each.weights)[np.searchsorted(each.values, points[each.name][first])]
    means = np.bincount(case, values) / np.bincount(case)
    weighted = np.where(weights > 0, weights * means, 0.0)
    of = design[first]
    with np.errstate(invalid="ignore"):
        return np.asarray((np.bincount(of, weighted) / np.bincount(of, weights))[design])


def _expectations(root: Node) -> list[str]:
    """What *root* has expected values of, as it is written."""
    names = (node.path for node in descend(root) if isinstance(node, Name))
    return [name.removeprefix(f"{_EXPECTED}(")[:-1] for name in names if name.startswith(f"{_EXPECTED}(")]


def _require_means(inner: str, definition: StudyDefinition) -> None:
    """DseError for a metric that has the value of the draw that decides, as a requirement is about it."""
    judged = {requirement.metric for requirement in definition.requirements}
    with own_units(definition.units):
        root = parse_expression(inner, Location("objective")).root
    for node in descend(root):
        if isinstance(node, Name) and node.path in judged:
            what = f"'{node.path}' has no mean over the draws: it is that of the draw which decides on a requirement"
            raise fail(what, Location("objective"), "let a metric of another name have the same expression")


def _as_name(node: Node) -> Node:
    match node:
        case Call("sum", arguments=(Name(path=name),), span=span):
            return Name(f"sum({name})", span)
        case Call("expected", arguments=(inner,), span=span):
            return Name(f"expected({show_expression(inner)})", span)
    return node


def _type(unit: str) -> Type:
    return Type(Kind.REAL, parse_unit(unit))
