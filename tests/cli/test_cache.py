"""``dse cache``, and commands that meet a damaged cache."""

from __future__ import annotations

import json
import os
import shutil
import time

import pytest
from command_line import run_dse


@pytest.fixture(scope="module")
def two_fmus(example, tmp_path_factory):
    folder = tmp_path_factory.mktemp("two") / "kept"
    done = run_dse(example, "build", "pd_acc", "lidar_905nm", cache=folder)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture
def kept(tmp_path, example, two_fmus):
    """A cache with two FMUs in it, and a way to run ``dse`` with it."""
    folder = shutil.copytree(two_fmus, tmp_path / "kept")

    def run(*arguments):
        return run_dse(example, *arguments, cache=folder)

    run.folder = folder
    return run


def test_what_is_damaged_heals_by_the_same_command_with_a_note_beside_its_output(kept):
    before = kept("build", "pd_acc", "lidar_905nm")
    archive = next(kept.folder.glob("built/pd_acc-*.fmu"))
    whole = archive.read_bytes()
    os.truncate(archive, 1000)
    healed = kept("build", "pd_acc", "lidar_905nm")
    assert (healed.returncode, healed.stdout) == (0, before.stdout)
    assert healed.stderr == f"note: the cache entry {archive} is damaged and has to be made again\n"
    assert archive.read_bytes() == whole
    assert kept("build", "pd_acc", "lidar_905nm").stderr == ""


def test_the_cache_is_shown(kept):
    shown = kept("cache", "show").stdout
    assert shown.startswith(f"{kept.folder}\n")
    told = json.loads(kept("cache", "show", "--format", "json").stdout)
    kinds = {kind.pop("kind"): kind for kind in told["kinds"]}
    assert told["folder"] == str(kept.folder)
    assert kinds["built"]["entries"] == 2
    assert kinds["built"]["size"] == sum(path.stat().st_size for path in kept.folder.glob("built/*.fmu"))
    assert told["size"] == sum(kind["size"] for kind in kinds.values())
    assert kinds["built"]["oldest_use"][:4] == time.strftime("%Y", time.gmtime())
    assert all(name in shown for name in kinds)


def test_an_empty_cache_is_shown(example, tmp_path):
    done = run_dse(example, "cache", "show", cache=tmp_path / "none")
    assert done.stdout == f"{tmp_path / 'none'}\nit is empty\n"
    assert not (tmp_path / "none").exists()


def test_what_is_damaged_is_removed_and_named(kept):
    assert "are whole" in kept("cache", "verify").stdout
    archive = next(kept.folder.glob("built/pd_acc-*.fmu"))
    archive.write_bytes(b"")
    found = kept("cache", "verify")
    assert (found.returncode, found.stderr) == (0, "")
    assert f"damaged, removed: built/{archive.name}\n" in found.stdout
    assert found.stdout.endswith("are whole, 1 removed\n")
    assert not archive.exists()
    assert "removed" not in kept("cache", "verify").stdout


def test_what_nobody_uses_is_pruned(kept):
    assert kept("cache", "prune").stdout == "0 entries removed, 0 B\n"
    for path in kept.folder.glob("built/pd_acc*"):
        os.utime(path, (0, 0))
    assert kept("cache", "prune").stdout.startswith("1 entry removed, ")
    assert len(list(kept.folder.glob("built/*.fmu"))) == 1
    kept("cache", "prune", "--size", "0 B")
    assert list(kept.folder.glob("built/*")) == []
    assert list(kept.folder.glob("compilers/*"))
    wrong = kept("cache", "prune", "--size", "much")
    assert (wrong.returncode, "'much' is not an amount of memory" in wrong.stderr) == (2, True)
