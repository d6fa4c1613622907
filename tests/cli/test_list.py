"""``dse list``: what a workspace has, and what was found."""

from __future__ import annotations

import csv
import io
import json
import shutil
from collections import Counter

import pytest
from example_study import example_benches, example_designs


@pytest.fixture
def workspace(dse_in, explored, tmp_path):
    """The example with a finished study, a damaged one, and a bench that cannot be read."""
    folder = tmp_path / "work"
    assert dse_in(tmp_path, "init", "work").returncode == 0
    shutil.copytree(explored, folder / "out" / "small")
    (folder / "out" / "nested" / "torn").mkdir(parents=True)
    (folder / "out" / "nested" / "torn" / "study.sqlite").write_bytes(b"this was a study")
    (folder / "testbenches" / "broken.yaml").write_text("testbench: [", encoding="utf-8")
    return folder


def test_designs_benches_and_studies_are_listed_with_what_they_are_about(workspace, dse_in):
    listed = json.loads(dse_in(workspace, "list", "--format", "json").stdout)
    assert [each["name"] for each in listed["designs"]] == example_designs()
    assert [each["name"] for each in listed["benches"]] == sorted([*example_benches(), "broken"])
    study = next(each for each in listed["studies"] if each["name"] == "acc_gains_4d")
    assert study == {
        "name": "acc_gains_4d",
        "file": "testbenches/acc_gains_4d.pet.yaml",
        "title": "All four PD gains at once",
        "testbench": "acc_following",
        "sampler": "latin_hypercube",
        "problem": "",
    }


@pytest.mark.thorough
def test_results_count_runs_by_what_came_of_all_requirements_together(workspace, dse_in):
    listed = json.loads(dse_in(workspace, "list", "--format", "json").stdout)
    (small,) = [each for each in listed["results"] if each["folder"] == "out/small"]
    assert (small["study"], small["state"], small["runs"], small["finished"]) == ("small", "finished", 20, 20)
    counts: Counter[str] = Counter()
    for row in csv.DictReader(io.StringIO(dse_in(workspace, "results", "small").stdout)):
        verdicts = {value for name, value in row.items() if name.endswith(".verdict")}
        order = ("failed to run", "fail", "not exercised", "pass")
        counts[next(verdict for verdict in order if verdict in verdicts)] += 1
        assert row["verdict"] == next(verdict for verdict in order if verdict in verdicts)
    assert {verdict: count for verdict, count in small["verdicts"].items() if count} == counts


@pytest.mark.thorough
def test_what_cannot_be_read_is_listed_with_its_problem(workspace, dse_in):
    done = dse_in(workspace / "designs", "list")
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    (broken,) = [line for line in lines if line.startswith("broken ")]
    (torn,) = [line for line in lines if "nested/torn" in line]
    assert "cannot be read: " in broken
    assert "cannot be read: " in torn
    (small,) = [line for line in lines if "out/small " in line]
    assert "finished" in small


def test_an_empty_workspace_says_what_to_do(tmp_path, dse_in):
    (tmp_path / "components").mkdir()
    done = dse_in(tmp_path, "list")
    assert done.returncode == 0, done.stderr
    assert "no design space" in done.stdout
    assert "dse explore STUDY" in done.stdout
