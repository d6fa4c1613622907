"""``dse explore --dry-run`` and what is said when a study's files have changed."""

from __future__ import annotations

import json
import shutil

import pytest


def test_a_dry_run_tells_what_would_be_done_and_does_nothing(dse, explored, tmp_path):
    before = (explored / "study.sqlite").read_bytes()
    done = dse("explore", "small", "-o", str(explored), "--dry-run")
    assert done.returncode == 0, done.stderr
    assert done.stdout.split("small: ")[1].splitlines() == [
        "20 runs, configurations: 1",
        "  stay in the folder         20",
        "  made before, in the cache  0",
        "  to be simulated            0",
    ]
    assert (explored / "study.sqlite").read_bytes() == before
    done = dse("explore", "small", "-o", str(tmp_path / "new"), "--dry-run", "--fresh", "--format", "json")
    plan = json.loads(done.stdout)
    assert (plan["runs"], plan["missing"], plan["known"]) == (20, 20, 0)
    assert plan["seconds"] > 0
    assert not (tmp_path / "new").exists()


@pytest.mark.thorough
def test_what_changed_is_said_before_it_is_simulated(dse_in, example, explored, tmp_path):
    root = shutil.copytree(example, tmp_path / "work")
    out = shutil.copytree(explored, tmp_path / "small")
    bench = root / "testbenches" / "acc_following.yaml"
    bench.write_text(bench.read_text(encoding="utf-8").replace("lead_speed: 50 km/h", "lead_speed: 51 km/h"), "utf-8")
    done = dse_in(root, "explore", "small", "-o", str(out), "-j", "1")
    assert done.returncode == 0, done.stderr
    assert "changed                    parameter world.lead_speed" in done.stderr
    assert "to be simulated            20, configurations: 1" in done.stderr
    assert "20 runs, 20 of them new" in done.stdout


@pytest.mark.thorough
def test_a_dry_run_of_a_shard_or_of_failures_tells_of_them_only(dse, explored, tmp_path):
    done = dse("explore", "small", "-o", str(tmp_path / "new"), "--dry-run", "--shard", "1/2", "--format", "json")
    assert done.returncode == 0, done.stderr
    assert 0 < json.loads(done.stdout)["known"] < 20
    done = dse("explore", "small", "-o", str(explored), "--dry-run", "--retry-failed", "--format", "json")
    assert json.loads(done.stdout)["there"] == 20
