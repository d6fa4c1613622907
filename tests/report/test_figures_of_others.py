"""Figures of other packages: found by their entry point, and harmless when they fail."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator

import pytest
from installed_package import install

from dse.report.content.data import ReportContent
from dse.report.figure import FIGURES, ShownFigure, View, charted, drawings, shown_figures
from dse.report.page.html import page_of, write_report
from dse.report.page.payload import payload_of

SOURCE = """
import numpy as np
from dse.report.charts.chart import Axis, Bars, Chart, Points

class Counts:
    title = "Runs by configuration"

    def charts(self, content):
        names = tuple(entry.id for entry in content.configurations)
        counts = np.array([len(content.rows_of(name)) for name in names], dtype=np.float64)
        edges = np.arange(len(names) + 1) - 0.5
        return [Chart("all", "Runs", Axis("configuration", names=names), Axis("runs"), (Bars(edges, counts, "runs"),))]

class Broken:
    title = "Broken"

    def charts(self, content):
        raise KeyError("no such\\nthing </script>")

class Nonsense(Broken):
    def charts(self, content):
        x = np.arange(3.0)
        points = Points(x, x[:2], np.array([0, 1, 99999]))
        return [Chart("../all", "", Axis("x"), Axis("y"), ()), Chart("b", "", Axis("x"), Axis("y"), (points,)), 3]

class Greedy(Broken):
    def charts(self, content):
        content.metrics[0].values[:] = 0
        return []

class Curt(Broken):
    def charts(self, content):
        return None

counts, broken, nonsense, greedy, curt = Counts(), Broken(), Nonsense(), Greedy(), Curt()
"""
Install = Callable[..., None]


@pytest.fixture
def offering(tmp_path, monkeypatch) -> Iterator[Install]:
    """Installs a package with the figures named, until the test is over."""

    def offer(*names: str) -> None:
        points = {"dse.figures": {name: name for name in names}}
        monkeypatch.syspath_prepend(str(install(tmp_path / "site", "others", SOURCE, points)))
        vars(FIGURES).pop("_offered", None)

    yield offer
    vars(FIGURES).pop("_offered", None)


def shown(content: ReportContent) -> dict[str, ShownFigure]:
    return {figure.name: figure for figure in shown_figures(content)}


def test_a_figure_of_another_package_is_on_the_page_and_in_print(offering, sliced):
    offering("counts")
    (chart,) = shown(sliced)["counts"].charts
    assert chart.drawn[0].heights.tolist() == [242.0]
    entries = json.loads(payload_of(sliced, shown_figures(sliced)).document)["charted"]
    assert "Runs by configuration" in [entry["title"] for entry in entries]
    assert [name for name, _ in drawings("counts", sliced, View())] == ["counts_all"]


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("broken", "KeyError: 'no such\\nthing </script>'"),
        ("curt", "TypeError"),
        ("greedy", "read-only"),
        ("missing", "cannot be loaded: AttributeError"),
    ],
)
def test_a_figure_that_fails_leaves_the_others_unharmed(offering, sliced, name, words):
    before = {figure.name for figure in shown_figures(sliced)}
    values = sliced.metrics[0].values.copy()
    offering("counts", name)
    after = shown(sliced)
    assert set(after) == before | {"counts", name}
    problem = after[name].problem
    assert f"the figure '{name}'" in problem.what
    assert words in problem.what
    assert "\n" not in problem.what
    assert problem.hint == "mend or uninstall others"
    assert after["margins"].problem is after["counts"].problem is None
    assert sliced.metrics[0].values.tobytes() == values.tobytes()


def test_nonsense_is_told_chart_by_chart(offering, sliced):
    offering("nonsense")
    what = shown(sliced)["nonsense"].problem.what
    assert "the name '../all' of a chart is not made of letters" in what
    assert "chart 'b': Points (number 1): the lengths do not fit each other: x 3, y 2" in what
    assert "the study has no run 99999" in what
    assert "something of type int is not a Chart" in what


def test_what_failed_is_told_to_the_caller_and_cannot_leave_its_element(offering, sliced, tmp_path):
    offering("broken")
    problems = write_report(sliced, tmp_path / "report.html")
    assert ["broken" in problem.what for problem in problems] == [True]
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert text.count("</script>") == page_of(sliced).count("</script>")


def test_a_figure_of_ours_is_not_replaced_in_silence(offering, sliced):
    offering("margins")
    assert "offered by several packages: dse, others" in shown(sliced)["margins"].problem.what


def test_a_figure_that_does_not_apply_is_not_shown(bench_only, sliced):
    assert charted("constraints", sliced).charts == ()
    assert set(shown(sliced)) == {"margins", "progress"}
