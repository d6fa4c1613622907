"""How a search went: what it had found after a part of its runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from dse.report.charts.chart import Axis, Chart, Steps
from dse.report.content.data import ReportContent
from dse.report.drawing.chart import draw_chart
from dse.report.figure import PrintOnly, View

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


class Search(PrintOnly):
    """The best design, or the volume that the front dominates, by the number of runs."""

    title = "The search"
    uses_insight = True

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:  # noqa: ARG002  # of all
        """One, of a study with objectives that found a design."""
        search = content.insight.search if content.insight else None
        if search is None or not search.stages:
            return
        single = len(search.objectives) == 1
        runs = np.array([stage.runs for stage in search.stages], dtype=np.float64)
        values = np.array([stage.best if single else stage.volume for stage in search.stages], dtype=np.float64)
        if not np.isfinite(values).any():
            return
        axis = Axis(search.objectives[0], search.units[0]) if single else Axis("share that the front dominates")
        note = f"{search.feasible:,} of {search.designs:,} designs meet all requirements wherever they were run."
        title = f"{content.title}: {'best design' if single else 'volume of the front'}"
        yield "search", draw_chart(Chart("search", title, Axis("runs"), axis, (Steps(runs, values),), note))


FIGURE = Search()
