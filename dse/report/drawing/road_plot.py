"""A road network for print: the map to scale, and below it what lies along the path that is driven."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from dse.report.content.data import Floats
from dse.report.drawing.road_picture import Along, MapExtent, RoadPicture, Strip, around, around_points, crossings
from dse.report.drawing.sheets import axes_of, gridded, say, style
from dse.report.drawing.style import COLOURS, CURRENT, INK, LINE, MUTED, TARGET

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_WIDTH, _LEAST, _MOST = 7.2, 0.9, 6.4
"""Inches: of the sheet, and of the map's height."""
_BELOW = 1.35
"""Inches of each panel below the map."""
_ASPHALT, _INSIDE, _BESIDE = "#c9ced6", "#d9dde3", "#e9eef0"


def draw_road(picture: RoadPicture) -> Figure:
    """The map, crossings enlarged, and below them lanes, height and bank, curvature over the station."""
    from matplotlib.figure import Figure

    whole = around(picture.strips, 2.0)
    for driven in picture.driven:
        whole = whole.joined(around_points(np.stack([driven.x, driven.y], axis=1), 2.0))
    height = float(np.clip((_WIDTH - 0.9) * whole.tall / whole.wide, _LEAST, _MOST))
    metres = max(whole.wide / (_WIDTH - 0.9), whole.tall / height) / 72  # that a point of the sheet stands for
    details = list(crossings(picture.strips))[:_MOST_DETAILS] if metres > _DETAIL else []
    heights = [height, *[_DETAILED] * bool(details), _BELOW, _BELOW * 0.8, _BELOW * 0.8]
    with style():
        figure = Figure(figsize=(_WIDTH, sum(heights) + 1.4), layout="constrained")
        figure.suptitle(picture.title, x=0.01, ha="left", fontsize=10, fontweight="bold", parse_math=False)
        rows = figure.add_gridspec(len(heights), 1, height_ratios=heights)
        plane = figure.add_subplot(rows[0])
        draw_map(plane, picture, whole, metres)
        _stations(plane, picture.along, metres)
        for number, box in enumerate(details):
            axes = figure.add_subplot(rows[1].subgridspec(1, len(details))[number])
            size = 0.8 * 72 * min(_DETAILED, _WIDTH / len(details))
            draw_map(axes, picture, box, max(box.wide, box.tall) / size)
        for row, draw in zip((-3, -2, -1), (_lanes, _profile, _bends), strict=True):
            axes = figure.add_subplot(rows[row])
            axes.set_xlim(0.0, float(picture.along.stations[-1]))
            gridded(axes, "x")
            draw(axes, picture)
        for axes in axes_of(figure):
            axes.tick_params(labelsize=8)
    return figure


_DETAIL = 0.3
"""Metres to a point of the sheet, above which crossings are enlarged."""
_DETAILED, _MOST_DETAILS = 2.5, 3


def draw_map(axes: Axes, picture: RoadPicture, box: MapExtent, metres: float) -> None:
    """What is in *box*, to scale; a point of the sheet stands for so many *metres*."""
    from matplotlib.collections import LineCollection, PolyCollection

    def fill(strips: Sequence[Strip], colour: str, order: float) -> None:
        outlines = [np.concatenate([strip.right, strip.left[::-1]]) for strip in strips]
        # A lane that would be thinner than the pen is as wide as the pen.
        axes.add_collection(
            PolyCollection(outlines, facecolors=colour, edgecolors=colour, linewidths=0.6, zorder=order)
        )

    fill([strip for strip in picture.strips if not strip.is_driven], _BESIDE, 1.0)
    fill([strip for strip in picture.strips if strip.is_driven and strip.is_inside], _INSIDE, 1.1)
    fill([strip for strip in picture.strips if strip.is_driven and not strip.is_inside], _ASPHALT, 1.2)
    outlines = [area.outline for area in picture.areas]
    axes.add_collection(
        PolyCollection(outlines, facecolors=COLOURS[3], edgecolors=COLOURS[3], linewidths=0.8, zorder=2)
    )
    lanes = [strip for strip in picture.strips if strip.is_driven and not strip.is_inside]
    if lanes and metres < 3.5 / 3:  # a lane is three points wide, so that its lines can be told apart
        sides = [side for strip in lanes for side in (strip.left, strip.right)]
        axes.add_collection(LineCollection(sides, colors="white", linewidths=0.7, zorder=2.1))
    if metres < 3.5 / 5:
        _arrows(axes, lanes, box, metres)
    axes.plot(picture.along.x, picture.along.y, color=MUTED, linewidth=0.8, dashes=(4, 3), zorder=3)
    if len(picture.lights):
        x, y = picture.lights.T
        axes.scatter(x, y, marker="o", s=16, facecolors=TARGET, edgecolors="white", linewidths=0.6, zorder=5)
    for driven, colour in zip(picture.driven, _colours(), strict=False):
        axes.plot(driven.x, driven.y, color=colour, linewidth=1.3, zorder=4.5)
    axes.set(xlim=(box.left, box.right), ylim=(box.below, box.above))
    axes.set_aspect("equal", adjustable="box")
    say(axes, xlabel="x [m]", ylabel="y [m]")


def _stations(axes: Axes, along: Along, metres: float) -> None:
    """Where the path begins, where it leads to, and stations on its right."""
    axes.plot(along.x[:1], along.y[:1], marker="o", markersize=4.5, color=INK, zorder=5)
    ahead = np.array([along.x[-1] - along.x[-2], along.y[-1] - along.y[-2]])
    tail = (along.x[-1], along.y[-1]) - ahead / np.hypot(*ahead) * 6 * metres
    look = {"arrowstyle": "-|>,head_width=0.2,head_length=0.4", "color": INK, "linewidth": 0.8}
    axes.annotate("", (along.x[-1], along.y[-1]), (tail[0], tail[1]), arrowprops=look, zorder=5)
    beside = 4.0 + 2.0 / metres  # points: half a lane, and some more
    for station in _ticks(float(along.stations[-1])):
        row = int(np.argmin(np.abs(along.stations - station)))
        ahead = np.array([along.x[row + 1] - along.x[row - 1], along.y[row + 1] - along.y[row - 1]])
        right, down = np.array([ahead[1], -ahead[0]]) / np.hypot(*ahead)
        axes.plot(along.x[row], along.y[row], marker="o", color=INK, markersize=2, zorder=4)
        axes.annotate(
            f"{station:g} m",
            (along.x[row], along.y[row]),
            xytext=(right * beside, down * beside),
            textcoords="offset points",
            ha="center" if abs(right) < 0.4 else "left" if right > 0 else "right",
            va="center" if abs(down) < 0.4 else "bottom" if down > 0 else "top",
            fontsize=6.5,
            color=INK,
            zorder=6,
        )


def _colours() -> Iterator[str]:
    yield CURRENT
    yield from COLOURS


def _ticks(length: float) -> list[float]:
    """Some stations with round numbers."""
    from matplotlib.ticker import MaxNLocator

    return [tick for tick in MaxNLocator(8, steps=[1, 2, 5, 10]).tick_values(0.0, length) if 0 < tick < 0.97 * length]


def _arrows(axes: Axes, lanes: Sequence[Strip], box: MapExtent, metres: float) -> None:
    """On each lane, in its middle, along its direction."""
    for strip in lanes:
        middle = (strip.left + strip.right) / 2
        along = np.append(0.0, np.cumsum(np.hypot(*np.diff(middle, axis=0).T)))
        dense = np.linspace(0.0, along[-1], 201)
        middle = np.stack([np.interp(dense, along, each) for each in middle.T], axis=1)
        middle = middle[box.holds(middle)]
        if len(middle) < 2:
            continue
        lengths = np.append(0.0, np.cumsum(np.hypot(*np.diff(middle, axis=0).T)))
        if lengths[-1] < 8 * metres:
            continue
        for share in (0.25, 0.75) if lengths[-1] > 100 * metres else (0.5,):
            row = int(np.clip(np.searchsorted(lengths, share * lengths[-1]), 1, len(middle) - 1))
            end, start = middle[row], middle[row - 1]
            heading = (end - start) / np.hypot(*(end - start))
            at = start + (end - start) * (share * lengths[-1] - lengths[row - 1]) / (lengths[row] - lengths[row - 1])
            axes.annotate(
                "",
                at + heading * 5 * metres,
                at - heading * 5 * metres,
                arrowprops={"arrowstyle": "-|>,head_width=0.13,head_length=0.28", "color": "white", "linewidth": 0.8},
                zorder=2.3,
            )


def _lanes(axes: Axes, picture: RoadPicture) -> None:
    along = picture.along
    for band in along.bands:
        axes.fill_between(
            along.stations, band.right, band.left, color=_ASPHALT if band.is_own else _INSIDE, linewidth=0
        )
        for side in (band.right, band.left):
            axes.plot(along.stations, side, color="white", linewidth=1.0)
    for area in along.areas:
        axes.fill(*area.outline.T, color=COLOURS[3], linewidth=0)
        low, high = area.outline.min(axis=0), area.outline.max(axis=0)
        look: dict[str, Any] = {"ha": "center", "va": "bottom", "fontsize": 6.5, "color": COLOURS[3]}
        axes.annotate(f"{area.friction:g}", ((low[0] + high[0]) / 2, high[1]), **look)
    for station in along.lights:
        axes.axvline(station, color=TARGET, linewidth=1.2)
    for driven, colour in zip(picture.driven, _colours(), strict=False):
        axes.plot(driven.station, driven.offset, color=colour, linewidth=1.3, label=driven.label)
    for station, limit in along.limits:
        text = f"{limit * 3.6:.0f} km/h" if limit else "no limit"
        axes.annotate(
            text,
            (station, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(2, 2),
            textcoords="offset points",
            fontsize=7,
            color=MUTED,
        )
    say(axes, ylabel="left of lane [m]")
    axes.margins(y=0.05)
    if picture.driven:
        legend = axes.legend(
            loc="lower right", bbox_to_anchor=(1, 1), ncols=3, frameon=False, fontsize=7, borderaxespad=0
        )
        for entry in legend.get_texts():
            entry.set_parse_math(False)
    axes.tick_params(labelbottom=False)


def _profile(axes: Axes, picture: RoadPicture) -> None:
    along = picture.along
    axes.plot(along.stations, along.height, color=CURRENT, linewidth=1.4)
    _room(axes, along.height, 1.0)
    say(axes, ylabel="height [m]")
    axes.yaxis.label.set_color(CURRENT)
    axes.tick_params(labelbottom=False)
    if not along.slope.any():
        return
    other = axes.twinx()
    other.spines["top"].set_visible(False)
    other.plot(along.stations, 100 * along.slope, color=COLOURS[0], linewidth=1.2, dashes=(5, 2))
    _room(other, 100 * along.slope, 1.0)
    other.set_ylabel("bank [%]")
    other.yaxis.label.set_color(COLOURS[0])


def _bends(axes: Axes, picture: RoadPicture) -> None:
    along = picture.along
    axes.axhline(0.0, color=LINE, linewidth=0.8)
    axes.plot(along.stations, 1000 * along.curvature, color=INK, linewidth=1.3)
    _room(axes, 1000 * along.curvature, 1.0)
    say(axes, ylabel="curvature [1/km]", xlabel="station [m]")


def _room(axes: Axes, values: Floats, least: float) -> None:
    """Limits around *values*, that do not make hills of rounding errors."""
    low, high = float(np.min(values)), float(np.max(values))
    middle, half = (low + high) / 2, max(high - low, least) / 2 * 1.15
    axes.set_ylim(middle - half, middle + half)
