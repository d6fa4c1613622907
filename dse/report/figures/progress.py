"""What each required metric was in run after run: how an adaptive search homes in on a bound."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dse.report.charts.chart import Axis, Chart, Points, Rule, bulk
from dse.report.content.data import ReportContent, RequirementRow
from dse.report.figures._judged import JUDGED, bounds, counted, hidden
from dse.report.verdicts import Mark, marks_of


class Progress:
    """For each requirement its metric over the number of the run, with the bounds."""

    title = "Progress of the study"

    def charts(self, content: ReportContent) -> Sequence[Chart]:
        """One chart for each requirement whose metric has a finite value."""
        charts = (_chart(content, requirement) for requirement in content.requirements)
        return [chart for chart in charts if chart]


FIGURE = Progress()


def _chart(content: ReportContent, requirement: RequirementRow) -> Chart | None:
    metric = content.metric(requirement.metric)
    marks = marks_of(content, requirement)
    finite = np.isfinite(metric.values) & content.runs.done
    if not finite.any():
        return None
    limits = bounds(requirement, metric)
    low, high = bulk(metric.values[finite], *(bound for bound, _ in limits))
    numbers = content.runs.numbers
    points = tuple(
        Points(numbers[chosen].astype(np.float64), metric.values[chosen], numbers[chosen], words, verdict)
        for verdict, words in (*JUDGED, (Mark.NOT_EXERCISED, "not exercised"))
        if (chosen := finite & (marks == verdict)).any()
    )
    return Chart(
        requirement.name,
        requirement.title or requirement.name,
        Axis("run number"),
        Axis(metric.title or metric.name, metric.unit_symbol, low=low, high=high),
        (*(Rule("y", bound, words) for bound, words in limits), *points),
        counted(marks) + hidden(metric.values, content.runs.done, low, high),
    )
