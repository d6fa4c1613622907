"""Every command as a user runs it."""

from __future__ import annotations

import csv
import io
import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest
from defusedxml import ElementTree
from example_study import example_studies

COMMANDS = (
    *("init", "check", "list", "new", "components", "build", "enumerate", "space", "simulate", "run", "explore"),
    *("world", "status", "results", "findings", "best", "pareto", "refine", "report", "figure", "replay", "drives"),
    *("cache", "compare", "compare-components", "udp"),
)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_explains_itself(dse, command):
    done = dse(command, "--help")
    assert done.returncode == 0
    assert "Usage:" in done.stdout
    assert command in dse("--help").stdout


def test_the_version_is_the_packages(dse):
    from dse import __version__

    assert dse("--version").stdout == f"dse {__version__}\n"


@pytest.mark.thorough
def test_check_counts_what_it_read(dse):
    done = dse("check")
    assert done.returncode == 0
    assert done.stdout.startswith("ok: ")
    assert f" {len(example_studies()) + 1} studies" in done.stdout  # and the small one of the tests


@pytest.mark.thorough
def test_enumerate_counts_for_a_program(dse):
    counted = json.loads(dse("enumerate", "acc_vehicle", "--count", "--format", "json").stdout)
    listed = json.loads(dse("enumerate", "acc_vehicle", "--format", "json").stdout)
    assert counted["design"] == "acc_vehicle"
    assert counted["valid"] == len(listed) < counted["total"]
    assert len({entry["id"] for entry in listed}) == len(listed)


@pytest.mark.thorough
def test_enumerate_lists_as_table_and_csv(dse):
    rows = list(csv.DictReader(io.StringIO(dse("enumerate", "acc_vehicle", "--format", "csv").stdout)))
    table = dse("enumerate", "acc_vehicle", "--limit", "3").stdout
    assert all(row["id"] in table for row in rows[:3])
    assert rows[3]["id"] not in table


@pytest.mark.thorough
def test_simulate_prints_metrics_and_verdicts_for_a_program(dse):
    done = dse("simulate", "acc_following", "--format", "json")
    data = json.loads(done.stdout)
    assert done.returncode == 0
    assert data["outcome"] == "done"
    assert data["metrics"]["final_gap"] == pytest.approx(40.0, abs=0.5)
    assert {entry["verdict"] for entry in data["requirements"].values()} == {"pass"}


@pytest.mark.thorough
def test_simulate_draws_its_figures(dse, tmp_path):
    picture = tmp_path / "run.png"
    assert dse("simulate", "acc_following", "--plot", str(picture)).returncode == 0
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.thorough
def test_a_failed_requirement_gates(dse):
    settings = ["--set", "controller.kp_speed=4.5", "--set", "controller.kd_speed=0"]
    assert dse("simulate", "acc_following", *settings).returncode == 0
    assert dse("simulate", "acc_following", *settings, "--gate").returncode == 3


@pytest.mark.thorough
def test_a_setting_must_name_a_parameter_in_its_unit(dse):
    wrong = dse("simulate", "acc_following", "--set", "controller.kp_sped=1")
    assert wrong.returncode == 1
    assert "did you mean 'kp_speed'?" in wrong.stderr
    assert "expected length" in dse("simulate", "acc_following", "--set", "controller.set_gap=4 kg").stderr
    assert dse("simulate", "acc_following", "--set", "controller.kp_speed").returncode == 2


@pytest.mark.thorough
def test_fmi_2_and_3_give_the_same_bits(dse):
    two = dse("simulate", "acc_following", "--format", "json", "--fmi", "2").stdout
    three = dse("simulate", "acc_following", "--format", "json", "--fmi", "3").stdout
    assert two == three


def test_build_copies_the_fmus(dse, tmp_path):
    done = dse("build", "pd_acc", "straight_road", "-o", str(tmp_path / "fmus"))
    assert done.returncode == 0, done.stderr
    assert sorted(path.name for path in (tmp_path / "fmus").iterdir()) == ["pd_acc.fmu", "straight_road.fmu"]


def test_a_second_explore_does_nothing(dse, explored):
    before = (explored / "study.sqlite").read_bytes()
    done = dse("explore", "small", "-o", str(explored))
    assert done.returncode == 0
    assert "all 20 runs were there" in done.stdout
    assert (explored / "study.sqlite").read_bytes() == before


@pytest.mark.thorough
def test_one_worker_and_two_give_the_same_bytes(dse, explored, tmp_path):
    alone = tmp_path / "small"
    assert dse("explore", "small", "-o", str(alone), "--workers", "1", "--fresh").returncode == 0
    for kind in ("csv", "json", "junit"):
        assert (
            dse("results", str(alone), "--format", kind).stdout
            == dse("results", str(explored), "--format", kind).stdout
        )
    assert {p.name: p.read_bytes() for p in (alone / "waveforms").iterdir()} == {
        p.name: p.read_bytes() for p in (explored / "waveforms").iterdir()
    }
    from dse.report.content.reading import read_content
    from dse.report.page.html import page_of

    pages = [page_of(replace(read_content(folder), study_folder="small")) for folder in (alone, explored)]
    assert pages[0] == pages[1]


@pytest.mark.nightly
def test_another_study_does_not_overwrite_a_folder(dse, explored):
    done = dse("run", "acc_following", "-o", str(explored))
    assert done.returncode == 1
    assert "holds the results of another study" in done.stderr
    assert "--fresh" in done.stderr


@pytest.mark.thorough
def test_findings_are_told_and_given_as_data(dse, explored):
    told = dse("findings", str(explored)).stdout
    data = json.loads(dse("findings", str(explored), "--format", "json").stdout)
    assert {each["topic"] for each in data} <= {line.removesuffix(":") for line in told.splitlines()}
    assert all(f"  {each['text']}\n" in told for each in data)
    assert any(each["topic"] == "requirements met" and each["facts"]["met"] for each in data)


@pytest.mark.thorough
def test_results_come_in_every_format(dse, explored, tmp_path):
    rows = list(csv.DictReader(io.StringIO(dse("results", str(explored)).stdout)))
    runs = json.loads(dse("results", str(explored), "--format", "json").stdout)["runs"]
    suites = ElementTree.fromstring(dse("results", str(explored), "--format", "junit").stdout)
    assert dse("results", str(explored), "--format", "parquet", "-o", str(tmp_path / "r.parquet")).returncode == 0
    assert len(rows) == len(runs) == 20
    assert [float(row["final_speed [km/h]"]) for row in rows] == [run["metrics"]["final_speed"] for run in runs]
    assert "final_speed [m/s]" in dse("results", str(explored), "--si").stdout.splitlines()[0].split(",")
    assert len(list(suites.iter("testcase"))) == 40
    assert (tmp_path / "r.parquet").read_bytes()[:4] == b"PAR1"


def test_the_report_is_one_file_made_without_simulating(dse, explored, tmp_path):
    page = tmp_path / "page.html"
    done = dse("report", str(explored), "-o", str(page))
    assert done.returncode == 0, done.stderr
    text = page.read_text(encoding="utf-8")
    assert text.lower().startswith("<!doctype html>")
    assert "http-equiv" in text


@pytest.mark.thorough
def test_figures_are_drawn_in_every_format(dse, explored, tmp_path):
    for kind, start in (("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")):
        done = dse("figure", str(explored), "--format", kind, "-o", str(tmp_path / kind))
        assert done.returncode == 0, done.stderr
        files = list((tmp_path / kind).iterdir())
        names = sorted(file.stem.split("_")[0] for file in files)
        # The paper's two, all runs as lines, two for each requirement; of effects 20 runs say too little.
        assert [name for name in names if name != "boundary"] == [
            "constraints", "margins", "margins", "parallel", "progress", "progress", "waveforms"
        ]  # fmt: skip
        assert "boundary" in names
        assert all(path.read_bytes().startswith(start) for path in files)


@pytest.mark.thorough
def test_a_run_is_replayed_bit_for_bit(dse, explored):
    done = dse("replay", str(explored), "7")
    assert done.returncode == 0, done.stderr
    assert "the same" in done.stderr


def test_init_never_overwrites(dse, example):
    done = dse("init", str(example))
    assert done.returncode == 1
    assert "not empty" in done.stderr


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["enumerate", "acc_vehical"], "did you mean 'acc_vehicle'?"),
        (["simulate", "nothing"], "unknown test bench 'nothing'"),
        (["explore", "designs", "-o", "x"], "this is a folder, not a file"),
        (["simulate", "acc_following", "-c", "zzzzzz"], "no valid configuration 'zzzzzz'"),
        (["report", "designs"], "designs"),
        (["results", "missing"], "missing"),
        (["replay", "missing", "1"], "missing"),
        (["build", "pd_ac"], "did you mean 'pd_acc'?"),
        (["build", "pd_acc", "--platform", "win46"], "did you mean 'win64'?"),
    ],
)
def test_what_is_not_there_is_named_without_a_traceback(dse, arguments, words):
    done = dse(*arguments)
    assert done.returncode == 1
    assert words in done.stderr
    assert "hint" in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            ["enumerate", "acc_vehicle", "--where", "sensor = lidar_905nm"],
            "write sensor is lidar_905nm for what is chosen",
        ),
        (["enumerate", "acc_vehicle", "--where", "sum(cost) = 900 EUR"], "write == to compare"),
        (["enumerate", "acc_vehicle", "--where", "sum(cost) < 1,5 EUR"], "write 1.5 EUR"),
        (["simulate", "acc_following", "--set", "controller.kp_speed=1,5 1/s"], "write '1.5 1/s'"),
    ],
)
def test_what_is_written_as_elsewhere_is_answered_with_how_it_is_written_here(dse, arguments, words):
    done = dse(*arguments)
    assert done.returncode == 1
    assert words in done.stderr


def test_a_range_with_decimal_commas_is_refused_as_such(dse, example):
    study = (example / "testbenches" / "small.pet.yaml").read_text(encoding="utf-8")
    comma = example / "testbenches" / "comma.pet.yaml"
    comma.write_text(
        study.replace("study: small", "study: comma").replace("[0.5, 4.5]", "[0,5, 4,5]"), encoding="utf-8"
    )
    try:
        done = dse("explore", "comma")
    finally:
        comma.unlink()
    assert done.returncode == 1
    assert "numbers have a decimal point, no comma" in done.stderr


@pytest.mark.sampled(2)
@pytest.mark.skipif(sys.platform != "linux", reason="there is no /proc")
@pytest.mark.parametrize(
    "command", [["explore", "small"], ["report", "STUDY"], ["figure", "STUDY"], ["build", "pd_acc"]]
)
def test_a_place_where_nothing_can_be_made_is_named_with_what_to_do(dse, explored, command):
    done = dse(*(str(explored) if word == "STUDY" else word for word in command), "-o", "/proc/nowhere")
    assert done.returncode == 1
    assert "/proc/nowhere" in done.stderr
    assert "-o" in done.stderr.partition("hint: ")[2]
    assert "Traceback" not in done.stderr


@pytest.mark.thorough
def test_wrong_usage_exits_with_2(dse):
    assert dse("enumerate").returncode == 2
    assert dse("explore").returncode == 2
    assert dse("simulate", "acc_following", "--fmi", "4").returncode == 2


def test_a_picture_that_cannot_be_written_is_refused_before_simulating(dse, tmp_path):
    assert dse("simulate", "acc_following", "--plot", "run.gif").returncode == 2
    assert dse("simulate", "acc_following", "--plot", str(tmp_path / "nowhere" / "run.png")).returncode == 2


def test_one_axis_alone_is_wrong_usage(dse, explored):
    assert dse("figure", str(explored), "--x", "controller.kp_speed").returncode == 2


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "command", [["build", "pd_acc"], ["init"], ["results", "STUDY"], ["report", "STUDY"], ["figure", "STUDY"]]
)
def test_a_place_that_cannot_be_written_is_named_without_a_traceback(dse, explored, tmp_path, command):
    taken = tmp_path / "taken"
    taken.write_text("a file", encoding="utf-8")
    inside = str(taken / "below")
    arguments = [str(explored) if word == "STUDY" else word for word in command]
    done = dse(*arguments, *([inside] if command == ["init"] else ["-o", inside]))
    assert done.returncode == 1
    assert "taken" in done.stderr
    assert "hint" in done.stderr
    assert "Traceback" not in done.stderr


def test_a_bench_coarser_than_a_sample_time_is_refused(dse, example, tmp_path):
    bench = (example / "testbenches" / "acc_following.yaml").read_text(encoding="utf-8")
    coarse = example / "testbenches" / "coarse.yaml"
    coarse.write_text(
        bench.replace("testbench: acc_following", "testbench: coarse").replace("step: 10 ms", "step: 20 ms"),
        encoding="utf-8",
    )
    try:
        done = dse("simulate", "coarse")
    finally:
        coarse.unlink()
    assert done.returncode == 1
    assert "controller (pd_acc) samples every 0.01 s, no multiple of the step 0.02 s" in done.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="interrupts are sent otherwise there")
@pytest.mark.thorough
def test_an_interrupted_study_says_how_to_go_on(example, cache, tmp_path):
    study = (example / "testbenches" / "small.pet.yaml").read_text(encoding="utf-8")
    (example / "testbenches" / "long.pet.yaml").write_text(
        study.replace("study: small", "study: long").replace("levels: 5", "levels: 200"), encoding="utf-8"
    )
    command = [sys.executable, "-m", "dse", "explore", "long", "-o", str(tmp_path / "long"), "-j", "1"]
    environment = {**os.environ, "DSE_CACHE": str(cache)}
    with subprocess.Popen(
        command, cwd=example, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as process:
        deadline = time.monotonic() + 120
        while not list((tmp_path / "long" / "waveforms").glob("*.parquet")) and time.monotonic() < deadline:
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=120)
    (example / "testbenches" / "long.pet.yaml").unlink()
    assert process.returncode == 130
    assert b"the same command resumes from there" in errors
    assert b"Traceback" not in errors


@pytest.mark.thorough
def test_components_are_compared_on_the_same_inputs(dse):
    same = dse("compare-components", "pd_acc", "pd_acc_coded", "--steps", "200", "--input", "speed=0:40")
    assert same.returncode == 0, same.stderr
    assert "equal to 1e-12 in 200 steps of 0.01 s" in same.stdout
    other = dse("compare-components", "pd_acc", "pi_time_gap_acc", "--format", "json", "--input", "set_gap=40")
    assert other.returncode == 3
    found = json.loads(other.stdout)
    assert found["parameters"]["kp_speed"] == [1.2, 0.7]
    assert found["outputs"]["demand.drive_torque"]["absolute"] > 1
    assert found["outputs"]["reference.gap"] == {
        "unit": "m",
        "absolute": 0.0,
        "relative": 0.0,
        "time": 0.0,
        "values": [40.0, 40.0],
        "moves": False,
    }


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (["pd_acc", "hydraulic_booster"], 1, "'pd_acc' implements 'acc_controller', 'hydraulic_booster' 'brake'"),
        (["pd_acc", "idm_acc", "--input", "sped=1"], 1, "there is no input 'sped'"),
        (["pd_acc", "idm_acc", "--input", "speed"], 2, "is not NAME=LOW:HIGH"),
        (["pd_acc", "idm_acc", "--input", "speed=cycle.csv:v"], 1, "no such file: cycle.csv"),
    ],
)
def test_components_that_cannot_be_compared_are_refused_by_name(dse, arguments, code, said):
    done = dse("compare-components", *arguments)
    assert done.returncode == code
    assert said in " ".join(done.stderr.replace("│", " ").split())
    assert "Traceback" not in done.stderr
