"""``dse enumerate`` and ``dse space graph`` as a user runs them."""

from __future__ import annotations

import csv
import io
import json
import os
import subprocess
import sys

import pyarrow.parquet as pq
import pytest
from defusedxml import ElementTree


def listed(dse, *options):
    done = dse("enumerate", "acc_vehicle", "--format", "jsonl", *options)
    assert done.returncode == 0, done.stderr
    return [json.loads(line) for line in done.stdout.splitlines()]


@pytest.mark.parametrize("suffix", ["csv", "json", "jsonl", "parquet"])
@pytest.mark.thorough
def test_a_file_is_written_in_the_format_of_its_suffix(dse, tmp_path, suffix):
    target = tmp_path / f"out.{suffix}"
    done = dse("enumerate", "acc_vehicle", "-o", str(target))
    assert done.returncode == 0, done.stderr
    wanted = [entry["id"] for entry in listed(dse)]
    match suffix:
        case "csv":
            found = [row["id"] for row in csv.DictReader(io.StringIO(target.read_text(encoding="utf-8")))]
        case "json":
            found = [entry["id"] for entry in json.loads(target.read_text(encoding="utf-8"))]
        case "jsonl":
            found = [json.loads(line)["id"] for line in target.read_text(encoding="utf-8").splitlines()]
        case "parquet":
            found = pq.read_table(target)["id"].to_pylist()
    assert found == wanted
    assert f"{len(wanted)} configurations" in done.stdout


@pytest.mark.thorough
def test_a_condition_narrows_the_list_and_the_count(dse):
    condition = "sensor is lidar_905nm and sum(cost) <= 9000 EUR"
    wanted = [
        e for e in listed(dse) if e["choices"]["sensor"] == "lidar_905nm" and e["totals"]["cost"]["value"] <= 9000
    ]
    assert listed(dse, "--where", condition) == wanted
    counted = json.loads(dse("enumerate", "acc_vehicle", "--count", "--where", condition, "--format", "json").stdout)
    assert (counted["valid"], counted["exact"]) == (len(wanted), True)


def test_a_wrong_condition_is_located_in_the_option(dse):
    done = dse("enumerate", "acc_vehicle", "--where", "sensor is lidar_905")
    assert done.returncode == 1
    assert "--where:1:11" in done.stderr
    assert "lidar_905nm" in done.stderr


@pytest.mark.thorough
def test_a_sample_is_drawn_from_the_list_and_repeats_with_its_seed(dse):
    drawn = listed(dse, "--sample", "20", "--seed", "3")
    assert drawn == listed(dse, "--sample", "20", "--seed", "3") != listed(dse, "--sample", "20", "--seed", "4")
    assert {entry["id"] for entry in drawn} <= {entry["id"] for entry in listed(dse)}
    assert "20 drawn" in dse("enumerate", "acc_vehicle", "--sample", "20").stdout


@pytest.mark.thorough
def test_a_table_of_many_stops_and_says_so(dse, tmp_path, example):
    text = (example / "designs" / "acc_vehicle.yaml").read_text(encoding="utf-8")
    free = example / "designs" / "free.yaml"
    free.write_text(text.replace("design: acc_vehicle", "design: free").partition("constraints:")[0], encoding="utf-8")
    try:
        shown = dse("enumerate", "free").stdout.splitlines()
        assert len(shown) == 1 + 100 + 2
        assert shown[-2] == "the first 100; 624 in total before the static constraints"
        assert "--limit" in shown[-1]
        assert len(dse("enumerate", "free", "--format", "csv").stdout.splitlines()) == 1 + 624
        assert len(dse("enumerate", "free", "--limit", "150").stdout.splitlines()) == 1 + 150 + 1
    finally:
        free.unlink()


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--exact"], "goes with --count"),
        (["--sample", "2", "--limit", "2"], "one of --sample and --limit"),
        (["--count", "--format", "parquet"], "a count is one number"),
        (["--count", "-o", "x.json"], "--count only counts them"),
        (["--count", "--sample", "3"], "--count only counts them"),
        (["--count", "--limit", "3"], "--count only counts them"),
        (["-o", "x.json", "--format", "csv"], "'x.json' is not the name of a .csv file"),
        (["--where", " "], "the condition is empty"),
    ],
)
def test_options_that_do_not_go_together_are_wrong_usage(dse, options, said):
    done = dse("enumerate", "acc_vehicle", *options)
    assert done.returncode == 2
    assert said in " ".join(done.stderr.split())


@pytest.mark.thorough
def test_an_unknown_suffix_and_an_unknown_set_are_named(dse, tmp_path):
    assert (
        "cannot determine the format of 'out.xlsx'"
        in dse("enumerate", "acc_vehicle", "-o", str(tmp_path / "out.xlsx")).stderr
    )
    assert "has no constraint set 'budgets'" in dse("enumerate", "acc_vehicle", "--off", "budgets").stderr


@pytest.mark.thorough
def test_the_graph_is_drawn_with_the_configuration(dse, tmp_path):
    target = tmp_path / "graph.svg"
    entry = listed(dse, "--limit", "1")[0]
    done = dse("space", "graph", "acc_vehicle", "-o", str(target), "-c", entry["id"])
    assert done.returncode == 0, done.stderr
    ElementTree.fromstring(target.read_text(encoding="utf-8"))
    by_id = target.read_bytes()
    choices = [f"--choose={path}={name}" for path, name in entry["choices"].items()]
    assert dse("space", "graph", "acc_vehicle", "-o", str(target), *choices).returncode == 0
    assert target.read_bytes() == by_id
    assert b"meets every static constraint" in by_id


def test_a_configuration_that_breaks_a_rule_is_drawn_and_says_which(dse, tmp_path):
    target = tmp_path / "graph.svg"
    chosen = "sensor=camera_mono", "controller=idm_acc", "brake=brake_by_wire", "powertrain=bev_ideal", "video=absent"
    assert dse("space", "graph", "acc_vehicle", "-o", str(target), *(f"--choose={c}" for c in chosen)).returncode == 0
    assert "breaks" in target.read_text(encoding="utf-8")
    assert "no_model_on_camera" in target.read_text(encoding="utf-8")


def test_choices_that_do_not_exist_are_named(dse, tmp_path):
    done = dse("space", "graph", "acc_vehicle", "-o", str(tmp_path / "g.svg"), "--choose", "sensor=radar")
    assert done.returncode == 1
    assert "'sensor' cannot be 'radar'" in done.stderr
    assert dse("space", "graph", "acc_vehicle", "-o", str(tmp_path / "g.png")).returncode == 2


@pytest.mark.thorough
@pytest.mark.sampled(3)
@pytest.mark.skipif(sys.platform == "win32", reason="Windows has no EPIPE")
@pytest.mark.parametrize(
    "options", [["enumerate", "acc_vehicle", "--format", "csv"], ["enumerate", "acc_vehicle"], ["-h"]]
)
def test_a_reader_that_goes_away_is_no_failure(example, options):
    reading, writing = os.pipe()
    os.close(reading)
    command = [sys.executable, "-m", "dse", *options]
    try:
        done = subprocess.run(command, cwd=example, stdout=writing, stderr=subprocess.PIPE, check=False, timeout=120)
    finally:
        os.close(writing)
    assert (done.returncode, done.stderr) == (0, b"")


@pytest.mark.thorough
def test_a_count_under_a_condition_says_so(dse):
    options = ["enumerate", "acc_vehicle", "--count", "--where", "sensor is lidar_905nm"]
    assert "combinations are valid and meet the condition" in dse(*options).stdout
    assert json.loads(dse(*options, "--format", "json").stdout)["where"] == "sensor is lidar_905nm"
    (row,) = csv.DictReader(io.StringIO(dse(*options, "--format", "csv").stdout))
    assert (row["where"], row["exact"]) == ("sensor is lidar_905nm", "true")


def test_choices_of_nothing_name_what_was_asked(dse):
    choice = ["--choose", "sensor=camera_mono", "--choose", "controller=idm_acc"]
    done = dse("space", "choices", "acc_vehicle", *choice, "--where", "sum(cost) <= 1 EUR")
    assert done.returncode == 1
    assert "no valid configuration with sensor=camera_mono, " in done.stderr
    assert f"dse space conflict acc_vehicle {' '.join(choice)} --where 'sum(cost) <= 1 EUR'" in done.stderr


@pytest.mark.parametrize("option", ["--minimize", "--maximize"])
def test_a_wrong_objective_is_located_in_its_option(dse, option):
    done = dse("space", "best", "acc_vehicle", option, "sum(cots)")
    assert done.returncode == 1
    assert f"{option}:1:5: " in done.stderr
