"""Draws the paper's two figures with matplotlib and saves them; all values come ready from `dse.report.figures`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.errors import fail
from dse.report.content import Floats
from dse.report.figures.constraints import ConstraintPlotData
from dse.report.figures.waveforms import WaveformData
from dse.report.verdicts import Mark

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# The page's colours (web/src/style/colours.css): apart under every common colour blindness, and each with its hatch.
COLOURS = ("#b54708", "#1f55c4", "#9c2a8f", "#0b7570", "#7a5c00", "#475467")
_HATCHES = ("////", "\\\\\\\\", "---", "|||", "//..", "++")
INK, MUTED, _FEASIBLE, _PASS, _BROKEN = "#1a222d", "#5c6877", "#d8eddf", "#12703f", "#c01048"
TARGET, _CURRENT, LINE = "#d01f1f", "#1f55c4", "#dfe4ea"
STYLE: Any = {  # matplotlib types the keys as literals
    "font.size": 9,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.labelweight": "bold",
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "axes.linewidth": 0.8,
    "xtick.color": INK,
    "ytick.color": INK,
    "hatch.linewidth": 0.7,
    "svg.hashsalt": "dse",
    "svg.fonttype": "path",
    "pdf.fonttype": 42,
}
_FORMATS = {".png", ".svg", ".pdf"}


def draw_constraint_plot(data: ConstraintPlotData) -> Figure:
    """Figure 6: a hatch and a line per requirement on its infeasible side, the runs as points."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 5.6), layout="constrained")
        axes = figure.add_subplot()
        axes.set(xlim=data.x_range, ylim=data.y_range, xlabel=data.x_label, ylabel=data.y_label)
        axes.set_title(data.title, loc="left", parse_math=False)
        for name in (axes.xaxis.label, axes.yaxis.label):
            name.set_parse_math(False)
        if data.layers:
            _draw_regions(axes, data)
        _draw_points(axes, data)
        _draw_legend(figure, data)
        return figure


def draw_waveforms(data: WaveformData) -> Figure:
    """Figure 7: the target red and dashed, the current value blue, one panel per waveform."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.8, 0.7 + 2.1 * len(data.panels)), layout="constrained")
        figure.suptitle(data.title, x=0.01, ha="left", fontsize=10, fontweight="bold", parse_math=False)
        first: Axes | None = None
        for index, panel in enumerate(data.panels):
            axes = figure.add_subplot(len(data.panels), 1, index + 1, sharex=first)
            first = first or axes
            axes.plot(panel.time, panel.current, color=_CURRENT, linewidth=1.6, label=panel.current_label)
            if panel.target is not None:
                axes.plot(
                    panel.time, panel.target, color=TARGET, linewidth=1.3, dashes=(5, 3), label=panel.target_label
                )
            axes.set_title(panel.title, loc="left", parse_math=False)
            axes.set_ylabel(panel.y_label, parse_math=False)
            axes.set_xlim(float(panel.time[0]), float(panel.time[-1]))
            axes.margins(y=0.08)
            axes.grid(color=LINE, linewidth=0.7)
            axes.set_axisbelow(True)
            axes.spines[["top", "right"]].set_visible(False)
            legend = axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2, frameon=False, borderaxespad=0.1)
            for text in legend.get_texts():
                text.set_parse_math(False)
            axes.set_xlabel("time [s]" if index == len(data.panels) - 1 else "")
            axes.tick_params(labelbottom=index == len(data.panels) - 1)
        return figure


def save(figure: Figure, path: Path) -> None:
    """Write *figure* as PNG, SVG or PDF by the path's ending; the same figure gives the same bytes."""
    import matplotlib as mpl

    kind = path.suffix.lower()
    if kind not in _FORMATS:
        raise fail(f"cannot write a figure as '{path.name}'", hint="end the name in .png, .svg or .pdf")
    # Each format would otherwise carry the moment it was written, or matplotlib's version.
    every: dict[str, dict[str, Any]] = {
        ".png": {"Software": None},
        ".svg": {"Date": None, "Creator": "dse"},
        ".pdf": {"CreationDate": None, "ModDate": None, "Creator": "dse", "Producer": None},
    }
    scratch = path.with_name(f".{path.stem}.part{kind}")
    try:
        with mpl.rc_context(STYLE):
            figure.savefig(scratch, format=kind[1:], dpi=200, metadata=every[kind])
        scratch.replace(path)
    except OSError as error:
        scratch.unlink(missing_ok=True)
        raise fail(f"cannot write {path}: {error.strerror}") from error


def _draw_regions(axes: Axes, data: ConstraintPlotData) -> None:
    xs, ys = data.xs, data.ys
    # Everything counts as feasible until a layer takes its part away: so the corners where boundaries meet stay sharp.
    axes.fill_between(xs[[0, -1]], ys[0], ys[-1], color=_FEASIBLE, linewidth=0)
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
            hatch = _HATCHES[index % len(_HATCHES)]
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


MARKS: dict[Mark, dict[str, Any]] = {
    Mark.FAIL: {"marker": "o", "s": 3.5, "facecolors": INK, "edgecolors": "none"},
    Mark.NOT_EXERCISED: {"marker": "o", "s": 13, "facecolors": "white", "edgecolors": MUTED, "linewidths": 0.7},
    Mark.PASS: {"marker": "o", "s": 20, "facecolors": _PASS, "edgecolors": "white", "linewidths": 0.6},
    Mark.FAILED_TO_RUN: {"marker": "x", "s": 28, "color": _BROKEN, "linewidths": 1.6},
}
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
            hatch=_HATCHES[index % len(_HATCHES)],
            linewidth=1.4,
            label=layer.caption,
        )
        for index, layer in enumerate(data.layers)
    ]
    if any(np.min(layer.exercised) < 0.5 for layer in data.layers):
        handles.append(Line2D([], [], color=MUTED, linestyle="dashed", linewidth=1, label="limit of exercised"))
    shapes = {Mark.PASS: ("o", _PASS, 5), Mark.FAIL: ("o", INK, 2.5), Mark.NOT_EXERCISED: ("o", "white", 4)}
    for mark, words in _WORDS.items():
        count = int(np.count_nonzero(data.marks == mark))
        if not count:
            continue
        marker, colour, size = shapes.get(mark, ("x", _BROKEN, 5.5))
        edge = {Mark.NOT_EXERCISED: MUTED, Mark.FAILED_TO_RUN: _BROKEN}.get(mark, "none")
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
