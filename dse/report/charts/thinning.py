"""A choice of the points of a large chart: a page carries no more than a screen can show."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from dse.report.charts.chart import Band, Bars, Chart, Drawn, Line, Points, Rule, Steps
from dse.report.content.data import Floats

MOST_POINTS = 20_000
"""Points of one chart that a page carries."""


def thinned(chart: Chart, most: int = MOST_POINTS) -> Chart:
    """*chart* itself, or with about *most* points: of every stretch the smallest and the largest. Its note says so."""
    total = sum(map(_size, chart.drawn))
    if total <= most:
        return chart
    drawn = tuple(_thin(drawn, most * _size(drawn) // total) for drawn in chart.drawn)
    left = sum(map(_size, drawn))
    note = f"{left:,} of {total:,} points are drawn, the smallest and the largest of each stretch among them."
    return replace(chart, drawn=drawn, note=f"{chart.note} {note}".lstrip())


def _size(drawn: Drawn) -> int:
    return 0 if isinstance(drawn, Rule | Bars) else len(drawn.x)


def _thin(drawn: Drawn, most: int) -> Drawn:
    match drawn:
        case Line() | Steps():
            kept = _extremes(drawn.y, drawn.y, most)
            return replace(drawn, x=drawn.x[kept], y=drawn.y[kept])
        case Points():
            kept = _extremes(drawn.y, drawn.y, most)
            return replace(drawn, x=drawn.x[kept], y=drawn.y[kept], runs=drawn.runs[kept])
        case Band():
            kept = _extremes(drawn.low, drawn.high, most)
            return replace(drawn, x=drawn.x[kept], low=drawn.low[kept], high=drawn.high[kept])
    return drawn


def _extremes(low: Floats, high: Floats, most: int) -> NDArray[np.intp]:
    """Positions, ascending: both ends, and of each equal stretch the smallest of *low* and the largest of *high*."""
    edges = np.linspace(0, len(low), max(1, (most - 2) // 2) + 1).astype(np.intp)
    edges = np.unique(edges)
    smallest, largest = (np.where(np.isnan(part), np.inf, part) for part in (low, -high))
    kept = [0, len(low) - 1] if len(low) else []
    for start, end in pairwise(edges):
        kept += [start + int(smallest[start:end].argmin()), start + int(largest[start:end].argmin())]
    return np.unique(np.asarray(kept, dtype=np.intp))
