"""The plane of two design variables in which a figure is drawn: its runs, and the fields between them.

The page does the same in the browser (``web/src/plane``).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.report.content.data import (
    Flags,
    Floats,
    MetricColumn,
    ReportContent,
    ReportVariable,
    RequirementRow,
    SamplerKind,
)
from dse.report.interpolation.radial import MOST_CENTRES, evaluate, has_value, radial_fields, unit_points

_SIZE = 81
_SIDE = 0.12
"""How clearly a node stays on its side of 0.5 while the boundary of a yes/no field is relaxed."""


@dataclass(frozen=True, slots=True, eq=False)
class PlaneFields:
    """Fields (ny, nx) over *xs* and *ys*: of a metric, of a requirement's flag (0.5 or more where exercised), and of
    what is known (0.5 or more where no failed run or undefined metric leaves a hole)."""

    xs: Floats
    ys: Floats
    metric: Callable[[MetricColumn], Floats]
    exercised: Callable[[RequirementRow], Floats]
    known: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Plane:
    """Positions of the runs shown, how strongly (1 in the plane), the fields if there are any, and a note on them."""

    rows: NDArray[np.intp]
    strength: Floats
    fields: PlaneFields | None
    note: str


def plane_of(content: ReportContent, x: str, y: str, configuration: str, at: Mapping[str, float]) -> Plane:
    """The plane over *x* and *y* of one configuration, other variables at their values in *at*, else at (or nearest to)
    their nominal ones. Runs elsewhere in what is *at* are as strong as others."""
    rows = content.rows_of(configuration)
    others = [variable for variable in content.variables if variable.name not in (x, y)]
    if content.sampler is SamplerKind.SCATTERED:
        return _scattered(content, x, y, configuration, rows, at)
    for variable in others:
        fixed = at.get(variable.name, _nearest_level(variable))
        rows = rows[np.abs(variable.values[rows] - fixed) <= 1e-9 * (variable.high - variable.low)]
    strength = np.ones(len(rows))
    if content.sampler is SamplerKind.SLICED and not any({x, y} <= set(names) for names in content.slices):
        return Plane(rows, strength, None, "These two variables were not varied together: no boundaries.")
    if note := _nothing_between(content, x, y):
        return Plane(rows, strength, None, note)
    xs, column = np.unique(content.variable(x).values[rows], return_inverse=True)
    ys, row = np.unique(content.variable(y).values[rows], return_inverse=True)
    if len(xs) < 2 or len(ys) < 2 or len(rows) < 0.5 * len(xs) * len(ys):
        return Plane(rows, strength, None, "Too few runs of this plane have been made: no boundaries.")
    nodes = np.full((len(ys), len(xs)), -1, dtype=np.intp)
    nodes[row, column] = rows
    fields = _lattice(xs, ys, nodes, content.runs.done, has_value(content))
    return Plane(rows, strength, fields, "Boundaries are interpolated linearly between the runs of the grid.")


def _nothing_between(content: ReportContent, x: str, y: str) -> str:
    """Why there are no fields if one of the axes has values that are apart."""
    title = next((each.title or each.name for each in map(content.variable, (x, y)) if each.apart), "")
    return title and f"Nothing is known between the values of {title}: only the runs are shown, no boundaries."


def _nearest_level(variable: ReportVariable) -> float:
    levels = np.unique(variable.values)
    return float(levels[np.argmin(np.abs(levels - variable.nominal))])


def _lattice(xs: Floats, ys: Floats, nodes: NDArray[np.intp], done: Flags, known: Flags) -> PlaneFields:
    ran = (nodes >= 0) & done[nodes]

    def metric(column: MetricColumn) -> Floats:
        at_nodes = np.where(ran, column.values[nodes], np.nan)
        return _filled(at_nodes, np.isfinite(at_nodes))

    def exercised(requirement: RequirementRow) -> Floats:
        at_nodes = _filled(np.where(ran, requirement.exercised[nodes], 0.0).astype(np.float64), ran)
        return _divided(at_nodes >= 0.5)

    return PlaneFields(xs, ys, metric, exercised, _divided((nodes >= 0) & known[nodes]))


def _scattered(
    content: ReportContent, x: str, y: str, configuration: str, rows: NDArray[np.intp], at: Mapping[str, float]
) -> Plane:
    others = [variable for variable in content.variables if variable.name not in (x, y, *at)]
    square = np.zeros(len(rows))
    for variable in others:
        square += ((variable.values[rows] - variable.nominal) / (variable.high - variable.low)) ** 2
    away = np.sqrt(square / max(1, len(others)))
    strength = np.where(away < 1e-9, 1.0, np.maximum(0.1, 1 - 2.2 * away))
    if note := _nothing_between(content, x, y):
        return Plane(rows, strength, None, note)
    fields = radial_fields(content, configuration)
    if fields is None:
        few = len(rows) <= MOST_CENTRES
        return Plane(rows, strength, None, "Too few runs to interpolate." if few else "Too many runs to interpolate.")
    horizontal, vertical = content.variable(x), content.variable(y)
    xs, ys = (np.linspace(v.low, v.high, _SIZE) for v in (horizontal, vertical))
    points = np.empty((_SIZE * _SIZE, len(content.variables)))
    for index, variable in enumerate(content.variables):
        value = at.get(variable.name, variable.nominal)
        points[:, index] = (value - variable.low) / (variable.high - variable.low)
        if variable.name == x:
            points[:, index] = np.tile(np.linspace(0, 1, _SIZE), _SIZE)
        elif variable.name == y:
            points[:, index] = np.repeat(np.linspace(0, 1, _SIZE), _SIZE)
    centres = unit_points(content, fields.centres)

    def field(index: int) -> Floats:
        return evaluate(centres, fields.weights[index], points).reshape(_SIZE, _SIZE)

    def metric(column: MetricColumn) -> Floats:
        index = content.metrics.index(column)
        return fields.metric(index, field(index))

    def exercised(requirement: RequirementRow) -> Floats:
        return field(len(content.metrics) + content.requirements.index(requirement))

    note = f"Boundaries are interpolated with radial functions through {len(fields.centres)} runs."
    return Plane(rows, strength, PlaneFields(xs, ys, metric, exercised, field(-1)), note)


def _filled(values: Floats, known: Flags) -> Floats:
    """Unknown nodes take the mean of their known neighbours, from the rim of each hole inwards."""
    values, known = np.where(known, values, 0.0), known.copy()
    if not known.any():
        return values
    while not known.all():
        total, count = _around(np.where(known, values, 0.0)), _around(known.astype(np.float64))
        rim = ~known & (count > 0)
        values[rim] = total[rim] / count[rim]
        known |= rim
    return values


def _around(values: Floats) -> Floats:
    padded = np.pad(values, 1)
    total = padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]
    return np.asarray(total, dtype=np.float64)


def _divided(inside: Flags) -> Floats:
    """A field with its 0.5 line relaxed as far as every node stays clearly on its own side."""
    if inside.all():
        return np.ones(inside.shape)
    values = inside.astype(np.float64)
    for _ in range(60):
        padded = np.pad(values, 1, mode="edge")
        mean = (padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]) / 4
        relaxed = 0.3 * values + 0.7 * mean
        values = np.where(inside, np.maximum(relaxed, 0.5 + _SIDE), np.minimum(relaxed, 0.5 - _SIDE))
    return values
