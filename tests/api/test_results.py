"""Simulating and exploring from Python, and reading what came of it."""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest
from definitions import stored_definition

import dse
from dse.domain.definition import DefinedConfiguration, DefinedMetric
from dse.domain.run import Outcome, Run as Record, RunRequest
from dse.exploration.progress import Stage
from dse.storage.export.headings import si_unit

DEFINITION = stored_definition(
    [DefinedConfiguration("abc", {"a": "b"})],
    title="<b>",
    metrics=(
        DefinedMetric("end", "End", "km/h", "final(x)"),
        DefinedMetric("end.error", "End, error bar", "km/h", "final(x)", error_of="end"),
    ),
)


@pytest.fixture(scope="module")
def run(ws, results):
    """The run at the point of run 3, simulated alone."""
    stored = results.run(3)
    return ws.benches["acc_following"].simulate(stored.configuration[:6], dict(stored.point))


def test_a_run_has_numbers_with_units(run):
    assert run.is_done
    assert run.problem == ""
    assert run.metrics["final_gap"] == pytest.approx(40.0, abs=1.0)
    assert run.units["final_gap"] == "m"
    assert run.units["final_speed"] == "m/s"
    assert run.units["fuel_energy"] == "J"
    assert run.verdicts.keys() == run.margins.keys() == {"R1", "R2"}
    assert run.verdicts["R2"] in ("pass", "fail", "not exercised")
    assert run.choices["sensor"] == "radar_77ghz_mid"


def test_waveforms_are_arrays_and_a_frame(run):
    waveforms = run.waveforms
    assert waveforms.units["world.acceleration"] == "m/s2"
    assert len(waveforms.time) == len(waveforms["world.speed"])
    frame = waveforms.to_pandas()
    assert frame.index.name == "time"
    assert np.array_equal(frame["world.speed"].to_numpy(), waveforms["world.speed"])
    assert frame.attrs["units"]["world.gap"] == "m"
    assert frame.attrs["units"]["time"] == "s"


def test_a_run_made_alone_is_the_run_of_the_study(run, results):
    stored = results.run(3)
    assert dict(run.metrics) == pytest.approx(dict(stored.metrics), rel=0, abs=0, nan_ok=True)
    assert np.array_equal(run.waveforms["world.gap"], stored.waveforms["world.gap"])


@pytest.mark.thorough
def test_a_script_needs_no_guard_around_what_simulates(folder, results, tmp_path):
    script = tmp_path / "script.py"
    script.write_text(
        f"import dse\nprint('once')\nbench = dse.open({str(folder)!r}).benches['acc_following']\n"
        f"print(bench.simulate({results.run(0).configuration!r}))\n",
        encoding="utf-8",
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, check=True)
    assert done.stdout.startswith("once\n<Run 0 of ")
    assert done.stdout.count("once") == 1


def test_values_are_set_in_the_parameters_unit_or_with_one(ws):
    bench = ws.benches["acc_following"]
    with pytest.raises(dse.DseError, match="did you mean 'kp_speed'"):
        bench.simulate(set={"controller.kp_sped": 1.2})
    with pytest.raises(dse.DseError, match="expected length"):
        bench.simulate(set={"controller.set_gap": "4 kg"})


@pytest.mark.thorough
def test_a_checked_step_gives_error_bars(ws, run):
    checked = ws.benches["acc_following"].simulate(run.configuration, check_step=True)
    assert 0.0 < checked.metrics["final_gap.error"] < 0.01
    assert checked.units["final_gap.error"] == "m"
    assert " ± " in checked._repr_html_()


def test_exploring_tells_how_far_it_is_and_what_it_did(results, told):
    last = {progress.stage: (progress.done, progress.total) for progress in told}
    assert last == {Stage.RUNS: (6, 6), Stage.REPEATS: (1, 1)}
    assert results.explored
    assert (results.explored.before, results.explored.new) == (0, 6)
    assert len(results) == 6


def test_exploring_a_finished_folder_makes_nothing(ws, results, capfd):
    again = ws.studies["small"].explore(results.folder, workers=1)
    assert again.explored
    assert (again.explored.before, again.explored.new, again.explored.again) == (6, 0, 0)
    assert capfd.readouterr() == ("", "")


def test_a_bar_is_shown_on_standard_error_if_asked_for(ws, results, capfd):
    ws.studies["small"].explore(results.folder, workers=1, progress=True)
    out, err = capfd.readouterr()
    assert out == ""
    assert "6/6" in err


def test_a_summary_counts_what_the_table_says(results):
    summary = results.summary
    frame = results.to_pandas()
    assert (summary.runs, summary.finished, summary.failed) == (6, 6, 0)
    for name in ("R1", "R2"):
        counts = frame[f"{name}.verdict"].value_counts()
        assert {verdict: n for verdict, n in summary.verdicts[name].items() if n} == counts.to_dict()
    assert summary.is_passed == all(counts["fail"] == 0 for counts in summary.verdicts.values())


def test_results_are_a_frame_with_units(results):
    frame = results.to_pandas()
    assert frame.loc[0, "controller.kp_speed"] == 0.5
    units = frame.attrs["units"]
    assert units["controller.kp_speed"] == "1/s"
    assert units["final_speed"] == "km/h"
    assert units["speed_overshoot"] == units["R1.margin"] == "%"
    assert "configuration" not in units
    si = results.to_pandas(units="si")
    assert si.attrs["units"]["final_speed"] == "m/s"
    assert (si["final_speed"] * 3.6).tolist() == pytest.approx(frame["final_speed"].tolist())
    with pytest.raises(dse.DseError, match="did you mean 'shown'"):
        results.to_pandas(units="show")


def test_results_are_an_arrow_table_with_units(results):
    table = results.to_arrow()
    assert table.num_rows == 6
    assert table.schema.field("final_speed").metadata == {b"unit": b"km/h"}
    assert table.schema.field("configuration").metadata is None
    assert table.column("final_gap").to_pylist() == results.to_pandas()["final_gap"].tolist()


def test_a_run_that_is_not_there_is_an_error(results):
    with pytest.raises(dse.DseError, match="no run 99"):
        results.run(99)


def test_the_report_is_written_where_it_is_asked_for(results, tmp_path):
    page = results.report(tmp_path / "page.html")
    assert page == tmp_path / "page.html"
    assert page.read_text(encoding="utf-8").startswith("<!doctype html>")


def test_a_replayed_run_is_the_same(results, folder, monkeypatch):
    monkeypatch.chdir(folder)
    replayed = results.replay(2)
    assert replayed.is_same
    assert replayed.problem("here") is None
    assert replayed.run.number == 2


def test_an_export_is_one_of_those_there_are(results):
    assert results.export("csv").startswith(b"run,configuration,sensor,")
    with pytest.raises(dse.DseError, match="did you mean 'csv'"):
        results.export("csw")


def test_results_say_what_they_are(results):
    assert repr(results).endswith("small: 6 of 6 runs>")
    assert "6 of 6 runs, 0 failed" in results._repr_html_()
    assert repr(dse.results(str(results.folder))) == repr(results)


def test_no_folder_is_an_error_at_once(tmp_path):
    with pytest.raises(dse.DseError):
        dse.results(tmp_path / "nothing")


def test_a_failed_run_says_why_and_has_neither_metrics_nor_waveforms():
    run = dse.Run(Record(RunRequest(4, "abc", {}), Outcome.FAILED, {}, (), "plant: exploded <i>"), DEFINITION)
    assert not run.is_done
    assert run.metrics == {}
    assert repr(run) == "<Run 4 of abc failed: plant: exploded <i>>"
    assert "&lt;b&gt;, configuration abc: failed to run: plant: exploded &lt;i&gt;" in run._repr_html_()
    with pytest.raises(dse.DseError, match="run 4 has no waveforms"):
        run.waveforms  # noqa: B018  # is looked up


def test_a_value_is_shown_in_its_unit_with_its_error_bar():
    run = dse.Run(Record(RunRequest(0, "abc", {}), Outcome.DONE, {"end": 10.0, "end.error": 0.01}, ()), DEFINITION)
    assert "<td>36.000 ± 0.036 km/h</td>" in run._repr_html_()
    assert math.isclose(run.metrics["end"], 10.0)
    assert run.units == {"end": "m/s", "end.error": "m/s"}


@pytest.mark.parametrize(
    ("unit", "si"), [("km/h", "m/s"), ("%", ""), ("kWh", "J"), ("N.m", "N.m"), ("kWh/km", "N"), ("degC", "K")]
)
def test_the_unit_of_a_number_in_si_is_one_a_person_reads(unit, si):
    assert si_unit(unit) == si
