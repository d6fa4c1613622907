"""What a figure is, and how all there are come onto the page and into print.

A figure is one file of `dse.report.figures`, or an entry point of the group ``dse.figures``: an object of the shape of
`Figure`, in a file of ours under the name ``FIGURE``.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from dse.errors import DseError, Location, Problem, fail
from dse.registry import Registry
from dse.report.charts.chart import Chart
from dse.report.charts.problems import chart_problems
from dse.report.charts.thinning import thinned
from dse.report.content.data import ReportContent

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Sheet


class Figure(Protocol):
    """A heading and, for a study, the charts below it; the same content gives the same charts, and none where the
    figure does not apply."""

    title: str

    def charts(self, content: ReportContent) -> Sequence[Chart]:
        """What is drawn of *content*, whose arrays cannot be written to."""
        ...


@dataclass(frozen=True, slots=True)
class View:
    """What the reader asked for: the variables of the axes, a configuration, a run; None leaves it to the figure."""

    x: str | None = None
    y: str | None = None
    configuration: str | None = None
    run: int | None = None


@runtime_checkable
class PrintedFigure(Protocol):
    """A figure with a drawing of its own for print, in place of that of its charts.

    One with a true attribute ``uses_insight`` draws what runs tell, which takes seconds to find out.
    """

    def drawings(self, content: ReportContent, view: View) -> Iterable[tuple[str, Sheet]]:
        """Each drawing with the name of its file, without an ending."""
        ...


class PrintOnly:
    """The charts of a figure that is only for print: the page has a view of its own."""

    def charts(self, content: ReportContent) -> Sequence[Chart]:  # noqa: ARG002  # of none
        """None."""
        return ()


FIGURES: Registry[Figure] = Registry("dse.figures", "figure", room="dse.report.figures", attribute="FIGURE")


@dataclass(frozen=True, slots=True, eq=False)
class ShownFigure:
    """A figure as the page shows it; without charts *problem* says why."""

    name: str
    title: str
    charts: tuple[Chart, ...]
    problem: Problem | None = None


def shown_figures(content: ReportContent) -> tuple[ShownFigure, ...]:
    """Every figure that applies to *content*, its charts thinned, and those that failed with their problem."""
    shown = []
    for name in FIGURES.names():
        try:
            figure = charted(name, content)
        except DseError as error:
            shown.append(ShownFigure(name, name, (), error.problems[0]))
            continue
        if figure.charts:
            shown.append(replace(figure, charts=tuple(map(thinned, figure.charts))))
    return tuple(shown)


def charted(name: str, content: ReportContent) -> ShownFigure:
    """The charts of the figure *name*, checked. Raises DseError with one line if it fails or gives nonsense."""
    try:
        figure = FIGURES.get(name)
        title, charts = figure.title, tuple(figure.charts(content))
    except DseError:
        raise
    except Exception as error:  # another's code: whatever it raises is told in words
        raise _broken(name, f"{type(error).__name__}: {error}") from error
    runs = frozenset(content.runs.numbers.tolist())
    problems = [problem for chart in charts for problem in chart_problems(chart, runs)]
    if not isinstance(title, str):
        problems.append("its title is not text")
    if not problems and len({chart.name for chart in charts}) < len(charts):
        problems.append("two of its charts have the same name")
    if problems:
        raise _broken(name, "; ".join(problems))
    return ShownFigure(name, title, charts)


def drawings(name: str, content: ReportContent, view: View) -> Iterator[tuple[str, Sheet]]:
    """The figure *name* for print: each drawing with the name of its file. Raises DseError as `charted` does."""
    figure = FIGURES.get(name)
    if not isinstance(figure, PrintedFigure):
        from dse.report.drawing.chart import draw_chart

        yield from ((f"{name}_{chart.name}", draw_chart(chart)) for chart in charted(name, content).charts)
        return
    try:
        yield from figure.drawings(content, view)
    except DseError:
        raise
    except Exception as error:  # as above
        raise _broken(name, f"{type(error).__name__}: {error}") from error


def configuration_called(content: ReportContent, wanted: str | None) -> str:
    """The id that starts with *wanted*; the first configuration's if it is None. Raises DseError."""
    ids = [entry.id for entry in content.configurations if entry.id.startswith(wanted or "")]
    if not ids or (wanted and wanted not in ids and len(ids) > 1):
        what = f"{len(ids) or 'no'} configurations of this study start with '{wanted}'"
        known = ", ".join(ids or [entry.id for entry in content.configurations][:6])
        raise fail(what, Location(content.study_folder), f"as {known}")
    return wanted if wanted in ids else ids[0]


def uses_insight(names: Iterable[str]) -> bool:
    """Whether one of the figures *names* draws what runs tell: `ReportContent.insight`."""
    return any(getattr(FIGURES.get(name), "uses_insight", False) for name in names)


def _broken(name: str, why: str) -> DseError:
    line = " ".join(why.split())
    package = FIGURES.package(name)
    hint = "" if package == "dse" else f"mend or uninstall {package}"
    return fail(f"the figure '{name}' cannot be drawn: {line[:300]}{'…' if len(line) > 300 else ''}", hint=hint)
