"""Designs by what is looked for: one objective over another, or the first over the requirement's metric."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dse.domain.sampler import Role
from dse.exploration import equal_rows, front_of
from dse.report.charts.chart import Axis, Chart, Line, Points, Rule
from dse.report.content.data import Floats, ReportContent, ReportVariable
from dse.report.drawing.chart import draw_chart
from dse.report.figure import PrintOnly, View
from dse.report.verdicts import Mark, alike, conditions_of, worst_marks

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

_WORDS = {Mark.FAIL: "fail", Mark.NOT_EXERCISED: "undecided", Mark.PASS: "pass"}


class Front(PrintOnly):
    """Runs over two objectives at a time, and the front of those that pass; on the page a view shows designs."""

    title = "Objectives"

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:  # noqa: ARG002  # of all
        """One for each pair of objectives; of a single one, over the metric of each requirement."""
        looked_for = [_objective(content, index) for index in range(len(content.objectives))]
        pairs = list(combinations(looked_for, 2))
        if len(looked_for) == 1:
            required = dict.fromkeys(requirement.metric for requirement in content.requirements)
            pairs = [(_metric(content, name), looked_for[0]) for name in required if name != content.objectives[0].name]
        for number, (x, y) in enumerate(pairs, 1):
            yield f"front_{number}", draw_chart(_chart(content, x, y, f"pair{number}"))


FIGURE = Front()

_Quantity = tuple[str, str, Floats, int, float | None]
"""Title, unit, a value for each run, whether small (1) or large (-1) is better, and a bound of what is required."""


def _objective(content: ReportContent, index: int) -> _Quantity:
    entry = content.objectives[index]
    sense = -1 if entry.maximize else 1
    if entry.is_property:
        totals = {each.id: each.properties.get(entry.name) for each in content.configurations}
        values = np.array([np.nan if (p := totals[name]) is None else p.value for name in content.runs.configurations])
        unit = next((each.unit_symbol for each in totals.values() if each is not None), "")
        return entry.name, unit, values, sense, None
    known = (*content.metrics, *content.composites)
    column = next(column for column in known if column.name == entry.name)
    return column.title or column.name, column.unit_symbol, column.values, sense, None


def _metric(content: ReportContent, name: str) -> _Quantity:
    metric = content.metric(name)
    bounds = next(r for r in content.requirements if r.metric == name)
    bound = bounds.at_most if bounds.at_most is not None else bounds.at_least
    sense = 1 if bounds.at_most is not None else -1
    return metric.title or name, metric.unit_symbol, metric.values, sense, bound


def _chart(content: ReportContent, x: _Quantity, y: _Quantity, name: str) -> Chart:
    conditions = conditions_of(content)
    designs = alike(content, [each.name for each in content.variables if each.role == Role.DESIGN])
    marks = worst_marks(content, designs, conditions)
    numbers = np.array([content.runs.numbers[rows[0]] for rows in designs])
    across, up = (_at_worst(each, designs, conditions) for each in (x, y))
    there = np.isfinite(across) & np.isfinite(up)
    drawn: list[Points | Line | Rule] = [
        Points(across[chosen], up[chosen], numbers[chosen], words, mark)
        for mark, words in _WORDS.items()
        if len(chosen := np.flatnonzero((marks == mark) & there))
    ]
    passing = np.flatnonzero((marks == Mark.PASS) & there)
    if x[4] is None and len(passing):  # a requirement is met or not: more margin is no objective
        front = passing[front_of(np.column_stack([x[3] * across[passing], y[3] * up[passing]]))]
        front = front[np.argsort(across[front], kind="stable")]
        drawn.append(Line(across[front], up[front], "front of the designs that pass"))
    if x[4] is not None:
        drawn.append(Rule("x", x[4], "bound"))
    names = " over ".join(each[0] for each in (y, x))
    note = "A point is a design at its worst condition." if len(designs) < len(content.runs) else "A point is a run."
    return Chart(name, f"{content.title}: {names}", Axis(x[0], x[1]), Axis(y[0], y[1]), tuple(drawn), note)


def _at_worst(quantity: _Quantity, designs: Sequence[NDArray[np.intp]], conditions: Sequence[ReportVariable]) -> Floats:
    """The mean over what is uncertain, at the condition where that is worst."""
    _, _, values, sense, _ = quantity
    at = np.column_stack([np.zeros(len(values)), *(each.values for each in conditions)])
    means = [[values[rows[case]].mean() for case in equal_rows(at[rows])] for rows in designs]
    return np.array([sense * max(sense * mean for mean in each) for each in means])
