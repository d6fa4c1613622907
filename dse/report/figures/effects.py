"""What metrics depend on: the share of the variance that each factor explains by itself, with its interval."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from dse.report.content.data import ReportContent
from dse.report.content.insight import ALIASED, Part, Response
from dse.report.drawing.sheets import axes_of, gridded, say, sheet, style, ticks
from dse.report.drawing.style import CURRENT, INK
from dse.report.figure import PrintOnly, View

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


class Effects(PrintOnly):
    """Bars for each required metric, in each part of the runs that may be compared; on the page a view shows them."""

    title = "What metrics depend on"
    uses_insight = True

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:  # noqa: ARG002  # of all
        """A sheet for each required metric and part, called after both."""
        required = {requirement.metric for requirement in content.requirements}
        for number, part in enumerate(content.insight.parts if content.insight else ()):
            for response in part.responses:
                name = content.metrics[response.metric].name
                if response.bars and name in required:
                    yield f"effects_{name}" + f"_{number}" * bool(number), _draw(content, part, response)


FIGURE = Effects()


def _draw(content: ReportContent, part: Part, response: Response) -> Sheet:
    metric = content.metrics[response.metric]
    bars = sorted(response.bars, key=lambda bar: bar.share[0])
    shares, lows, highs = 100 * np.array([bar.share for bar in bars]).T
    apart = f"; {part.apart:,} others, in which other variables were varied, are left out" if part.apart else ""
    note = f"Share of the variance that each explains by itself, with its 95 % interval. Of {part.runs:,} runs{apart}."
    note = "\n".join([note, *(f"Withheld: {each}." for each in response.withheld if each.startswith(ALIASED))])
    with style():
        figure = sheet(f"{metric.title or metric.name}: what it depends on", note, height=1.4 + 0.32 * len(bars))
        (axes,) = axes_of(figure)
        axes.barh(range(len(bars)), shares, 0.62, color=CURRENT)
        reach = np.nan_to_num(np.clip([shares - lows, highs - shares], 0, None))
        axes.errorbar(shares, range(len(bars)), xerr=reach, fmt="none", ecolor=INK, elinewidth=1.1, capsize=3)
        axes.set_xlim(0, 100)
        ticks(axes, "y", [part.factors[bar.factor].title for bar in bars])
        say(axes, xlabel="share of the variance [%]")
        gridded(axes, "x")
        return figure
