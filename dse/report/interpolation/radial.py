"""Interpolation of scattered runs with radial functions; the weights travel in the page, the browser adds them up.

The interpolant is ``s(p) = c + sum(w_j * |p - p_j|)`` over the runs j, with ``sum(w_j) = 0``, on variables scaled to
0 … 1: the smoothest of the simple kernels that never overshoots far (Wendland, Scattered Data Approximation, 8.3).

Metrics are interpolated as ``asinh((value - middle) / spread)`` around their bound: what happens at the bound must not
be drowned by runs that miss it by a hundred times as much, and a monotone function has the same boundary.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.report.content.data import Floats, MetricColumn, ReportContent

MOST_CENTRES = 3000
"""More runs than this per configuration are drawn as points only: the system of equations grows with the cube."""


@dataclass(frozen=True, slots=True, eq=False)
class RadialFields:
    """Weights of several fields on common *centres* (positions of runs).

    *weights* is (fields, centres + 1), the constant last. Fields are the metrics in order, each as
    ``asinh((value - middle) / spread)`` with *middle* and *spread* (metrics,), then for each
    requirement 1 where it was exercised and 0 where not, then 1 where all requirements have a value and 0 where not.
    """

    centres: NDArray[np.intp]
    weights: NDArray[np.float32]
    middle: Floats
    spread: Floats

    def metric(self, index: int, field: Floats) -> Floats:
        """Values of the metric *index*, in its unit, where its interpolated field is *field*."""
        return np.asarray(self.middle[index] + self.spread[index] * np.sinh(field), dtype=np.float64)


def radial_fields(content: ReportContent, configuration: str) -> RadialFields | None:
    """Weights for one configuration; None where there are too few runs, or more than MOST_CENTRES."""
    rows = content.rows_of(configuration)
    points = unit_points(content, rows)
    points, first = np.unique(points, axis=0, return_index=True)
    if not 3 <= len(first) <= MOST_CENTRES:
        return None
    # Among equal points np.unique keeps the first run, so that rounding cannot make the system singular.
    centres = rows[first]
    scales = [_scale(content, metric, centres) for metric in content.metrics]
    middle, spread = (np.array([scale[i] for scale in scales]) for i in (0, 1))
    fields = _fields(content, centres, points, middle, spread)
    if fields is None:
        return None
    return RadialFields(centres, _solve(points, fields).astype(np.float32), middle, spread)


def unit_points(content: ReportContent, rows: NDArray[np.intp]) -> Floats:
    """The runs *rows* as points with every variable scaled to 0 … 1, (rows, variables)."""
    scaled = [(v.values[rows] - v.low) / (v.high - v.low) for v in content.variables]
    return np.stack(scaled, axis=1) if scaled else np.empty((len(rows), 0))


def evaluate(centres: Floats, weights: NDArray[np.floating], points: Floats) -> Floats:
    """The field with *weights* (centres + 1,) at *points* (n, variables)."""
    from scipy.spatial.distance import cdist

    return np.asarray(cdist(points, centres) @ weights[:-1].astype(np.float64) + float(weights[-1]), dtype=np.float64)


def has_value(content: ReportContent) -> NDArray[np.bool_]:
    """For every run, whether it came to its end and each requirement it exercised has a defined metric."""
    known = content.runs.done.copy()
    for requirement in content.requirements:
        known &= np.isfinite(content.metric(requirement.metric).values) | ~requirement.exercised
    return known


def _scale(content: ReportContent, metric: MetricColumn, centres: NDArray[np.intp]) -> tuple[float, float]:
    """Where *metric* matters, its bound or its median, and a tenth of its usual distance from there."""
    values = metric.values[centres]
    known = values[content.runs.done[centres] & np.isfinite(values)]
    bounds = [b for r in content.requirements if r.metric == metric.name for b in (r.at_most, r.at_least)]
    middle = next((b for b in bounds if b is not None), float(np.median(known)) if len(known) else 0.0)
    usual = float(np.median(np.abs(known - middle))) if len(known) else 0.0
    return middle, usual / 10 or 1.0


def _fields(
    content: ReportContent, centres: NDArray[np.intp], points: Floats, middle: Floats, spread: Floats
) -> Floats | None:
    done = content.runs.done[centres]
    metrics = [_filled(points, m.values[centres], done & np.isfinite(m.values[centres])) for m in content.metrics]
    columns = [
        *(np.arcsinh((values - c) / s) for values, c, s in zip(metrics, middle, spread, strict=True)),
        *(_filled(points, r.exercised[centres].astype(np.float64), done) for r in content.requirements),
        has_value(content)[centres].astype(np.float64),
    ]
    return None if not done.any() else np.stack(columns, axis=1)


def _filled(points: Floats, values: Floats, known: NDArray[np.bool_]) -> Floats:
    """*values* with the unknown ones taken from the nearest known point; zero if nothing is known."""
    from scipy.spatial import KDTree

    if known.all():
        return values
    if not known.any():
        return np.zeros_like(values)
    filled = values.copy()
    _, nearest = KDTree(points[known]).query(points[~known])
    filled[~known] = values[known][nearest]
    return filled


def _solve(points: Floats, fields: Floats) -> Floats:
    from scipy.linalg import solve
    from scipy.spatial.distance import cdist

    n = len(points)
    system = np.ones((n + 1, n + 1))
    system[:n, :n] = cdist(points, points)
    system[n, n] = 0.0
    right = np.zeros((n + 1, fields.shape[1]))
    right[:n] = fields
    return np.asarray(solve(system, right, assume_a="sym"), dtype=np.float64).T
