"""Verdicts over the conditions of a study: at each, the share of the runs that pass."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np

from dse.report.content.data import ReportContent, ReportVariable, label
from dse.report.drawing.sheets import axes_of, say, sheet, style, ticks
from dse.report.figure import PrintOnly, View
from dse.report.verdicts import Mark, Marks, marks_of, overall_marks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Sheet

_MOST = 24
"""Values of a condition that a matrix has room for."""


class Conditions(PrintOnly):
    """A matrix of the first two conditions for all requirements, and for each; on the page a view shows them."""

    title = "Verdicts over the conditions"

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:  # noqa: ARG002  # of all
        """One for all requirements, one for each if there are several."""
        axes = [each for each in content.variables if each.role == "condition" and len(np.unique(each.values)) <= _MOST]
        if not axes or not content.requirements:
            return
        yield "conditions", _draw(content, axes[:2], "all requirements", overall_marks(content))
        for requirement in content.requirements if len(content.requirements) > 1 else ():
            marks = marks_of(content, requirement)
            yield (
                f"conditions_{requirement.name}",
                _draw(content, axes[:2], requirement.title or requirement.name, marks),
            )


FIGURE = Conditions()


def _draw(content: ReportContent, conditions: Sequence[ReportVariable], what: str, marks: Marks) -> Sheet:
    across, *rest = conditions
    xs, x = np.unique(across.values, return_inverse=True)
    ys, y = np.unique(rest[0].values, return_inverse=True) if rest else (np.zeros(1), np.zeros(len(marks), dtype=int))
    shape = len(ys), len(xs)
    counts = np.zeros((*shape, len(Mark)), dtype=np.int64)
    np.add.at(counts, (y.reshape(-1), x.reshape(-1), marks), 1)
    judged = counts[..., Mark.PASS] + counts[..., Mark.FAIL]
    shares = np.where(judged, 100 * counts[..., Mark.PASS] / np.maximum(judged, 1), np.nan)
    note = "Share of the runs that pass, of those that exercise the requirement; below it how many these are."
    with style():
        figure = sheet(f"{content.title}: {what}", note, width=2.4 + 0.9 * len(xs), height=1.8 + 0.6 * len(ys))
        (axes,) = axes_of(figure)
        axes.pcolormesh(shares, cmap="RdYlBu", vmin=-25, vmax=125, edgecolors="white", linewidth=2)
        for (row, column), share in np.ndenumerate(shares):
            text = "not exercised" if np.isnan(share) else f"{share:.0f} %\n{judged[row, column]:,}"
            axes.text(column + 0.5, row + 0.5, text, ha="center", va="center", fontsize=8)
        _name(axes, "x", across, xs.tolist())
        if rest:
            _name(axes, "y", rest[0], ys.tolist())
        else:
            axes.set_yticks([])
        axes.spines[:].set_visible(False)
        return figure


def _name(axes: Axes, along: Literal["x", "y"], condition: ReportVariable, values: Sequence[float]) -> None:
    shown = [condition.labels[int(value)] if condition.labels else f"{value:g}" for value in values]
    ticks(axes, along, shown, first=0.5)
    text = condition.title if condition.labels else label(condition.title, condition.unit_symbol)
    say(axes, **{f"{along}label": text})
