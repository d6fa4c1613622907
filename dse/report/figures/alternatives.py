"""What each alternative brings: a metric in all runs that have it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from dse.report.content.data import MetricColumn, ReportContent, label
from dse.report.drawing.sheets import axes_of, gridded, say, sheet, style, ticks
from dse.report.drawing.style import CURRENT, INK, MUTED
from dse.report.figure import PrintOnly, View

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

_ABSENT = "left out"


class Alternatives(PrintOnly):
    """A box for each alternative of every place in which runs differ, for each required metric."""

    title = "What alternatives bring"

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:  # noqa: ARG002  # of all
        """One for each required metric; none where all runs are of one configuration."""
        choices = {entry.id: entry.choices for entry in content.configurations}
        places = dict.fromkeys(place for each in choices.values() for place in each)
        chosen = {p: [choices[name].get(p, _ABSENT) for name in content.runs.configurations] for p in places}
        differing = {place: np.array(names) for place, names in chosen.items() if len(set(names)) > 1}
        for name in dict.fromkeys(requirement.metric for requirement in content.requirements) if differing else ():
            yield f"alternatives_{name}", _draw(content.title, content.metric(name), differing)


FIGURE = Alternatives()


def _draw(title: str, metric: MetricColumn, differing: dict[str, np.ndarray]) -> Sheet:
    finite = np.isfinite(metric.values)
    groups = [
        (f"{alternative} ({place})", metric.values[finite & (chosen == alternative)])
        for place, chosen in differing.items()
        for alternative in np.unique(chosen)
    ]
    groups = [(name, values) for name, values in groups if len(values)][::-1]
    note = "Boxes hold the middle half of the runs, whiskers all but a tenth at either end; beside them their number."
    names, values = [name for name, _ in groups], [values for _, values in groups]
    with style():
        figure = sheet(f"{title}: {metric.title or metric.name}", note, width=7.2, height=1.6 + 0.3 * len(groups))
        (axes,) = axes_of(figure)
        look = {"color": MUTED, "linewidth": 0.9}
        drawn = axes.boxplot(
            values,
            positions=range(len(groups)),
            orientation="horizontal",
            whis=(10, 90),
            showfliers=False,
            widths=0.6,
            patch_artist=True,
            manage_ticks=False,
            medianprops={"color": INK, "linewidth": 1.6},
            whiskerprops=look,
            capprops=look,
            boxprops={"facecolor": CURRENT, "alpha": 0.35, "edgecolor": CURRENT},
        )
        for position, (upper, several) in enumerate(zip(drawn["caps"][1::2], values, strict=True)):
            end = float(upper.get_xdata()[0])
            axes.annotate(f" {len(several):,}", (end, position), va="center", fontsize=7, color=MUTED)
        ticks(axes, "y", names)
        say(axes, xlabel=label(metric.title or metric.name, metric.unit_symbol))
        gridded(axes, "x")
        return figure
