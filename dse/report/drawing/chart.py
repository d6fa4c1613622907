"""Draws any chart with matplotlib, as the page does on its canvas."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.report.charts.chart import Axis, Band, Bars, Chart, Drawn, Line, Points, Rule, Steps, limits
from dse.report.content.data import label
from dse.report.drawing.style import COLOURS, LINE, MARKS, MUTED, STYLE, TARGET
from dse.report.verdicts import Mark

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def draw_chart(chart: Chart) -> Figure:
    """The chart with its legend below and its note under that."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.4, 4.4), layout="constrained")
        axes = figure.add_subplot()
        axes.set_title("\n".join(textwrap.wrap(chart.title, 64)), loc="left", parse_math=False)
        (x_limits, y_limits) = limits(chart)
        axes.set(xlim=x_limits, ylim=y_limits, xscale=_scale(chart.x), yscale=_scale(chart.y))
        axes.set_xlabel(_text(chart.x), parse_math=False)
        axes.set_ylabel(_text(chart.y), parse_math=False)
        if chart.x.names:
            axes.set_xticks(range(len(chart.x.names)), chart.x.names, parse_math=False)
        if chart.y.names:
            axes.set_yticks(range(len(chart.y.names)), chart.y.names, parse_math=False)
        axes.grid(color=LINE, linewidth=0.7)
        axes.set_axisbelow(True)
        axes.spines[["top", "right"]].set_visible(False)
        series = 0
        for place, drawn in enumerate(chart.drawn):
            _draw(axes, drawn, COLOURS[series % len(COLOURS)], 2 + place / len(chart.drawn))
            series += not isinstance(drawn, Rule) and not (isinstance(drawn, Points) and drawn.verdict is not None)
        note = "\n".join(textwrap.wrap(chart.note, 115))
        look: dict[str, Any] = {
            "title": note,
            "alignment": "left",
            "title_fontsize": 7.5,
            "fontsize": 8,
            "frameon": False,
        }
        handles, labels = axes.get_legend_handles_labels()
        legend = figure.legend(handles, labels, loc="outside lower left", ncols=4, markerscale=1.4, **look)
        for text in (legend.get_title(), *legend.get_texts()):
            text.set_parse_math(False)
        legend.get_title().set_color(MUTED)
        return figure


def _scale(axis: Axis) -> str:
    return "log" if axis.log else "linear"


def _text(axis: Axis) -> str:
    return axis.label if axis.names else label(axis.label, axis.unit)


def _draw(axes: Axes, drawn: Drawn, colour: str, order: float) -> None:
    named: dict[str, Any] = {"label": _shown(drawn.label), "zorder": order}
    match drawn:
        case Line():
            axes.plot(drawn.x, drawn.y, color=colour, linewidth=1.6, **named)
        case Steps():
            axes.step(drawn.x, drawn.y, where="post", color=colour, linewidth=1.3, **named)
        case Points():
            style: dict[str, Any] = {"marker": "o", "s": 13, "facecolors": colour}
            if drawn.verdict is not None:
                style = MARKS[drawn.verdict]
            if drawn.verdict is Mark.PASS:
                style = {**style, "edgecolors": "none"}  # rims would wipe out close neighbours
            style["s"] *= float(np.clip(400 / max(1, len(drawn.x)), 0.2, 1))
            axes.scatter(drawn.x, drawn.y, **named, **style)
        case Bars():
            centres, widths = (drawn.edges[:-1] + drawn.edges[1:]) / 2, drawn.edges[1:] - drawn.edges[:-1]
            bars = axes.bar(centres, drawn.heights, widths, color=colour, **named)
            for bar in bars:
                bar.set(edgecolor="white", linewidth=0.6)
        case Band():
            area = axes.fill_between(drawn.x, drawn.low, drawn.high, **named)
            area.set(color=colour, alpha=0.22, linewidth=0)
        case Rule():
            rule = axes.axvline if drawn.axis == "x" else axes.axhline
            rule(drawn.value, color=TARGET, linewidth=1.3, dashes=(5, 3), **named)


def _shown(text: str) -> str:
    """What matplotlib takes for a label: one that begins with an underscore would be left out of the legend."""
    return f"\N{ZERO WIDTH SPACE}{text}" if text.startswith("_") else text or "_nolegend_"
