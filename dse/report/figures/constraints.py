"""The constraint plot, as the paper's Figure 6; the page draws its own, which the reader can move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.errors import fail
from dse.report.charts.chart import Chart
from dse.report.content.nouns import Floats, ReportContent, RequirementRow, Variable, label
from dse.report.drawing.constraint_plot import ConstraintPlotData, Line, RequirementLayer, draw_constraint_plot
from dse.report.figure import View
from dse.report.interpolation.planes import Plane, plane_of
from dse.report.verdicts import margins, outside, overall_marks

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


def constraint_plot_data(content: ReportContent, x: str, y: str, configuration: str) -> ConstraintPlotData:
    """Figure 6 over the variables *x* and *y*, the others at their nominal value. Raises DseError if it has no such."""
    horizontal, vertical = _variable(content, x), _variable(content, y)
    if x == y:
        raise fail(f"a constraint plot needs two different variables, not '{x}' twice")
    if configuration not in {entry.id for entry in content.configurations}:
        raise fail(f"the study has no configuration '{configuration}'")
    plane = plane_of(content, x, y, configuration)
    layers = tuple(_layer(content, requirement, plane) for requirement in content.requirements if plane.fields)
    return ConstraintPlotData(
        title=content.title,
        x_label=label(horizontal.title, horizontal.unit_symbol),
        y_label=label(vertical.title, vertical.unit_symbol),
        x_range=(horizontal.low, horizontal.high),
        y_range=(vertical.low, vertical.high),
        xs=plane.fields.xs if plane.fields else np.empty(0),
        ys=plane.fields.ys if plane.fields else np.empty(0),
        layers=layers,
        known=plane.fields.known if plane.fields else np.empty((0, 0)),
        points=np.stack([horizontal.values[plane.rows], vertical.values[plane.rows]], axis=1),
        marks=overall_marks(content)[plane.rows],
        strength=plane.strength,
        note=plane.note,
    )


def axis_pairs(content: ReportContent) -> list[tuple[str, str]]:
    """The pairs of design variables to draw constraint plots over: one for each slice, else the first two variables."""
    pairs = [(names[0], names[1]) for names in content.slices if len(names) > 1]
    if pairs or len(content.variables) < 2:
        return pairs
    return [(content.variables[0].name, content.variables[1].name)]


def _variable(content: ReportContent, name: str) -> Variable:
    try:
        return content.variable(name)
    except KeyError:
        known = ", ".join(variable.name for variable in content.variables) or "none"
        raise fail(f"the study has no design variable '{name}'", hint=f"its design variables: {known}") from None


def _layer(content: ReportContent, requirement: RequirementRow, plane: Plane) -> RequirementLayer:
    assert plane.fields is not None  # noqa: S101  # the caller asks for layers only where there are fields
    metric = content.metric(requirement.metric)
    margin = margins(plane.fields.metric(metric), requirement)
    exercised = plane.fields.exercised(requirement)
    boundary = _zero_lines(plane.fields.xs, plane.fields.ys, margin)
    caption = f"{metric.title or metric.name} {outside(requirement)} {metric.unit_symbol}".rstrip()
    return RequirementLayer(requirement.title or requirement.name, caption, margin, exercised, boundary)


def _zero_lines(xs: Floats, ys: Floats, margin: Floats) -> tuple[Line, ...]:
    import contourpy

    generator = contourpy.contour_generator(xs, ys, margin, name="serial")
    return tuple(np.asarray(line, dtype=np.float64) for line in generator.lines(0.0))


class Constraints:
    """A hatch and a line per requirement over two design variables, drawn for print only."""

    title = "Constraint plot"

    def charts(self, content: ReportContent) -> Sequence[Chart]:  # noqa: ARG002  # the page has a plot of its own
        """None: the page's plot follows thresholds and sliders."""
        return ()

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:
        """Figure 6 over the axes asked for, else over each slice of the study. Raises DseError if it has no such."""
        pairs = [(view.x, view.y)] if view.x and view.y else axis_pairs(content)
        configuration = view.configuration or next((entry.id for entry in content.configurations), "")
        for x, y in pairs:
            data = constraint_plot_data(content, x, y, configuration)
            yield f"constraints_{x}_{y}", draw_constraint_plot(data)


FIGURE = Constraints()
