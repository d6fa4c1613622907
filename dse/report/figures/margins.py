"""How the runs lie about each bound, or designs at their worst condition: the margins as a cumulative distribution."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from dse.report.charts.chart import Axis, Chart, Points, Rule, Steps, bulk
from dse.report.content.data import ReportContent, RequirementRow
from dse.report.figures._judged import JUDGED, bounds, counted, hidden
from dse.report.verdicts import Mark, conditions_of, deciding_runs, margins


class Margins:
    """For each requirement the share of what it judges that has at most some margin: at 0, the share that fails."""

    title = "Margins of the requirements"

    def charts(self, content: ReportContent) -> Sequence[Chart]:
        """One chart for each requirement that judged a run with a finite margin."""
        charts = (_chart(content, requirement) for requirement in content.requirements)
        return [chart for chart in charts if chart]


FIGURE = Margins()


def _chart(content: ReportContent, requirement: RequirementRow) -> Chart | None:
    metric = content.metric(requirement.metric)
    deciding, marks = deciding_runs(content, requirement)
    noun = "designs" if conditions_of(content) else "runs"
    margin = margins(metric.values, requirement)[deciding]
    judged = marks <= Mark.FAIL
    # An undefined metric fails: for the shares it lies below every bound.
    rows = np.flatnonzero(judged)
    rows = rows[np.argsort(np.where(np.isnan(margin[rows]), -np.inf, margin[rows]), kind="stable")]
    shares = 100 * np.arange(1, len(rows) + 1) / max(1, len(rows))
    drawn = np.isfinite(margin[rows])
    if not drawn.any():
        return None
    rows, shares = rows[drawn], shares[drawn]
    low, high = bulk(margin[rows], 0.0)
    points = tuple(
        Points(margin[rows][chosen], shares[chosen], content.runs.numbers[deciding[rows]][chosen], words, verdict)
        for verdict, words in JUDGED
        if (chosen := marks[rows] == verdict).any()
    )
    before = shares[0] - 100 / np.count_nonzero(judged)
    steps = Steps(np.concatenate([margin[rows][:1], margin[rows]]), np.concatenate([[before], shares]))
    words = " and ".join(words for _, words in bounds(requirement, metric))
    return Chart(
        requirement.name,
        f"{requirement.title or requirement.name}: {metric.title or metric.name} {words}",
        Axis(f"margin of {metric.title or metric.name}", metric.unit_symbol, low=low, high=high),
        Axis(f"{noun} with at most this margin", "%"),
        (steps, Rule("x", 0.0, f"bound: {words}"), *points),
        counted(marks, noun) + hidden(margin, judged, low, high),
    )
