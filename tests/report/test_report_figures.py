from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from dse.errors import DseError
from dse.report.content.data import (
    ConfigurationEntry,
    Flags,
    Floats,
    MetricColumn,
    ReportContent,
    ReportVariable,
    RequirementRow,
    Runs,
    SamplerKind,
)
from dse.report.drawing.constraint_plot import draw_constraint_plot
from dse.report.drawing.style import save_drawing
from dse.report.drawing.waveform_plot import draw_waveforms
from dse.report.figures.constraints import axis_pairs, constraint_plot_data
from dse.report.figures.parallel import _spaced
from dse.report.figures.waveforms import default_run, waveform_data
from dse.report.interpolation.radial import MOST_CENTRES, evaluate, radial_fields, unit_points
from dse.report.verdicts import Mark, overall_marks


def plane_study(x: Floats, y: Floats, sampler: SamplerKind, *, failed: int | None = None) -> ReportContent:
    """A study whose one metric is ``x + 2 y``, required to be at most 1.5."""
    n = len(x)
    done = np.ones(n, dtype=bool)
    if failed is not None:
        done[failed] = False
    metric = np.where(done, x + 2 * y, np.nan)
    return ReportContent(
        title="plane",
        sampler=sampler,
        study_folder="out",
        runs=Runs(np.arange(n), ("c",) * n, done, ("",) * n),
        configurations=(ConfigurationEntry("c", {}, {}),),
        variables=(
            ReportVariable("x", "x", "m", 0.0, 1.0, None, 0.5, x),
            ReportVariable("y", "y", "", 0.0, 1.0, None, 0.5, y),
        ),
        metrics=(MetricColumn("sum", "sum", "m", metric),),
        requirements=(RequirementRow("R", "R", "sum", 1.5, None, np.ones(n, dtype=bool)),),
    )


def random_plane(seed: int, runs: int) -> ReportContent:
    x, y = np.random.default_rng(seed).random((2, runs))
    return plane_study(x, y, SamplerKind.SCATTERED)


def even_plane(levels: int, failed: int | None = None) -> ReportContent:
    x, y = (axis.ravel() for axis in np.meshgrid(np.linspace(0, 1, levels), np.linspace(0, 1, levels)))
    return plane_study(x, y, SamplerKind.FULL_FACTORIAL, failed=failed)


def test_the_boundary_of_a_linear_metric_lies_where_it_must() -> None:
    data = constraint_plot_data(even_plane(7), "x", "y", "c")
    (line,) = data.layers[0].boundary
    np.testing.assert_allclose(line[:, 0] + 2 * line[:, 1], 1.5, atol=1e-12)  # linear interpolation is exact here
    assert line[:, 0].min() == 0.0
    assert line[:, 0].max() == 1.0


def test_the_boundary_through_scattered_runs_is_close_to_the_true_one() -> None:
    data = constraint_plot_data(random_plane(3, 400), "x", "y", "c")
    line = np.concatenate(data.layers[0].boundary)
    inner = line[(line > 0.1).all(axis=1) & (line < 0.9).all(axis=1)]
    # Runs are 0.05 apart on average; the interpolant of a plane is off by a fraction of that.
    assert np.max(np.abs(inner[:, 0] + 2 * inner[:, 1] - 1.5)) < 0.03


def test_runs_that_miss_a_bound_by_far_do_not_drown_the_boundary() -> None:
    def metric(points: Floats) -> Floats:
        """Just inside its bound of 1.5 below the diagonal, up to forty times beyond it above."""
        beyond = points.sum(axis=1) - 2
        return np.where(beyond > 0, 1.5 + 30 * beyond, 1.45)

    base, points = random_plane(3, 400), np.random.default_rng(5).random((400, 4))
    variables = tuple(
        dataclasses.replace(base.variables[0], name=f"v{i}", low=0.0, high=1.0, nominal=0.5, values=points[:, i])
        for i in range(4)
    )
    metrics = (dataclasses.replace(base.metrics[0], values=metric(points)), *base.metrics[1:])
    content = dataclasses.replace(base, variables=variables, metrics=metrics)
    fields = radial_fields(content, "c")
    assert fields is not None
    places = np.random.default_rng(9).random((2000, 4))
    found = fields.metric(0, evaluate(unit_points(content, fields.centres), fields.weights[0], places))
    # 400 runs in four variables misjudge 8 % of the places; interpolating the metric as it is misjudges 17 %.
    assert np.mean((found > 1.5) != (places.sum(axis=1) > 2)) < 0.1


def test_a_radial_field_passes_through_every_run() -> None:
    content = random_plane(4, 150)
    fields = radial_fields(content, "c")
    assert fields is not None
    points = unit_points(content, fields.centres)
    found = fields.metric(0, evaluate(points, fields.weights[0], points))
    # Weights travel as 32-bit numbers; 150 of them of size 1 add up to an error of some 1e-5.
    np.testing.assert_allclose(found, content.metrics[0].values[fields.centres], atol=1e-4)


def test_a_point_simulated_twice_does_not_break_the_interpolation() -> None:
    x, y = np.random.default_rng(5).random((2, 60))
    x[1], y[1] = x[0], y[0]
    fields = radial_fields(plane_study(x, y, SamplerKind.SCATTERED), "c")
    assert fields is not None
    assert len(fields.centres) == 59


def test_more_runs_than_can_be_interpolated_are_shown_as_points() -> None:
    content = random_plane(6, MOST_CENTRES + 1)
    data = constraint_plot_data(content, "x", "y", "c")
    assert data.layers == ()
    assert len(data.points) == MOST_CENTRES + 1
    assert "Too many runs" in data.note


def test_a_failed_run_leaves_a_hole_and_does_not_bend_the_boundary() -> None:
    data = constraint_plot_data(even_plane(9, failed=20), "x", "y", "c")
    assert data.known.reshape(-1)[20] < 0.5
    assert np.count_nonzero(data.known < 0.5) == 1
    assert not data.feasible.reshape(-1)[20]
    assert data.feasible.reshape(-1)[19]
    assert data.marks[20] == Mark.FAILED_TO_RUN
    line = np.concatenate(data.layers[0].boundary)
    np.testing.assert_allclose(line[:, 0] + 2 * line[:, 1], 1.5, atol=1e-12)


def test_every_node_stays_on_its_side_of_the_exercised_limit(sliced: ReportContent) -> None:
    x, y = sliced.slices[1]
    data = constraint_plot_data(sliced, x, y, "c4f1a2")
    exercised = data.layers[1].exercised
    for (px, py), row in zip(data.points, np.flatnonzero(on_plane(sliced, x, y)), strict=True):
        if sliced.runs.done[row]:
            node = exercised[np.searchsorted(data.ys, py), np.searchsorted(data.xs, px)]
            assert (node >= 0.5) == sliced.requirements[1].exercised[row]


def test_a_slice_shows_its_own_runs_only(sliced: ReportContent) -> None:
    for x, y in sliced.slices:
        data = constraint_plot_data(sliced, x, y, "c4f1a2")
        assert len(data.points) == 121
        assert np.array_equal(data.marks, overall_marks(sliced)[on_plane(sliced, x, y)])


def test_variables_that_were_not_varied_together_have_no_boundary(sliced: ReportContent) -> None:
    data = constraint_plot_data(sliced, "controller.kp_speed", "controller.kp_gap", "c4f1a2")
    assert data.layers == ()
    assert "not varied together" in data.note


def test_unknown_names_are_refused_with_the_known_ones(sliced: ReportContent) -> None:
    with pytest.raises(DseError, match=r"no design variable 'kp'(.|\n)*controller.kp_speed"):
        constraint_plot_data(sliced, "kp", "controller.kd_speed", "c4f1a2")
    with pytest.raises(DseError, match="no configuration 'other'"):
        constraint_plot_data(sliced, *axis_pairs(sliced)[0], "other")
    with pytest.raises(DseError, match="two different variables"):
        constraint_plot_data(sliced, "controller.kd_speed", "controller.kd_speed", "c4f1a2")


def test_a_bench_without_variables_has_no_constraint_plot(bench_only: ReportContent) -> None:
    assert axis_pairs(bench_only) == []


def test_waveforms_come_with_their_targets(sliced: ReportContent) -> None:
    run = int(sliced.figures[0].kept[3])
    gap, speed = waveform_data(sliced, run).panels
    assert gap.target is not None
    assert set(gap.target.tolist()) == {40.0}
    assert gap.y_label == "distance [m]"
    np.testing.assert_array_equal(speed.current, sliced.figures[1].current[3])


def test_a_waveform_that_was_not_kept_says_how_to_get_it(sliced: ReportContent) -> None:
    with pytest.raises(DseError, match=r"dse replay out/acc_gains 1$"):
        waveform_data(sliced, 1)


def test_the_run_shown_first_passes_and_was_kept(sliced: ReportContent) -> None:
    run = default_run(sliced)
    assert run in sliced.figures[0].kept
    assert overall_marks(sliced)[run] == Mark.PASS


@pytest.mark.sampled(3)
@pytest.mark.parametrize("ending", ["png", "svg", "pdf"])
def test_a_figure_is_saved_with_the_same_bytes_each_time(sliced: ReportContent, tmp_path: Path, ending: str) -> None:
    data = constraint_plot_data(sliced, sliced.slices[1][0], sliced.slices[1][1], "c4f1a2")
    for name in ("a", "b"):
        save_drawing(draw_constraint_plot(data), tmp_path / f"{name}.{ending}")
    assert (tmp_path / f"a.{ending}").read_bytes() == (tmp_path / f"b.{ending}").read_bytes()
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.thorough
def test_a_dollar_in_a_title_is_a_dollar(sliced: ReportContent, tmp_path: Path) -> None:
    content = dataclasses.replace(sliced, title="cost $x^{ and $")
    save_drawing(draw_waveforms(waveform_data(content, default_run(content))), tmp_path / "waveforms.png")
    save_drawing(
        draw_constraint_plot(constraint_plot_data(content, *axis_pairs(content)[0], "c4f1a2")), tmp_path / "plot.png"
    )


def test_an_unknown_ending_is_refused(sliced: ReportContent, tmp_path: Path) -> None:
    figure = draw_waveforms(waveform_data(sliced, default_run(sliced)))
    with pytest.raises(DseError, match=r"\.png, \.svg or \.pdf"):
        save_drawing(figure, tmp_path / "figure.gif")


def on_plane(content: ReportContent, x: str, y: str) -> Flags:
    others = [v for v in content.variables if v.name not in (x, y)]
    return np.asarray(np.all([np.abs(v.values - nearest_level(v)) < 1e-9 for v in others], axis=0))


def nearest_level(variable: ReportVariable) -> float:
    return float(variable.values[np.argmin(np.abs(variable.values - variable.nominal))])


def test_an_axis_of_names_or_values_that_are_apart_has_them_evenly_spaced_with_their_texts():
    road = ReportVariable("road", "road", "", 0, 1, 2, 0, np.array([0.0, 1.0]), (), ("gravel", "ice"), apart=(0.0, 1.0))
    fog = ReportVariable("fog", "fog", "m", 30, 1e4, 3, 50, np.array([50.0, 1e4]), apart=(30.0, 50.0, 1e4))
    gain = ReportVariable("gain", "gain", "", 0, 1, 3, 0, np.array([0.2, 0.9]))
    assert [(values.tolist(), texts) for values, texts in map(_spaced, (road, fog, gain))] == [
        ([0.0, 1.0], ["gravel", "ice"]),
        ([1.0, 2.0], ["30", "50", "10000"]),
        ([0.2, 0.9], ()),
    ]
