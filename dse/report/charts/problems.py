"""What is wrong with a chart, before it is drawn: figures are also other people's code."""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable
from typing import get_args

import numpy as np

from dse.report.charts.chart import Axis, Bars, Chart, Drawn, Points, Rule, values_of
from dse.report.verdicts import Mark

MOST_BARS = 2000

_NAME = re.compile(r"\w[\w.-]*")


def chart_problems(chart: object, runs: Collection[int]) -> list[str]:
    """What keeps *chart* from being drawn for a study of these *runs*, in words."""
    if not isinstance(chart, Chart):
        return [f"something of type {type(chart).__name__} is not a Chart"]
    if not isinstance(chart.name, str) or not _NAME.fullmatch(chart.name):
        return [f"the name {chart.name!r} of a chart is not made of letters, digits, '_', '-' and '.'"]
    found = [f"{what} is not text" for what in ("title", "note") if not isinstance(getattr(chart, what), str)]
    for name, axis in (("x", chart.x), ("y", chart.y)):
        found += [f"axis {name}: {what}" for what in _axis_problems(axis)]
    if not found:
        for place, drawn in enumerate(chart.drawn, 1):
            where = f"{type(drawn).__name__} (number {place})"
            found += [f"{where}: {what}" for what in _drawn_problems(drawn, chart, runs)]
    return [f"chart '{chart.name}': {what}" for what in found]


def _axis_problems(axis: object) -> Iterable[str]:
    if not isinstance(axis, Axis):
        yield f"something of type {type(axis).__name__} is not an Axis"
        return
    if not all(isinstance(text, str) for text in (axis.label, axis.unit, *axis.names)):
        yield "label, unit and names must be texts"
    ends = [end for end in (axis.low, axis.high) if end is not None]
    if not all(isinstance(end, int | float) and math.isfinite(end) for end in ends):
        yield "low and high must be finite numbers"
    elif len(ends) == 2 and not ends[0] < ends[1]:
        yield f"low ({ends[0]:g}) must be below high ({ends[1]:g})"
    elif axis.log and any(end <= 0 for end in ends):
        yield "a logarithmic axis has positive ends"


def _drawn_problems(drawn: object, chart: Chart, runs: Collection[int]) -> Iterable[str]:
    if not isinstance(drawn, Drawn):
        yield f"not one of {', '.join(kind.__name__ for kind in get_args(Drawn))}"
        return
    if not isinstance(drawn.label, str):
        yield "the label is not text"
    if isinstance(drawn, Rule):
        if drawn.axis not in ("x", "y"):
            yield f"the axis is 'x' or 'y', not {drawn.axis!r}"
        elif not isinstance(drawn.value, int | float) or not math.isfinite(drawn.value):
            yield "the value is not a finite number"
        elif drawn.value <= 0 and getattr(chart, drawn.axis).log:
            yield f"{drawn.value:g} has no place on a logarithmic axis"
        return
    wrong = [
        f"{name} must be one-dimensional and of float64"
        for name, _, values in values_of(drawn)
        if not (isinstance(values, np.ndarray) and values.ndim == 1 and values.dtype == np.float64)
    ]
    yield from wrong or _value_problems(drawn, chart, runs)


def _value_problems(drawn: Drawn, chart: Chart, runs: Collection[int]) -> Iterable[str]:
    for name, along, values in values_of(drawn):
        if np.isinf(values).any():
            yield f"{name} has {np.count_nonzero(np.isinf(values))} infinite values; NaN leaves a gap"
        if getattr(chart, along).log and (values <= 0).any():
            yield f"{name} has values that are not positive, but its axis is logarithmic"
    lengths = {name: len(values) for name, _, values in values_of(drawn)}
    if isinstance(drawn, Bars):
        lengths["edges"] -= 1
        if lengths["heights"] > MOST_BARS:
            yield f"more than {MOST_BARS} bars"
        if not (np.diff(drawn.edges) > 0).all():
            yield "the edges do not ascend"
    if len(set(lengths.values())) > 1:
        shown = ", ".join(f"{name} {len(values)}" for name, _, values in values_of(drawn))
        yield f"the lengths do not fit each other: {shown}"
    if isinstance(drawn, Points):
        yield from _run_problems(drawn, runs)


def _run_problems(points: Points, runs: Collection[int]) -> Iterable[str]:
    numbers = points.runs
    if points.verdict is not None and not isinstance(points.verdict, Mark):
        yield "the verdict is not a Mark"
    if not (isinstance(numbers, np.ndarray) and numbers.ndim == 1 and numbers.dtype.kind == "i"):
        yield "runs must be a one-dimensional array of whole numbers"
    elif len(numbers) != len(points.x):
        yield f"there are {len(numbers)} runs for {len(points.x)} points"
    elif unknown := set(numbers.tolist()).difference(runs):
        yield f"the study has no run {min(unknown)}"
