"""What the built-in charts hold, value by value, and what a chart may hold at all."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from dse.report.charts.chart import Axis, Band, Bars, Chart, Line, Points, Rule, Steps, bulk, limits
from dse.report.charts.problems import chart_problems
from dse.report.charts.thinning import MOST_POINTS, thinned
from dse.report.content.data import ReportContent, RequirementRow
from dse.report.drawing.chart import draw_chart
from dse.report.drawing.style import save_drawing
from dse.report.figure import charted
from dse.report.verdicts import Mark
from dse.testing.figures import study


def chart(*drawn, x=Axis("time", "s"), y=Axis("gap", "m"), name="c"):  # noqa: B008  # axes are frozen
    return Chart(name, "A chart", x, y, drawn)


def floats(*values):
    return np.array(values, dtype=np.float64)


def with_metric(values, *, at_most=None, at_least=None, exercised=None, done=None) -> ReportContent:
    """A study whose one requirement bounds a metric of these *values*."""
    base = study("ordinary")
    n = len(values)
    keep = [dataclasses.replace(v, values=v.values[:n]) for v in base.variables]
    flags = np.ones(n, dtype=bool)
    return dataclasses.replace(
        base,
        runs=dataclasses.replace(
            base.runs,
            numbers=base.runs.numbers[:n],
            configurations=base.runs.configurations[:n],
            done=flags if done is None else np.array(done),
            problems=("",) * n,
        ),
        variables=tuple(keep),
        metrics=(dataclasses.replace(base.metrics[0], values=floats(*values)),),
        requirements=(
            RequirementRow("R", "far", "gap", at_most, at_least, flags if exercised is None else np.array(exercised)),
        ),
    )


def only(content, name) -> Chart:
    (found,) = charted(name, content).charts
    return found


def parts(of: Chart, kind):
    return [drawn for drawn in of.drawn if isinstance(drawn, kind)]


def test_margins_are_sorted_and_reach_zero_at_the_share_that_fails():
    found = only(with_metric([5.0, 3.0, 9.0, 4.0], at_least=4.0), "margins")
    fail, passing = parts(found, Points)
    assert (fail.x.tolist(), fail.y.tolist(), fail.runs.tolist()) == ([-1.0], [25.0], [101])
    assert (passing.x.tolist(), passing.y.tolist()) == ([0.0, 1.0, 5.0], [50.0, 75.0, 100.0])
    assert passing.runs.tolist() == [103, 100, 102]
    (steps,) = parts(found, Steps)
    assert (steps.x.tolist(), steps.y.tolist()) == ([-1, -1, 0, 1, 5], [0, 25, 50, 75, 100])
    assert parts(found, Rule) == [Rule("x", 0.0, "bound: at least 4 m")]
    assert (found.x.unit, found.y.unit) == ("m", "%")


def test_margins_are_those_to_the_nearer_of_two_bounds():
    found = only(with_metric([2.0, 5.0, 11.0], at_least=4.0, at_most=10.0), "margins")
    assert np.concatenate([p.x for p in parts(found, Points)]).tolist() == [-2.0, -1.0, 1.0]
    assert "at least 4 m and at most 10 m" in found.title


def test_margins_tell_what_is_not_drawn_and_why():
    values = [5.0, 3.0, np.nan, np.nan, np.inf, 8.0]
    content = with_metric(
        values, at_least=4.0, exercised=[True] * 5 + [False], done=[True, True, True, False, True, True]
    )
    found = only(content, "margins")
    assert found.note == (
        "4 of 6 runs judged: 2 pass, 2 fail; 1 not exercised, 1 failed to run. Not drawn: 1 undefined, 1 infinite."
    )
    fail, passing = parts(found, Points)
    # Of four judged runs the undefined one lies below all, the infinite one above.
    assert (fail.y.tolist(), passing.y.tolist()) == ([50.0], [75.0])
    assert parts(found, Steps)[0].y.tolist() == [25.0, 50.0, 75.0]


def test_a_requirement_that_judged_nothing_has_no_margins():
    assert charted("margins", with_metric([1.0, 2.0], at_most=3.0, exercised=[False, False])).charts == ()


def test_progress_shows_the_metric_over_the_run_numbers_with_the_bounds():
    content = with_metric([5.0, 3.0, np.nan, 7.0], at_least=4.0, at_most=6.0, exercised=[True, True, True, False])
    found = only(content, "progress")
    assert parts(found, Rule) == [Rule("y", 4.0, "at least 4 m"), Rule("y", 6.0, "at most 6 m")]
    drawn = {points.verdict: (points.x.tolist(), points.y.tolist()) for points in parts(found, Points)}
    assert drawn == {
        Mark.FAIL: ([101.0], [3.0]),
        Mark.PASS: ([100.0], [5.0]),
        Mark.NOT_EXERCISED: ([103.0], [7.0]),
    }
    assert found.note.endswith("Not drawn: 1 undefined.")


def test_a_wild_run_does_not_flatten_the_others():
    values = [*np.linspace(0, 1, 60), 1e6]
    content = with_metric(values[:40], at_most=0.5)
    assert only(content, "progress").y.high is None
    assert bulk(floats(*values)) != (None, None)
    low, high = bulk(floats(*values), 0.5)
    assert -0.1 < low < 0
    assert 1 < high < 1.2
    wild = with_metric([*np.linspace(0, 1, 60)[:39], 1e6], at_most=0.5)
    assert "1 beyond the axis" in only(wild, "progress").note


def test_axes_go_around_everything_drawn():
    found = limits(chart(Line(floats(0, 10), floats(np.nan, 4)), Rule("y", 14.0), Bars(floats(0, 1), floats(2))))
    assert found == ((-0.4, 10.4), (-0.56, 14.56))
    assert limits(chart(Line(floats(5), floats(5)))) == ((4.5, 5.5), (4.5, 5.5))
    assert limits(chart())[0][0] < limits(chart())[0][1]
    (low, high), _ = limits(chart(Line(floats(1, 1000), floats(1, 2)), x=Axis("f", "Hz", log=True)))
    assert 0.5 < low < 1
    assert 1000 < high < 2000
    assert limits(chart(x=Axis("brake", names=("a", "b"))))[0] == (-0.5, 1.5)
    assert limits(chart(Line(floats(0, 9), floats(0, 9)), x=Axis("x", low=2.0, high=3.0)))[0] == (2.0, 3.0)


LOG = Axis("f", "Hz", log=True)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (chart(Line(floats(1, 2), floats(1))), "lengths do not fit each other: x 2, y 1"),
        (chart(Line([1.0], [1.0])), "x must be one-dimensional and of float64"),
        (chart(Line(np.array([1]), floats(1))), "x must be one-dimensional and of float64"),
        (chart(Steps(floats(1), floats(np.inf))), "y has 1 infinite values"),
        (chart(Band(floats(1), floats(1), floats(1, 2))), "lengths do not fit"),
        (chart(Bars(floats(0, 1), floats(1, 2))), "lengths do not fit each other: edges 2, heights 2"),
        (chart(Bars(floats(0, 0), floats(1))), "edges do not ascend"),
        (chart(Bars(np.arange(3002.0), np.ones(3001))), "more than 2000 bars"),
        (chart(Points(floats(1), floats(1), floats(1))), "runs must be a one-dimensional array of whole numbers"),
        (chart(Points(floats(1), floats(1), np.array([1, 2]))), "2 runs for 1 points"),
        (chart(Points(floats(1), floats(1), np.array([3]))), "the study has no run 3"),
        (chart(Points(floats(1), floats(1), np.array([1]), verdict="pass")), "the verdict is not a Mark"),
        (chart(Rule("z", 1.0)), "the axis is 'x' or 'y', not 'z'"),
        (chart(Rule("x", np.nan)), "the value is not a finite number"),
        (chart(Rule("x", 0.0), x=LOG), "0 has no place on a logarithmic axis"),
        (chart(Line(floats(0, 1), floats(1, 1)), x=LOG), "not positive, but its axis is logarithmic"),
        (chart(Line(floats(1), floats(1), label=3)), "the label is not text"),
        (chart("a line"), "not one of Line, Steps, Points, Bars, Band, Rule"),
        (chart(x=Axis(None)), "must be texts"),
        (chart(x="time"), "axis x: something of type str is not an Axis"),
        (chart(x=Axis("t", low=2.0, high=1.0)), "low (2) must be below high (1)"),
        (chart(x=Axis("t", high=np.inf)), "must be finite"),
        (chart(name="a/b"), "not made of letters"),
        (chart(name=""), "not made of letters"),
        ("chart", "something of type str is not a Chart"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_words(wrong, words):
    assert words in "; ".join(chart_problems(wrong, {1, 2}))


EVERYTHING = chart(
    Band(floats(1, 2, 3), floats(1, np.nan, 1), floats(2, 2, 3), "band"),
    Line(floats(1, 2, 3), floats(1, np.nan, 3), "line"),
    Steps(floats(1, 2, 3), floats(3, 2, 1), "steps"),
    Bars(floats(1, 2, 4), floats(2, 1), "_bars $x^{"),
    Points(floats(1, 2), floats(1, np.nan), np.array([1, 2]), "points"),
    Points(floats(1.5), floats(2), np.array([1]), "pass", Mark.PASS),
    Rule("y", 2.0, "at most 2 m"),
    Rule("x", 2.0),
)


@pytest.mark.thorough
@pytest.mark.parametrize("axis", [Axis("x", "s"), LOG, Axis("brake $", names=("drum", "_disc", "a", "b", "c"))])
@pytest.mark.sampled(3)
def test_everything_that_is_right_can_be_drawn(axis, tmp_path):
    right = dataclasses.replace(EVERYTHING, x=axis, title="cost $x^{ and $" * 9, note="A long note $. " * 20)
    assert chart_problems(right, {1, 2}) == []
    for name in ("a.png", "b.png"):
        save_drawing(draw_chart(right), tmp_path / name)
    assert (tmp_path / "a.png").read_bytes() == (tmp_path / "b.png").read_bytes()


def test_a_large_chart_is_thinned_to_its_extremes_and_says_so():
    n = 100_000
    x = np.arange(float(n))
    wild = np.sin(x / 1000)
    wild[54_321] = 50.0
    line, points = Line(x, wild), Points(x, wild, np.arange(n))
    whole = dataclasses.replace(chart(line, points, Rule("y", 1.0)), note="Told.")
    less = thinned(whole)
    sizes = [len(drawn.x) for drawn in less.drawn[:2]]
    assert 0.7 * MOST_POINTS < sum(sizes) <= MOST_POINTS
    for drawn in less.drawn[:2]:
        assert drawn.y.max() == 50.0
        assert drawn.y.min() == wild.min()
        assert drawn.x[[0, -1]].tolist() == [0.0, n - 1.0]
        assert (np.diff(drawn.x) > 0).all()
    assert less.drawn[1].runs.tolist() == less.drawn[1].x.astype(int).tolist()
    assert less.note.startswith(f"Told. {sum(sizes):,} of 200,000 points are drawn")
    assert thinned(less) is less


def test_a_part_without_points_does_not_keep_the_others_from_being_thinned():
    x = np.linspace(0, 1, 3 * MOST_POINTS)
    full, empty = thinned(chart(Line(x, x), Line(x[:0], x[:0]))).drawn
    assert 0 < len(full.x) <= MOST_POINTS
    assert len(empty.x) == 0


def test_a_band_is_thinned_without_losing_its_widest_place():
    x = np.arange(50_000.0)
    low, high = -np.ones(50_000), np.ones(50_000)
    low[777], high[40_000] = -9.0, 9.0
    (band,) = thinned(chart(Band(x, low, high))).drawn
    assert (band.low.min(), band.high.max()) == (-9.0, 9.0)
    assert len(band.x) <= MOST_POINTS
