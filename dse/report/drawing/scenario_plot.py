"""A scenario for print: the paths of its entities on a map, and its storyboard over time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.report.drawing.road_picture import RoadPicture, around_points
from dse.report.drawing.road_plot import draw_map
from dse.report.drawing.sheets import gridded, style
from dse.report.drawing.style import COLOURS, LINE, MUTED

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

StoryboardRow = tuple[str, str, float | None, float | None]
"""Kind, name, start and completion in s; None: it did not begin, or did not complete."""

_WIDTH, _ROW = 7.2, 0.24
_LEAST, _MOST = 1.6, 5.0
"""Inches of the map's height."""
_MARGIN = 12.0


def draw_scenario(title: str, picture: RoadPicture | None, rows: Sequence[StoryboardRow], end: float) -> Figure:
    """The map around the paths of *picture*, to scale unless it would be too flat, and a bar for each of *rows*.

    A bar is from start to completion; one that did not complete has an open end at *end* (s).
    """
    from matplotlib.figure import Figure

    points = (
        np.concatenate([np.stack([d.x, d.y], axis=1) for d in picture.driven]) if picture and picture.driven else None
    )
    box = None if points is None else around_points(points, _MARGIN)
    scaled = 0.0 if box is None else (_WIDTH - 0.9) * box.tall / box.wide
    tall = 0.0 if box is None else float(np.clip(scaled, _LEAST, _MOST))
    bars = max(len(rows), 1) * _ROW + 0.6
    with style():
        figure = Figure(figsize=(_WIDTH, tall + bars + 1.2), layout="constrained")
        figure.suptitle(title, x=0.01, ha="left", fontsize=10, fontweight="bold", parse_math=False)
        panels = [tall, bars] if tall else [bars]
        grid = figure.add_gridspec(len(panels), 1, height_ratios=panels)
        if picture is not None and box is not None:
            axes = figure.add_subplot(grid[0])
            draw_map(axes, picture, box, max(box.wide / (_WIDTH - 0.9), box.tall / tall) / 72)
            if scaled < _LEAST:
                axes.set_aspect("auto")
            _named(axes, picture)
            axes.legend(fontsize=7, frameon=False, ncols=4, loc="lower left", bbox_to_anchor=(0, 1))
            axes.tick_params(labelsize=8)
        _bars(figure.add_subplot(grid[-1]), rows, end)
    return figure


def _named(axes: Axes, picture: RoadPicture) -> None:
    """A name for each path, and a dot at its start."""
    lines = axes.get_lines()[-len(picture.driven) :]
    for line, driven in zip(lines, picture.driven, strict=True):
        line.set_label(driven.label)
        axes.plot(driven.x[:1], driven.y[:1], marker="o", markersize=3.5, color=line.get_color(), zorder=5)


def _bars(axes: Axes, rows: Sequence[StoryboardRow], end: float) -> None:
    kinds = list(dict.fromkeys(kind for kind, *_ in rows))
    gridded(axes, "x")
    axes.set_axisbelow(True)
    for number, (kind, _, start, completion) in enumerate(rows):
        colour = COLOURS[kinds.index(kind) % len(COLOURS)]
        axes.axhline(number, color=LINE, linewidth=0.6, zorder=0)
        if start is None:
            axes.text(0.01 * end, number, "did not begin", va="center", fontsize=7, color=MUTED)
            continue
        last = end if completion is None else completion
        axes.barh(number, max(last - start, 0.004 * end), left=start, height=0.6, color=colour, zorder=2)
        if completion is None:
            axes.plot([end], [number], marker=">", color=colour, markersize=5, clip_on=False)
    axes.set_yticks(range(len(rows)), [f"{kind} {name}" for kind, name, *_ in rows], parse_math=False)
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.set_xlim(0.0, end)
    axes.set_xlabel("time (s)")
    axes.tick_params(labelsize=8)
