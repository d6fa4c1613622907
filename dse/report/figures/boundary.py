"""How probable it is that requirements are met, and where a verdict is in doubt; the boundary itself is drawn in the
constraint plot alone, by its interpolation."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from dse.report.content.data import ReportContent, label
from dse.report.content.insight import ChanceMap
from dse.report.drawing.sheets import axes_of, say, sheet, style
from dse.report.drawing.style import INK
from dse.report.figure import PrintOnly, View

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet

_DOUBT = 5
"""Percent: from here on a verdict is in doubt."""


class Boundary(PrintOnly):
    """How probable it is that a requirement is met, by what all runs of the plane tell."""

    title = "Boundaries and their bands"
    uses_insight = True

    def drawings(self, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:  # noqa: ARG002  # of all
        """One for each requirement and plane that can be told."""
        for number, chance in enumerate(content.insight.chances if content.insight else ()):
            name = content.requirements[chance.requirement].name
            yield f"boundary_{name}_{number}", _draw(content, chance)


FIGURE = Boundary()


def _draw(content: ReportContent, chance: ChanceMap) -> Sheet:
    requirement = content.requirements[chance.requirement]
    x, y = (content.variables[index] for index in chance.plane)
    grids = [np.linspace(each.low, each.high, chance.size) for each in (x, y)]
    passing, misjudged = (np.asarray(p).reshape(chance.size, chance.size) for p in (chance.passing, chance.misjudged))
    held = ", ".join(f"{content.variables[i].title} = {content.variables[i].shown(value)}" for i, value in chance.held)
    held += f"{', ' * bool(held)}the worst of {chance.conditions} conditions" * (chance.conditions > 1)
    note = (
        f"Probability by a Gaussian process, from {chance.used:,} of {chance.runs:,} runs"
        f"{f', at {held}' * bool(held)}. Hatched: the likeliest verdict is wrong with a probability of {_DOUBT} % or "
        f"more ({chance.uncertain:.1%} of the plane)."
    )
    with style():
        title = f"Probability of meeting “{requirement.title or requirement.name}”"
        figure = sheet(title, note.replace("%", " %").replace("  %", " %"), height=4.8)
        (axes,) = axes_of(figure)
        filled = axes.contourf(*grids, passing, levels=np.linspace(0, 100, 11), cmap="RdYlBu", vmin=-15, vmax=115)
        if misjudged.max() >= _DOUBT:
            axes.contourf(*grids, misjudged, levels=[_DOUBT, 101], colors="none", hatches=["////"])
        bar = figure.colorbar(filled, ax=axes)
        bar.set_label("met with [%]", color=INK)
        say(axes, xlabel=label(x.title, x.unit_symbol), ylabel=label(y.title, y.unit_symbol))
        return figure
