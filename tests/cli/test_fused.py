"""``--fuse`` as a user types it: the same results, faster."""

from __future__ import annotations

import json

import pytest


@pytest.mark.thorough
def test_a_fused_configuration_gives_the_same_metrics(dse):
    plain, fused = (dse("simulate", "acc_following", "--format", "json", *more) for more in ([], ["--fuse"]))
    assert fused.returncode == 0, fused.stderr
    assert json.loads(fused.stdout) == json.loads(plain.stdout)


@pytest.mark.thorough
def test_a_fused_study_fills_the_same_table(dse, explored, tmp_path):
    done = dse("explore", "small", "--fuse", "--fresh", "-o", str(tmp_path / "fused"))
    assert done.returncode == 0, done.stderr
    tables = [dse("results", str(folder), "--format", "json").stdout for folder in (explored, tmp_path / "fused")]
    assert json.loads(tables[0]) == json.loads(tables[1])


@pytest.mark.thorough
def test_build_fuse_makes_the_library_of_a_configuration(dse, tmp_path):
    wanted = json.loads(dse("simulate", "acc_following", "--format", "json").stdout)["configuration"]
    done = dse("build", "--fuse", "acc_following", "--configuration", wanted, "-o", str(tmp_path))
    assert done.returncode == 0, done.stderr
    (line,) = done.stdout.splitlines()
    assert line.startswith(f"{wanted}: ")
    assert [file.stem for file in tmp_path.iterdir()] == [wanted]


def test_build_takes_components_or_a_bench(dse):
    for arguments, said in (
        (["pd_acc", "--fuse", "acc_following"], "either components or a test bench"),
        (["--fuse", "acc_following", "--platform", "win64"], "a fused library is for this machine only"),
        (["--configuration", "x"], "this is for a test bench"),
    ):
        done = dse("build", *arguments)
        assert done.returncode == 2
        assert said in " ".join(done.stderr.split())
