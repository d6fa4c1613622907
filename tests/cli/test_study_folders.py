"""Where results go if nobody says where, and that they are found by the study's name."""

from __future__ import annotations

import shutil

import pytest
from example_study import small_study


@pytest.fixture(scope="module")
def workspace(dse_in, tmp_path_factory):
    """A workspace with one study, explored without -o from a folder below its root."""
    folder = tmp_path_factory.mktemp("folders") / "work"
    assert dse_in(folder.parent, "init", "work").returncode == 0
    (folder / "testbenches" / "small.pet.yaml").write_text(small_study(2, 2), encoding="utf-8")
    done = dse_in(folder / "testbenches", "explore", "small", "--workers", "1")
    assert done.returncode == 0, done.stderr
    assert f"{folder / 'out' / 'small'}: 4 runs, 4 of them new" in done.stdout
    return folder


@pytest.mark.thorough
def test_a_study_goes_into_the_out_folder_of_its_workspace_and_goes_on_there(workspace, dse_in):
    assert (workspace / "out" / "small" / "study.sqlite").is_file()
    again = dse_in(workspace, "explore", "small")
    assert again.stdout.startswith("out/small: all 4 runs were there")
    assert "next: dse report out/small" in again.stdout
    planned = dse_in(workspace, "explore", "small", "--dry-run")
    assert planned.stdout.startswith("out/small: 4 runs")


@pytest.mark.sampled(3)
@pytest.mark.parametrize("command", ["status", "results", "report", "findings", "best"])
def test_a_study_folder_is_found_by_the_name_of_the_study(workspace, dse_in, command):
    more = ["--minimize", "consumption"] if command == "best" else []
    for folder in (workspace, workspace / "designs"):
        done = dse_in(folder, command, "small", *more)
        assert done.returncode == 0, done.stderr
    assert dse_in(workspace, command, "out/small", *more).stdout == dse_in(workspace, command, "small", *more).stdout


def test_a_path_comes_before_a_name(workspace, dse_in, tmp_path):
    shutil.copytree(workspace, tmp_path / "work")
    (tmp_path / "work" / "small").mkdir()
    done = dse_in(tmp_path / "work", "status", "small")
    assert done.returncode == 1
    assert "small: is not a study folder" in done.stderr


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (
            "report acc_gains",
            "the study 'acc_gains' has no results in out/acc_gains\n    hint: simulate it first: dse explore acc_gains",
        ),
        ("best out/acc_gains", "the study 'acc_gains' has no results in out/acc_gains"),
        (
            "findings acc_following",
            "the test bench 'acc_following' has no results in out/acc_following\n    hint: simulate it first: dse run",
        ),
        ("report acc_gian", "acc_gian: there is no such folder"),
        ("explore acc_following", "'acc_following' is a test bench, not a study\n    hint: dse run acc_following"),
        ("run acc_gains", "'acc_gains' is a study, not a test bench\n    hint: dse explore acc_gains"),
        ("run acc_vehicle", "'acc_vehicle' is a design space, not a test bench"),
        ("enumerate acc_gains", "'acc_gains' is a study, not a design space"),
        ("explore acc_gian", "did you mean 'acc_gains'?"),
    ],
)
def test_a_name_of_another_kind_or_without_results_is_refused_with_the_command_that_takes_it(
    workspace, dse_in, words, said
):
    done = dse_in(workspace, *words.split())
    assert done.returncode == 1
    assert said in done.stderr


@pytest.mark.thorough
def test_a_bench_goes_into_a_folder_called_after_it(workspace, dse_in):
    design = workspace / "designs" / "one.yaml"
    text = (workspace / "designs" / "acc_vehicle.yaml").read_text(encoding="utf-8")
    one = text.replace("design: acc_vehicle", "design: one") + "  only: {require: sensor is camera_mono}\n"
    design.write_text(one, encoding="utf-8")
    bench = (workspace / "testbenches" / "acc_following.yaml").read_text(encoding="utf-8")
    bench = bench.replace("testbench: acc_following", "testbench: on_one").replace("acc_vehicle", "one")
    (workspace / "testbenches" / "on_one.yaml").write_text(bench, encoding="utf-8")
    done = dse_in(workspace, "run", "on_one")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("out/on_one: ")
    assert (workspace / "out" / "on_one" / "study.sqlite").is_file()


@pytest.mark.thorough
def test_shards_are_merged_by_the_name_of_the_study(workspace, dse_in):
    study = small_study(2, 2).replace("study: small", "study: parts")
    (workspace / "testbenches" / "parts.pet.yaml").write_text(study, encoding="utf-8")
    for shard in ("1/2", "2/2"):
        done = dse_in(workspace, "explore", "parts", "--shard", shard)
        assert done.returncode == 0, done.stderr
    assert (workspace / "out" / "parts" / "shard-1-of-2").is_dir()
    done = dse_in(workspace, "merge", "parts")
    assert done.returncode == 0, done.stderr
    assert "out/parts: " in done.stdout
