"""A chart as plain values: two axes and what is drawn between them, alike on the page and in print.

Every array of values is one-dimensional, of float64, in the unit of its axis; NaN leaves a gap.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from dse.report.content.data import Floats
from dse.report.verdicts import Mark

Limits = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Axis:
    """*unit* is "" for plain numbers. An end that is None follows what is drawn. *names* are those of the positions
    0, 1, … on an axis that has no numbers."""

    label: str
    unit: str = ""
    log: bool = False
    low: float | None = None
    high: float | None = None
    names: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, eq=False)
class Line:
    """Straight from point to point."""

    x: Floats
    y: Floats
    label: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Steps:
    """Each *y* holds from its *x* to the next."""

    x: Floats
    y: Floats
    label: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Points:
    """*runs* holds the number of the run each point stands for: a click selects it. With a *verdict* the points look as
    such runs do everywhere."""

    x: Floats
    y: Floats
    runs: NDArray[np.int64]
    label: str = ""
    verdict: Mark | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Bars:
    """*heights* (n,) between the ascending *edges* (n + 1,), from zero."""

    edges: Floats
    heights: Floats
    label: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Band:
    """The area between *low* and *high* over *x*."""

    x: Floats
    low: Floats
    high: Floats
    label: str = ""


@dataclass(frozen=True, slots=True)
class Rule:
    """A straight line across the chart where *axis* has *value*, as for a bound."""

    axis: Literal["x", "y"]
    value: float
    label: str = ""


Drawn = Line | Steps | Points | Bars | Band | Rule


@dataclass(frozen=True, slots=True, eq=False)
class Chart:
    """*name* tells the charts of a figure apart, also in file names: letters, digits, ``_``, ``-`` and dots.

    *drawn* is painted in its order; *note* says what a reader must know to read the chart.
    """

    name: str
    title: str
    x: Axis
    y: Axis
    drawn: tuple[Drawn, ...]
    note: str = ""


def values_of(drawn: Drawn) -> Iterator[tuple[str, Literal["x", "y"], Floats]]:
    """Its arrays: what each is called, the axis it belongs to, the values."""
    match drawn:
        case Line() | Steps() | Points():
            yield from (("x", "x", drawn.x), ("y", "y", drawn.y))
        case Bars():
            yield from (("edges", "x", drawn.edges), ("heights", "y", drawn.heights))
        case Band():
            yield from (("x", "x", drawn.x), ("low", "y", drawn.low), ("high", "y", drawn.high))


def limits(chart: Chart) -> tuple[Limits, Limits]:
    """The ends of both axes: as given, else around everything drawn."""
    return _limits(chart, "x", chart.x), _limits(chart, "y", chart.y)


def _limits(chart: Chart, name: Literal["x", "y"], axis: Axis) -> Limits:
    if axis.names:
        return -0.5, len(axis.names) - 0.5
    parts = [values for drawn in chart.drawn for _, along, values in values_of(drawn) if along == name]
    parts += [np.asarray([drawn.value]) for drawn in chart.drawn if isinstance(drawn, Rule) and drawn.axis == name]
    if name == "y" and not axis.log and any(isinstance(drawn, Bars) for drawn in chart.drawn):
        parts.append(np.zeros(1))
    known = np.concatenate([np.empty(0), *parts])
    known = known[np.isfinite(known)]
    low, high = (float(known.min()), float(known.max())) if known.size else (1.0, 1.0)
    if axis.log:
        room = max(0.02, 0.04 * math.log10(high / low))
        ends = low / 10**room, high * 10**room
    else:
        room = 0.04 * (high - low) or max(0.5, 0.1 * abs(high))
        ends = low - room, high + room
    low, high = (ends[0] if axis.low is None else axis.low), (ends[1] if axis.high is None else axis.high)
    return (low, high) if low < high else (low, low + 1.0)


def bulk(values: Floats, *also: float) -> tuple[float | None, float | None]:
    """Ends of an axis that show the bulk of *values* and *also*, where some lie so far out that they would flatten the
    others; else None and None."""
    known = values[np.isfinite(values)]
    if not known.size:
        return None, None
    low, high = np.quantile(known, [0.02, 0.98])
    low, high = min(float(low), *also, float(high)), max(float(high), *also, float(low))
    room = 0.05 * (high - low)
    if not room or max(float(known.max()), high) - min(float(known.min()), low) <= 3 * (high - low):
        return None, None
    return low - room, high + room
