"""The constraint plot for print, as the paper's Figure 6: what it shows, as values, and its drawing."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dse.report.content.data import Floats
from dse.report.drawing.style import BROKEN, COLOURS, FEASIBLE, HATCHES, INK, MARKS, MUTED, PASS, STYLE
from dse.report.verdicts import Mark, Marks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Line = NDArray[np.float64]
"""A polyline, (points, 2), in the units of the axes."""


@dataclass(frozen=True, slots=True, eq=False)
class RequirementLayer:
    """One requirement over the grid: *margin* (ny, nx) is negative where it fails, *exercised* at least 0.5 where it
    came into play; *boundary* are the lines of zero margin, exercised or not; *caption* says what makes it fail."""

    title: str
    caption: str
    margin: Floats
    exercised: Floats
    boundary: tuple[Line, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ConstraintPlotData:
    """Figure 6: *xs* (nx,) and *ys* (ny,) span the grid of the *layers* and of *known*, which is below 0.5 where failed
    runs leave a hole; without regions they are empty. *note* says how boundaries were made, or why there are none.
    *points* (n, 2) are the runs with their *marks* (see Mark) and *strength*, 1 in the plane and less beside it. The
    values of an axis that are *apart* are evenly spaced, each with its text; axes are *log* or linear.
    """

    title: str
    x_label: str
    y_label: str
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    xs: Floats
    ys: Floats
    layers: tuple[RequirementLayer, ...]
    known: Floats
    points: Floats
    marks: Marks
    strength: Floats
    note: str
    x_apart: Mapping[float, str] = field(default_factory=dict)
    y_apart: Mapping[float, str] = field(default_factory=dict)
    log: tuple[bool, bool] = (False, False)

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Where on the grid every requirement is met and exercised, (ny, nx)."""
        met = self.known >= 0.5
        for layer in self.layers:
            met = met & (layer.margin >= 0) & (layer.exercised >= 0.5)
        return met


def draw_constraint_plot(data: ConstraintPlotData) -> Figure:
    """Figure 6: a hatch and a line per requirement on its infeasible side, the runs as points."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 5.6), layout="constrained")
        axes = figure.add_subplot()
        axes.set(xlim=data.x_range, ylim=data.y_range, xlabel=data.x_label, ylabel=data.y_label)
        if data.log[0]:
            axes.set_xscale("log")
        if data.log[1]:
            axes.set_yscale("log")
        if len(data.x_apart) > 1:
            axes.set_xscale("function", functions=_evenly(list(data.x_apart)))
            axes.set_xticks(list(data.x_apart), list(data.x_apart.values()))
        if len(data.y_apart) > 1:
            axes.set_yscale("function", functions=_evenly(list(data.y_apart)))
            axes.set_yticks(list(data.y_apart), list(data.y_apart.values()))
        axes.set_title(data.title, loc="left", parse_math=False)
        below = axes.annotate(data.note, (0, 0), (0, -38), "axes fraction", "offset points", fontsize=7, color=MUTED)
        for name in (axes.xaxis.label, axes.yaxis.label, below):
            name.set_parse_math(False)
        if data.layers:
            _draw_regions(axes, data)
        _draw_points(axes, data)
        _draw_legend(figure, data)
        return figure


def _evenly(values: Sequence[float]) -> tuple[Callable[[Floats], Floats], Callable[[Floats], Floats]]:
    """From *values* to 0, 1, … and back."""
    steps = np.arange(len(values))
    return lambda x: np.interp(x, values, steps), lambda step: np.interp(step, steps, values)


def _draw_regions(axes: Axes, data: ConstraintPlotData) -> None:
    xs, ys = data.xs, data.ys
    # Everything counts as feasible until a layer takes its part away: so the corners where boundaries meet stay sharp.
    axes.fill_between(xs[[0, -1]], ys[0], ys[-1], color=FEASIBLE, linewidth=0)
    for layer in data.layers:
        _fill_below(axes, data, layer.margin, 0.0)
        _fill_below(axes, data, layer.exercised, 0.5)
    _fill_below(axes, data, data.known, 0.5)
    for index, layer in enumerate(data.layers):
        colour = COLOURS[index % len(COLOURS)]
        if np.max(layer.exercised) < 0.5:
            continue
        inside = axes.contourf(xs, ys, layer.exercised, levels=[0.5, np.max(layer.exercised) + 1], colors="none")
        part = inside.get_paths()[0]
        lowest = float(np.min(layer.margin))
        if lowest < 0:
            hatch = HATCHES[index % len(HATCHES)]
            hatched = axes.contourf(xs, ys, layer.margin, levels=[lowest - 1, 0], colors="none", hatches=[hatch])
            hatched.set_edgecolor(colour)
            hatched.set_linewidth(0)
            hatched.set_clip_path(part, axes.transData)
        for line in layer.boundary:
            (drawn,) = axes.plot(line[:, 0], line[:, 1], color=colour, linewidth=2.0, solid_capstyle="butt")
            drawn.set_clip_path(part, axes.transData)
        if np.min(layer.exercised) < 0.5:
            axes.contour(xs, ys, layer.exercised, levels=[0.5], colors=[MUTED], linestyles=["dashed"], linewidths=1.0)


def _fill_below(axes: Axes, data: ConstraintPlotData, field: Floats, level: float) -> None:
    lowest = float(np.min(field))
    if lowest < level:
        axes.contourf(data.xs, data.ys, field, levels=[lowest - 1, level], colors=["white"])


_WORDS = {
    Mark.PASS: "meets every requirement",
    Mark.FAIL: "fails at least one",
    Mark.NOT_EXERCISED: "not exercised",
    Mark.FAILED_TO_RUN: "failed to run",
}


def _draw_points(axes: Axes, data: ConstraintPlotData) -> None:
    scale = float(np.clip(600 / max(1, len(data.points)), 0.15, 1))
    for mark, style in MARKS.items():
        chosen = data.marks == mark
        if chosen.any():
            sized = {**style, "s": style["s"] * scale}
            x, y = data.points[chosen].T
            axes.scatter(x, y, alpha=data.strength[chosen], clip_on=False, zorder=3, **sized)


def _draw_legend(figure: Figure, data: ConstraintPlotData) -> None:
    from matplotlib.artist import Artist
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Artist] = [
        Patch(
            facecolor="white",
            edgecolor=COLOURS[index % len(COLOURS)],
            hatch=HATCHES[index % len(HATCHES)],
            linewidth=1.4,
            label=layer.caption,
        )
        for index, layer in enumerate(data.layers)
    ]
    if any(np.min(layer.exercised) < 0.5 for layer in data.layers):
        handles.append(Line2D([], [], color=MUTED, linestyle="dashed", linewidth=1, label="limit of exercised"))
    shapes = {Mark.PASS: ("o", PASS, 5), Mark.FAIL: ("o", INK, 2.5), Mark.NOT_EXERCISED: ("o", "white", 4)}
    for mark, words in _WORDS.items():
        count = int(np.count_nonzero(data.marks == mark))
        if not count:
            continue
        marker, colour, size = shapes.get(mark, ("x", BROKEN, 5.5))
        edge = {Mark.NOT_EXERCISED: MUTED, Mark.FAILED_TO_RUN: BROKEN}.get(mark, "none")
        handles.append(
            Line2D(
                [],
                [],
                linestyle="none",
                marker=marker,
                markerfacecolor=colour,
                markeredgecolor=edge,
                markeredgewidth=1.6 if mark is Mark.FAILED_TO_RUN else 0.8,
                markersize=size,
                label=f"{words} ({count})",
            )
        )
    legend = figure.legend(handles=handles, loc="outside lower left", ncols=2, frameon=False, fontsize=8)
    for text in legend.get_texts():
        text.set_parse_math(False)
