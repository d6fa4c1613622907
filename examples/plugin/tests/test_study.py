"""The study of the README, with all five at work."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import dse
from dse.api.studies.results import Results

WORKSPACE = Path(__file__).parents[1] / "workspace"


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Results:
    root = tmp_path_factory.mktemp("plugin") / "workspace"
    shutil.copytree(WORKSPACE, root, ignore=shutil.ignore_patterns("out"))
    return dse.open(root).studies["softest"].explore(root / "out")


def test_nothing_is_wrong_with_the_workspace() -> None:
    assert dse.open(WORKSPACE).check() == ()


def test_the_boundary_is_found_where_it_is(results: Results) -> None:
    frame = results.to_pandas()
    stiffest = frame[frame["R1.verdict"] == "pass"].groupby("configuration")["spring.factor"].max()
    softest = frame[frame["R1.verdict"] == "fail"].groupby("configuration")["spring.factor"].min()
    # The spring is given its travel a step late: 500 N over 0.99 m, of 247.5 N and of 394 N.
    assert sorted(stiffest) == pytest.approx([500 / 394, 500 / 247.5], abs=0.01)
    assert (softest - stiffest).max() <= 0.01


def test_the_local_executor_gives_the_same_bits(results: Results, tmp_path: Path) -> None:
    root = tmp_path / "workspace"
    shutil.copytree(WORKSPACE, root, ignore=shutil.ignore_patterns("out"))
    study = root / "testbenches" / "softest.pet.yaml"
    text = study.read_text(encoding="utf-8")
    study.write_text(text.replace("executor: {futures: {workers: 2}}", "executor: local"), encoding="utf-8")
    again = dse.open(root).studies["softest"].explore(root / "out")
    assert again.export("csv") == results.export("csv")
    kept = [sorted((each.folder / "waveforms").iterdir()) for each in (results, again)]
    assert [path.read_bytes() for path in kept[0]] == [path.read_bytes() for path in kept[1]]


def test_the_report_has_the_figure(results: Results, tmp_path: Path) -> None:
    page = results.report(tmp_path / "report.html").read_text(encoding="utf-8")
    assert "Runs per configuration" in page


def test_a_finished_study_makes_no_run(results: Results) -> None:
    again = dse.open(results.folder.parent).studies["softest"].explore(results.folder)
    assert again.explored is not None
    assert (again.explored.new, again.explored.again) == (0, 0)
