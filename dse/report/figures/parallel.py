"""Every run as a line through its variables and required metrics."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.report.content.data import Floats, ReportContent, ReportVariable, label
from dse.report.drawing.sheets import axes_of, sheet, style, ticks
from dse.report.drawing.style import MUTED, PASS
from dse.report.figure import PrintOnly, View
from dse.report.verdicts import Mark, conditions_of, marks_of_designs

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

_MOST = 1500
"""Lines that can be told apart at best."""

_AXES = 14


class Parallel(PrintOnly):
    """Parallel coordinates; on the page a view lets the reader choose and limit axes."""

    title = "Runs in parallel coordinates"

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:  # noqa: ARG002  # of all
        """One, of a study that varies something."""
        required = dict.fromkeys(requirement.metric for requirement in content.requirements)
        shown = [(v.title if v.labels else label(v.title, v.unit_symbol), *_spaced(v)) for v in content.variables]
        shown += [(label(m.title or n, m.unit_symbol), m.values, ()) for n in required for m in [content.metric(n)]]
        varied = [each for each in shown if len(np.unique(each[1][np.isfinite(each[1])])) > 1]
        if content.variables and len(varied) > 1:
            yield "parallel", _draw(content, varied[:_AXES], len(varied))


FIGURE = Parallel()


def _draw(content: ReportContent, shown: Sequence[tuple[str, Floats, Sequence[str]]], all_: int) -> Sheet:
    marks = marks_of_designs(content)
    order = np.argsort(marks == Mark.PASS, kind="stable")  # those that pass lie on top
    rows = order[np.linspace(0, len(order) - 1, min(_MOST, len(order))).astype(int)]
    places, ends = zip(*(_scaled(values) for _, values, _ in shown), strict=True)
    lines = np.column_stack(places)[rows]
    green = f"meets every requirement{', as its design does at all conditions' * bool(conditions_of(content))}"
    text = f"{len(rows):,} of {len(marks):,} runs; green: {green}; a gap is an undefined value."
    note = text + (f" The first {len(shown)} of {all_} axes." if all_ > len(shown) else "")
    with style():
        figure = sheet(content.title, note, width=max(6.4, 1.1 * len(shown)), height=4.0)
        (axes,) = axes_of(figure)
        for row, line in zip(rows.tolist(), lines, strict=True):
            passes = marks[row] == Mark.PASS
            axes.plot(line, color=PASS if passes else MUTED, alpha=0.35 if passes else 0.12, linewidth=0.7)
        for position, (low, high) in enumerate(ends):
            axes.axvline(position, color=MUTED, linewidth=0.8)
            texts = shown[position][2]
            for step, text in enumerate(texts):
                height = step / (len(texts) - 1)
                inside = {"facecolor": "white", "edgecolor": "none", "pad": 0.8, "alpha": 0.8}
                axes.annotate(text, (position, height), (3, 3), textcoords="offset points", fontsize=7, bbox=inside)
            if texts:
                continue
            for end, height, where in ((low, -0.02, "top"), (high, 1.02, "bottom")):
                axes.annotate(f"{end:.4g}", (position, height), ha="center", va=where, fontsize=7)
        axes.set(ylim=(-0.1, 1.1), xlim=(-0.3, len(shown) - 0.7), yticks=[])
        axes.spines[:].set_visible(False)
        axes.tick_params(axis="x", length=0)
        ticks(axes, "x", [title for title, *_ in shown], slanted=len(shown) > 5)
        return figure


def _spaced(variable: ReportVariable) -> tuple[Floats, Sequence[str]]:
    """The values of a variable; where they are apart their positions, evenly spaced, and the text of each."""
    if len(variable.apart) < 2:
        return variable.values, ()
    texts = [variable.labels[int(value)] if variable.labels else f"{value:.6g}" for value in variable.apart]
    return np.interp(variable.values, variable.apart, np.arange(len(texts))), texts


def _scaled(values: Floats) -> tuple[Floats, tuple[float, float]]:
    """Where values lie on their axis, 0 … 1, and its ends."""
    known = values[np.isfinite(values)]
    low, high = float(known.min()), float(known.max())
    return np.where(np.isfinite(values), (values - low) / (high - low), np.nan), (low, high)
