"""The waveforms of a run for print, as the paper's Figure 7: what it shows, as values, and its drawing."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dse.report.content.data import Floats
from dse.report.drawing.style import CURRENT, LINE, STYLE, TARGET

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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


def draw_waveforms(data: WaveformData) -> Figure:
    """Figure 7: the target red and dashed, the current value blue, one panel per waveform."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    with mpl.rc_context(STYLE):
        figure = Figure(figsize=(6.8, 0.7 + 2.1 * len(data.panels)), layout="constrained")
        figure.suptitle(data.title, x=0.01, ha="left", fontsize=10, fontweight="bold", parse_math=False)
        first: Axes | None = None
        for index, panel in enumerate(data.panels):
            axes = figure.add_subplot(len(data.panels), 1, index + 1, sharex=first)
            first = first or axes
            axes.plot(panel.time, panel.current, color=CURRENT, linewidth=1.6, label=panel.current_label)
            if panel.target is not None:
                axes.plot(
                    panel.time, panel.target, color=TARGET, linewidth=1.3, dashes=(5, 3), label=panel.target_label
                )
            axes.set_title(panel.title, loc="left", parse_math=False)
            axes.set_ylabel(panel.y_label, parse_math=False)
            axes.set_xlim(float(panel.time[0]), float(panel.time[-1]))
            axes.margins(y=0.08)
            axes.grid(color=LINE, linewidth=0.7)
            axes.set_axisbelow(True)
            axes.spines[["top", "right"]].set_visible(False)
            legend = axes.legend(loc="lower right", bbox_to_anchor=(1, 1), ncols=2, frameon=False, borderaxespad=0.1)
            for text in legend.get_texts():
                text.set_parse_math(False)
            axes.set_xlabel("time [s]" if index == len(data.panels) - 1 else "")
            axes.tick_params(labelbottom=index == len(data.panels) - 1)
        return figure
