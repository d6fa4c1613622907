"""What notebooks do with results: best designs, figures, arrays and tables."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace
from html import escape

import numpy as np
import pytest

import dse
from dse.api import choice_lines


def test_an_objective_may_be_a_plain_text(results):
    assert results.best(minimize="settling_time").best == results.best(minimize=["settling_time"]).best
    smallest = results.best(1, minimize="final_gap").best[0].values
    largest = results.best(1, maximize="final_gap").best[0].values
    assert smallest < largest


@pytest.mark.parametrize("ask", ["best", "pareto"])
def test_an_unknown_objective_hints_at_the_nearest(results, ask):
    with pytest.raises(dse.DseError) as error:
        getattr(results, ask)(minimize=["settling_tim", "final_gap"])
    (problem,) = error.value.problems
    assert problem.hint == "did you mean 'settling_time'?"


def test_a_front_is_of_two_objectives_or_more(results):
    with pytest.raises(dse.DseError, match="two objectives or more are needed"):
        results.pareto(minimize="final_gap")
    front = results.pareto(minimize="settling_time", maximize="final_gap")
    values = np.array([each.values for each in front.best])
    for one in values:
        assert not ((values[:, 0] < one[0]) & (values[:, 1] > one[1])).any()


def test_best_designs_are_a_frame_with_units_and_titles(results):
    found = results.best(2, minimize="final_speed")
    frame = found.to_pandas()
    assert frame.index.tolist() == [1, 2][: len(found.best)]
    assert frame.attrs["units"]["final_speed"] == "km/h"
    assert frame.attrs["titles"]["final_speed"] == "Speed at the end"
    assert frame["final_speed"].iloc[0] == pytest.approx(3.6 * found.best[0].values[0], rel=1e-15)
    assert frame["sensor"].iloc[0] == "radar_77ghz_mid"
    si = found.to_pandas("si")
    assert si["final_speed"].iloc[0] == found.best[0].values[0]
    assert si["R2.margin"].iloc[0] == found.best[0].margins["R2"]


def test_notebooks_show_best_designs_findings_and_summaries(results):
    found = results.best(1, minimize="final_speed")
    assert "<th>final_speed [km/h]</th>" in found._repr_html_()
    assert "minimize final_speed" in repr(found)
    findings = results.findings()
    assert repr(findings).count("\n") == len(findings) - 1
    assert all(f"<td>{each.topic}</td>" in findings._repr_html_() for each in findings)
    evil = type(findings)([replace(findings[0], text="<b>x</b>")])
    assert "&lt;b&gt;x&lt;/b&gt;" in evil._repr_html_()
    counts = results.summary.counts("R2")
    assert "".join(f"<td>{count}</td>" for count in counts.values()) in results.summary._repr_html_()


def test_notebooks_show_which_design_to_take_in_the_words_of_the_report(results):
    choice = results.choice(results.best(minimize="final_gap"))
    name, lines = choice_lines(choice, results.definition)
    assert repr(choice).splitlines()[0] == name
    assert all(f"<tr><td>{label}</td><td>{escape(text)}</td></tr>" in choice._repr_html_() for label, text in lines)


def test_a_frame_has_titles_and_the_verdict_on_all_requirements(results):
    frame = results.to_pandas()
    assert frame.attrs["titles"]["settling_time"] == "Settling time of the gap"
    assert frame.attrs["titles"]["R1.margin"] == "no speed overshoot, margin"
    assert frame["verdict"].tolist() == [str(results.run(number).verdict) for number in frame.index]


def test_a_full_factorial_study_is_an_array_over_its_variables(results):
    frame, arrays = results.to_pandas(), results.to_xarray()
    axes = ("configuration", "controller.kp_speed", "controller.kd_speed")
    assert {*arrays.sizes} == {*axes}
    assert dict(arrays.sizes) == {"configuration": 1, **{axis: frame[axis].nunique() for axis in axes[1:]}}
    for _, row in frame.iterrows():
        place = {axis: row[axis] for axis in axes}
        assert arrays["final_gap"].sel(place).item() == row["final_gap"]
    assert arrays["final_speed"].attrs == {"units": "km/h", "long_name": "Speed at the end"}
    assert arrays["sensor"].dims == ("configuration",)


def test_other_studies_are_arrays_over_their_runs(results):
    from dse.api.studies.arrays import to_xarray

    frame = results.to_pandas()
    some = frame.iloc[:-1]
    some.attrs = frame.attrs
    arrays = to_xarray(some, ["sensor"], ["controller.kp_speed", "controller.kd_speed"])
    assert dict(arrays.sizes) == {"run": len(frame) - 1}
    assert {"configuration", "sensor", "controller.kp_speed"} <= {*arrays.coords}
    assert arrays["final_gap"].to_numpy().tolist() == some["final_gap"].tolist()


def test_waveforms_are_arrays_over_time(results):
    arrays = results.to_xarray(waveforms=["world.gap"])
    for number in range(len(results)):
        waveforms = results.run(number).waveforms
        (place,) = np.argwhere(arrays["run"].to_numpy() == number)
        assert np.array_equal(arrays["world.gap"].to_numpy()[tuple(place)], waveforms["world.gap"])
    assert arrays["time"].to_numpy().tolist() == waveforms.time.tolist()
    with pytest.raises(dse.DseError) as error:
        results.to_xarray(waveforms=["world.gab"])
    assert error.value.problems[0].hint == "did you mean 'world.gap'?"


def test_without_xarray_the_error_names_the_extra(results, monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    with pytest.raises(dse.DseError, match=r"dse-workbench\[xarray\]"):
        results.to_xarray()


def test_the_constraint_plot_has_the_axes_asked_for(results):
    axes = results.figure(x="controller.kd_speed", y="controller.kp_speed").axes[0]
    titles = [variable.title for variable in results.definition.variables]
    assert axes.get_ylabel().startswith(titles[0])
    assert axes.get_xlabel().startswith(titles[1])
    assert results.figure().axes[0].get_xlabel().startswith(titles[0])


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        ({"x": "controller.kp_speed"}, "only x is given"),
        ({"name": "constraint"}, "unknown figure 'constraint'"),
        ({"configuration": "zz"}, "no configurations of this study start with 'zz'"),
        ({"x": "controller.kp_speed", "y": "kd"}, "the study has no design variable 'kd'"),
    ],
)
def test_a_figure_that_cannot_be_drawn_is_an_error(results, arguments, what):
    with pytest.raises(dse.DseError) as error:
        results.figure(**arguments)
    assert error.value.problems[0].what == what


def test_figures_and_arrays_are_imported_when_they_are_asked_for():
    code = "import dse, sys; dse.results; dse.Design; dse.Component; print({'matplotlib', 'xarray'} & {*sys.modules})"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "set()\n"
