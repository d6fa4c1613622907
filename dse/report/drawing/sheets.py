"""Sheets of axes for figures that the page shows in views of its own."""

from __future__ import annotations

import textwrap
from typing import TYPE_CHECKING, Any, Literal

from dse.report.drawing.style import LINE, MUTED, STYLE

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from contextlib import AbstractContextManager

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LETTERS = 60


def style() -> AbstractContextManager[None]:
    """How everything looks that is drawn inside."""
    import matplotlib as mpl

    return mpl.rc_context(STYLE)


def sheet(title: str, note: str, *, width: float = 6.4, height: float = 4.4, rows: int = 1, columns: int = 1) -> Figure:
    """An empty sheet, in inches, of *rows* of *columns* axes, its note below."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    figure.suptitle(
        "\n".join(textwrap.wrap(title, int(width * 11))),
        x=0.01,
        ha="left",
        fontsize=10,
        fontweight="bold",
        parse_math=False,
    )
    figure.subplots(rows, columns, squeeze=False)
    if note:
        text = "\n".join(textwrap.wrap(note, int(width * 18)))
        figure.supxlabel(text, x=0.01, ha="left", fontsize=7.5, color=MUTED, fontweight="normal", parse_math=False)
    return figure


def axes_of(figure: Figure) -> Iterator[Axes]:
    """Its axes, row by row, each with the common look."""
    for axes in figure.axes:
        axes.spines[["top", "right"]].set_visible(False)
        axes.set_axisbelow(True)
        yield axes


def say(axes: Axes, **texts: str) -> None:
    """Set *title*, *xlabel*, *ylabel*: what a user named is no formula."""
    for name, text in texts.items():
        where: dict[str, Any] = {"loc": "left", "fontsize": 9} if name == "title" else {}
        getattr(axes, f"set_{name}")(textwrap.shorten(text, _LETTERS, placeholder="…"), parse_math=False, **where)


def ticks(axes: Axes, along: str, names: Sequence[str], *, first: float = 0.0, slanted: bool = False) -> None:
    """Name the positions *first*, *first* + 1, … *along* x or y."""
    shown = [textwrap.shorten(name, _LETTERS // 2, placeholder="…") for name in names]
    look: dict[str, Any] = {"rotation": 30, "ha": "right", "rotation_mode": "anchor"} if slanted else {}
    getattr(axes, f"set_{along}ticks")([first + n for n in range(len(shown))], shown, parse_math=False, **look)


def gridded(axes: Axes, along: Literal["x", "y"]) -> None:
    """Lines across the axis *along*."""
    axes.grid(color=LINE, linewidth=0.7, axis=along)
