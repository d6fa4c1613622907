"""The waveforms of one run, as the paper's Figure 7; the page draws its own, for the run selected."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from dse.domain.definition import StudyDefinition
from dse.domain.run import Run
from dse.errors import fail
from dse.report.content.data import FigureSpec, Floats, ReportContent, label
from dse.report.content.reading import content_of_run
from dse.report.drawing.style import save_drawing
from dse.report.drawing.waveform_plot import WaveformData, WaveformPanel, draw_waveforms
from dse.report.figure import PrintOnly, View
from dse.report.verdicts import Mark, overall_marks

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


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


def draw_run(run: Run, definition: StudyDefinition, target: Path) -> None:
    """Draw the bench's figures for *run*, whose waveforms were kept, into the file *target*. Raises DseError."""
    save_drawing(draw_waveforms(waveform_data(content_of_run(run, definition), run.request.number)), target)


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


class Waveforms(PrintOnly):
    """The waveforms of one run against their targets, drawn for print only."""

    title = "Waveforms"

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:
        """Figure 7 of the run asked for, else of `default_run`. Raises DseError if it was not kept."""
        if content.figures:
            run = default_run(content) if view.run is None else view.run
            yield f"waveforms_{run}", draw_waveforms(waveform_data(content, run))


FIGURE = Waveforms()
