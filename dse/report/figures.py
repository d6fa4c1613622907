"""What the two figures of the paper show, as plain values; ``draw`` puts them on paper.

The constraint plot is the paper's Figure 6, the waveforms are its Figure 7.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from dse.errors import fail
from dse.report.content import FigureSpec, Floats, ReportContent, RequirementRow, Variable, label
from dse.report.planes import Plane, plane_of
from dse.report.verdicts import Mark, Marks, overall_marks

Line = NDArray[np.float64]
"""A polyline, (points, 2), in the units of the axes."""


@dataclass(frozen=True, slots=True, eq=False)
class RequirementLayer:
    """One requirement over the grid: *margin* (ny, nx) is negative where it fails, *exercised* at least 0.5 where it
    came into play; *boundary* are the lines of zero margin, exercised or not; *caption* says what makes it fail."""

    title: str
    caption: str
    margin: Floats
    exercised: Floats
    boundary: tuple[Line, ...]


@dataclass(frozen=True, slots=True, eq=False)
class ConstraintPlotData:
    """Figure 6: *xs* (nx,) and *ys* (ny,) span the grid of the *layers* and of *known*, which is below 0.5 where failed
    runs leave a hole; without regions they are empty and *note* says why. *points* (n, 2) are the runs with their
    *marks* (see Mark) and *strength*, 1 in the plane and less beside it.
    """

    title: str
    x_label: str
    y_label: str
    x_range: tuple[float, float]
    y_range: tuple[float, float]
    xs: Floats
    ys: Floats
    layers: tuple[RequirementLayer, ...]
    known: Floats
    points: Floats
    marks: Marks
    strength: Floats
    note: str

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Where on the grid every requirement is met and exercised, (ny, nx)."""
        met = self.known >= 0.5
        for layer in self.layers:
            met = met & (layer.margin >= 0) & (layer.exercised >= 0.5)
        return met


@dataclass(frozen=True, slots=True, eq=False)
class WaveformPanel:
    """One waveform of Figure 7 over *time* in seconds; *target* is None where the figure has none."""

    title: str
    y_label: str
    time: Floats
    current: Floats
    current_label: str
    target: Floats | None
    target_label: str


@dataclass(frozen=True, slots=True, eq=False)
class WaveformData:
    """Figure 7: the waveforms of one run, one above the other."""

    title: str
    panels: tuple[WaveformPanel, ...]


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


def waveform_data(content: ReportContent, run: int) -> WaveformData:
    """Figure 7 for run number *run*. Raises DseError if none of its waveforms was kept."""
    if run not in content.runs.numbers:
        raise fail(f"the study has no run {run}")
    panels = tuple(_panel(figure, run) for figure in content.figures if run in figure.kept)
    if not panels:
        raise fail(
            f"no waveform of run {run} was kept",
            hint=f"simulate it again with: dse replay {content.study_folder} {run}",
        )
    return WaveformData(f"Run {run} \u2013 {content.title}", panels)


def planes(content: ReportContent) -> list[tuple[str, str]]:
    """The pairs of design variables to draw constraint plots over: one for each slice, else the first two variables."""
    pairs = [(names[0], names[1]) for names in content.slices if len(names) > 1]
    if pairs or len(content.variables) < 2:
        return pairs
    return [(content.variables[0].name, content.variables[1].name)]


def default_axes(content: ReportContent) -> tuple[str, str]:
    """The variables a constraint plot shows unless told otherwise. Raises DseError if there are not two."""
    pairs = planes(content)
    if not pairs:
        raise fail("a constraint plot needs two design variables", hint="use the waveform figure or the run table")
    return pairs[0]


def default_run(content: ReportContent) -> int:
    """The number of the run to show unless told otherwise: kept, passing and as near as can be to every bound."""
    kept = sorted({int(number) for figure in content.figures for number in figure.kept})
    if not kept:
        raise fail(
            "no waveform was kept in this study", hint=f"dse replay {content.study_folder} RUN simulates one again"
        )
    rows = np.flatnonzero(np.isin(content.runs.numbers, kept) & (overall_marks(content) == Mark.PASS))
    if not len(rows):
        return kept[0]
    return int(content.runs.numbers[rows[np.argmin(_distance_to_bounds(content)[rows])]])


def _distance_to_bounds(content: ReportContent) -> Floats:
    """For every run its largest distance to a requirement's nearest bound, in spreads of the metric."""
    worst = np.zeros(len(content.runs))
    for requirement in content.requirements:
        values = content.metric(requirement.metric).values
        known = values[np.isfinite(values)]
        low, high = np.quantile(known, [0.1, 0.9]) if len(known) else (0.0, 1.0)
        bounds = [bound for bound in (requirement.at_most, requirement.at_least) if bound is not None]
        nearest = np.min([np.abs(values - bound) for bound in bounds], axis=0)
        worst = np.fmax(worst, nearest / max(1e-12, high - low))
    return worst


def _variable(content: ReportContent, name: str) -> Variable:
    try:
        return content.variable(name)
    except KeyError:
        known = ", ".join(variable.name for variable in content.variables) or "none"
        raise fail(f"the study has no design variable '{name}'", hint=f"its design variables: {known}") from None


def _layer(content: ReportContent, requirement: RequirementRow, plane: Plane) -> RequirementLayer:
    assert plane.fields is not None  # noqa: S101  # the caller asks for layers only where there are fields
    metric = content.metric(requirement.metric)
    values = plane.fields.metric(metric)
    margin = np.full(values.shape, np.inf)
    if requirement.at_least is not None:
        margin = np.minimum(margin, values - requirement.at_least)
    if requirement.at_most is not None:
        margin = np.minimum(margin, requirement.at_most - values)
    exercised = plane.fields.exercised(requirement)
    boundary = _zero_lines(plane.fields.xs, plane.fields.ys, margin)
    caption = f"{metric.title or metric.name} {_outside(requirement)} {metric.unit_symbol}".rstrip()
    return RequirementLayer(requirement.title or requirement.name, caption, margin, exercised, boundary)


def _outside(requirement: RequirementRow) -> str:
    if requirement.at_least is None:
        return f"> {requirement.at_most:g}"
    if requirement.at_most is None:
        return f"< {requirement.at_least:g}"
    return f"outside {requirement.at_least:g} \u2026 {requirement.at_most:g}"


def _zero_lines(xs: Floats, ys: Floats, margin: Floats) -> tuple[Line, ...]:
    import contourpy

    generator = contourpy.contour_generator(xs, ys, margin, name="serial")
    return tuple(np.asarray(line, dtype=np.float64) for line in generator.lines(0.0))


def _panel(figure: FigureSpec, run: int) -> WaveformPanel:
    row = int(np.flatnonzero(figure.kept == run)[0])
    target = None
    if figure.target is not None:
        target = np.broadcast_to(figure.target[row], figure.time.shape).astype(np.float64)
    return WaveformPanel(
        figure.title or figure.name,
        label(figure.current_label, figure.unit_symbol),
        figure.time,
        figure.current[row].astype(np.float64),
        figure.current_label,
        target,
        figure.target_label or "target",
    )
