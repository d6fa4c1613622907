"""A known oscillator near its boundary: the bench's step gives some runs the wrong verdict, and these are told."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np
import pytest
from workspaces import OSCILLATOR, written

import dse
from dse.errors import DseError
from dse.report import read_content


def _bench(name: str, more: str = "", checks: str = "") -> str:
    return f"""\
testbench: {name}
design: one
{more}simulation: {{stop: 1 s, step: 10 ms, record: [mass.x]{checks}}}
metrics: {{end: final(mass.x)}}
requirements:
  R1: {{metric: end, at_most: 1 m}}
"""


def _study(name: str, bench: str, start: str, more: str = "") -> str:
    return f"study: {name}\ntestbench: {bench}\ndesign_variables: {{mass.start: {start}}}\n{more}"


_CHECK = "check_step: near_boundary\n"
FILES = {
    **OSCILLATOR,
    "testbenches/swing.yaml": _bench("swing"),
    "testbenches/fine.pet.yaml": _study("fine", "swing", "{range: [1.5 m, 2.2 m], levels: 200}", _CHECK),
    "testbenches/broken.yaml": _bench("broken", "parameters: {mass.fails_below: 7 ms}\n"),
    "testbenches/rough.pet.yaml": _study("rough", "broken", "{range: [1 m, 3 m], levels: 9}", _CHECK),
    "testbenches/all.yaml": _bench("all", checks=", check_step: true"),
    "testbenches/every.pet.yaml": _study("every", "all", "{range: [1.8 m, 1.9 m], levels: 30}"),
}


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> dse.Workspace:
    folder = tmp_path_factory.mktemp("swing")
    return dse.open(written(folder, FILES))


@pytest.fixture(scope="module")
def fine(workspace: dse.Workspace, tmp_path_factory: pytest.TempPathFactory) -> dse.Results:
    return workspace.studies["fine"].explore(tmp_path_factory.mktemp("out") / "fine", workers=1)


@pytest.mark.thorough
def test_every_wrong_verdict_is_doubtful_and_far_from_the_boundary_none_is(fine: dse.Results) -> None:
    rows = fine.to_pandas()
    is_met = rows["mass.start"] * math.cos(1.0) <= 1.0
    is_wrong = is_met != (rows["R1.verdict"] == "pass")
    assert is_wrong.any()
    doubtful = rows["R1.certainty"] == "doubtful"
    # The error of a method of first order is two bars, to a percent.
    assert doubtful[is_wrong].all()
    # Both steps err to the same side, by 2 % at most.
    assert (np.abs(rows["mass.start"][doubtful] * math.cos(1.0) - 1.0) < 0.02).all()
    checked = rows["R1.certainty"] != ""
    assert is_wrong.sum() < doubtful.sum() <= checked.sum() < 10
    assert (rows["R1.certainty"][checked & ~doubtful] == "certain").all()
    assert rows["end.error"].notna().equals(checked)


def test_what_is_doubtful_is_no_pass_anywhere(fine: dse.Results) -> None:
    summary, rows = fine.summary, fine.to_pandas()
    doubtful = rows[rows["R1.certainty"] == "doubtful"]
    assert summary.checked == (rows["R1.certainty"] != "").sum()
    assert {verdict: n for verdict, n in summary.doubtful["R1"].items() if n} == (
        doubtful["R1.verdict"].value_counts().to_dict()
    )
    assert not summary.is_passed
    tested = fine.export("junit").decode()
    assert tested.count("<skipped") == summary.doubtful["R1"]["pass"]
    assert tested.count("doubtful") == len(doubtful)
    number = int(doubtful.index[0])
    run = fine.run(number)
    assert run.check.certainties == {"R1": "doubtful"}
    assert run.check.errors["end"] == doubtful["end.error"].iloc[0]
    assert "doubtful" in run._repr_html_()
    assert fine.run(0).check.errors == {}


def test_exports_say_it_alike(fine: dse.Results) -> None:
    import json

    table = list(csv.DictReader(io.StringIO(fine.export("csv").decode())))
    runs = json.loads(fine.export("json"))["runs"]
    assert [row["R1.certainty"] for row in table] == [run.get("certainty", {}).get("R1", "") for run in runs]
    bars = [run.get("errors", {}).get("end") for run in runs]
    assert [float(row["end.error [m]"]) if row["end.error [m]"] else None for row in table] == bars


def test_the_page_is_given_what_the_table_has(fine: dse.Results) -> None:
    rows, content = fine.to_pandas(), read_content(fine.folder)
    checked = (rows["R1.certainty"] != "").to_numpy()
    np.testing.assert_array_equal(content.runs.checked, checked)
    np.testing.assert_array_equal(content.metrics[0].error, rows["end.error"])
    # Here all doubts are the margins', and the page judges these itself.
    assert not np.any(content.requirements[0].unsettled)
    doubtful = (rows["R1.certainty"] == "doubtful").sum()
    assert ("checked runs", f"{checked.sum()}, with {doubtful} doubtful verdicts") in content.facts


def test_a_run_is_replayed_as_before(fine: dse.Results, workspace: dse.Workspace) -> None:
    number = int(fine.to_pandas()["end.error"].first_valid_index())
    replay = fine.replay(number, source=workspace.root / "testbenches" / "fine.pet.yaml")
    assert not replay.different


@pytest.mark.thorough
def test_a_variation_that_fails_is_told_and_leaves_doubt(workspace: dse.Workspace, tmp_path: Path) -> None:
    results = workspace.studies["rough"].explore(tmp_path / "rough", workers=1)
    rows = results.to_pandas()
    checked = rows[rows["R1.certainty"] != ""]
    assert set(checked["R1.certainty"]) == {"doubtful"}
    assert checked["end.error"].isna().all()
    assert checked["check"].str.startswith("with half the step: mass.x became nan").all()
    assert set(results.summary.remarks) == set(checked.index)
    unsettled = read_content(results.folder).requirements[0].unsettled
    np.testing.assert_array_equal(unsettled, rows["R1.certainty"] == "doubtful")


@pytest.mark.thorough
def test_error_bars_of_all_runs_tell_what_is_doubtful(workspace: dse.Workspace, tmp_path: Path) -> None:
    rows = workspace.studies["every"].explore(tmp_path / "every", workers=1).to_pandas()
    expected = np.where(rows["R1.margin"].abs() > rows["end.error"], "certain", "doubtful")
    assert rows["R1.certainty"].tolist() == expected.tolist()
    assert set(expected) == {"certain", "doubtful"}


def test_a_check_of_what_is_checked_already_is_refused(workspace: dse.Workspace, tmp_path: Path) -> None:
    folder = tmp_path / "twice"
    written(folder, FILES)
    file = folder / "testbenches" / "every.pet.yaml"
    file.write_text(FILES["testbenches/every.pet.yaml"] + "check_step: near_boundary\n", encoding="utf-8")
    with pytest.raises(DseError, match=r"every\.pet\.yaml:4:13: the bench's check_step repeats every run already"):
        dse.open(folder).studies["every"]
    file.write_text(FILES["testbenches/every.pet.yaml"] + "check_step: near\n", encoding="utf-8")
    with pytest.raises(DseError, match="unknown 'near'"):
        dse.open(folder).studies["every"]
