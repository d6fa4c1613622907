"""The constraint plot, as the paper's Figure 6; the page draws its own, which the reader can move."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from dse.domain.sampler import Role
from dse.errors import fail
from dse.exploration import equal_rows
from dse.report.content.data import Floats, ReportContent, ReportVariable, RequirementRow, label
from dse.report.drawing.constraint_plot import ConstraintPlotData, Line, RequirementLayer, draw_constraint_plot
from dse.report.figure import PrintOnly, View
from dse.report.interpolation.planes import Plane, PlaneFields, plane_of
from dse.report.verdicts import alike, conditions_of, margins, outside, worst_marks
from dse.units import shown

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


_EXERCISED = 0.5


def constraint_plot_data(content: ReportContent, x: str, y: str, configuration: str) -> ConstraintPlotData:
    """Figure 6 over the variables *x* and *y*, other design variables at their nominal value, at the worst condition.

    DseError if it has no such.
    """
    horizontal, vertical = _variable(content, x), _variable(content, y)
    if x == y:
        raise fail(f"a constraint plot needs two different variables, not '{x}' twice")
    if configuration not in {entry.id for entry in content.configurations}:
        raise fail(f"the study has no configuration '{configuration}'")
    planes = _planes(content, x, y, configuration)
    fields = [plane.fields for plane in planes if plane.fields]
    note = planes[0].note
    if any(each.known.shape != fields[0].known.shape for each in fields) or len(fields) < len(planes):
        notes = {plane.note for plane in planes}
        fields, note = [], planes[0].note if len(notes) == 1 else "Too few runs of this plane: no boundaries."
    pooled = _pooled(content, x, y)
    rows, strength = _designs(content, pooled, planes)
    return ConstraintPlotData(
        title=content.title if len(planes) == 1 else f"{content.title}: worst of {len(planes)} conditions",
        x_label=label(horizontal.title, horizontal.unit_symbol),
        y_label=label(vertical.title, vertical.unit_symbol),
        x_range=(horizontal.low, horizontal.high),
        y_range=(vertical.low, vertical.high),
        xs=fields[0].xs if fields else np.empty(0),
        ys=fields[0].ys if fields else np.empty(0),
        layers=tuple(
            _layer(content, requirement, fields)
            for requirement in content.requirements
            if fields and (requirement.applies is None or any(requirement.applies[r].any() for r in rows))
        ),
        known=np.min([each.known for each in fields], axis=0) if fields else np.empty((0, 0)),
        points=np.array([[horizontal.values[one[0]], vertical.values[one[0]]] for one in rows]).reshape(-1, 2),
        marks=worst_marks(content, rows, pooled),
        strength=strength,
        note=note,
        x_apart=_apart(horizontal),
        y_apart=_apart(vertical),
        log=(horizontal.log, vertical.log),
    )


def _apart(variable: ReportVariable) -> dict[float, str]:
    return {value: variable.labels[int(value)] if variable.labels else shown(value) for value in variable.apart}


def _planes(content: ReportContent, x: str, y: str, configuration: str) -> list[Plane]:
    """One at each condition that runs of the configuration were made at."""
    varied = _pooled(content, x, y)
    rows = content.rows_of(configuration)
    points = np.column_stack([np.zeros(len(rows)), *(variable.values[rows] for variable in varied)])
    cases = [points[each[0], 1:] for each in equal_rows(points)] or [np.array([v.nominal for v in varied])]
    names = [variable.name for variable in varied]
    return [plane_of(content, x, y, configuration, dict(zip(names, case.tolist(), strict=True))) for case in cases]


def _pooled(content: ReportContent, x: str, y: str) -> list[ReportVariable]:
    """The conditions over which designs are judged: those on no axis."""
    return [variable for variable in conditions_of(content) if variable.name not in (x, y)]


def _designs(
    content: ReportContent, pooled: Sequence[ReportVariable], planes: Sequence[Plane]
) -> tuple[list[NDArray[np.intp]], Floats]:
    """The runs of each point, which differ in conditions only, and how strongly it is shown."""
    strength = np.zeros(len(content.runs))
    for plane in planes:
        strength[plane.rows] = plane.strength
    groups = alike(content, [each.name for each in content.variables if each not in pooled])
    shown = [rows for rows in groups if strength[rows[0]] > 0]
    return shown, np.array([strength[rows[0]] for rows in shown])


def axis_pairs(content: ReportContent) -> list[tuple[str, str]]:
    """The pairs of design variables to draw constraint plots over: one for each slice, else the first two variables.

    A condition is an axis only where there is a single design variable.
    """
    pairs = [(names[0], names[1]) for names in content.slices if len(names) > 1]
    if pairs or len(content.variables) < 2:
        return pairs
    first, second = sorted(content.variables, key=lambda each: each.role == Role.CONDITION)[:2]
    return [(first.name, second.name)]


def _variable(content: ReportContent, name: str) -> ReportVariable:
    try:
        return content.variable(name)
    except KeyError:
        known = ", ".join(variable.name for variable in content.variables) or "none"
        raise fail(f"the study has no design variable '{name}'", hint=f"its design variables: {known}") from None


def _layer(content: ReportContent, requirement: RequirementRow, fields: Sequence[PlaneFields]) -> RequirementLayer:
    """The smallest margin of any condition at which the requirement is exercised."""
    metric = content.metric(requirement.metric)
    margin = np.array([margins(each.metric(metric), requirement) for each in fields])
    exercised = np.array([each.exercised(requirement) for each in fields])
    counted = (exercised >= _EXERCISED) | (exercised < _EXERCISED).all(axis=0)
    least = np.where(counted, margin, np.inf).min(axis=0)
    boundary = _zero_lines(fields[0].xs, fields[0].ys, least)
    caption = f"{metric.title or metric.name} {outside(requirement)} {metric.unit_symbol}".rstrip()
    return RequirementLayer(requirement.title or requirement.name, caption, least, exercised.max(axis=0), boundary)


def _zero_lines(xs: Floats, ys: Floats, margin: Floats) -> tuple[Line, ...]:
    import contourpy

    generator = contourpy.contour_generator(xs, ys, margin, name="serial")
    return tuple(np.asarray(line, dtype=np.float64) for line in generator.lines(0.0))


class Constraints(PrintOnly):
    """A hatch and a line per requirement over two design variables, drawn for print only."""

    title = "Constraint plot"

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:
        """Figure 6 over the axes asked for, else over each slice of the study. Raises DseError if it has no such."""
        pairs = [(view.x, view.y)] if view.x and view.y else axis_pairs(content)
        configuration = view.configuration or next((entry.id for entry in content.configurations), "")
        for x, y in pairs:
            data = constraint_plot_data(content, x, y, configuration)
            yield f"constraints_{x}_{y}", draw_constraint_plot(data)


FIGURE = Constraints()
