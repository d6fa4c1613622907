"""Shards as a batch queue has them: one command each, then a merge."""

from __future__ import annotations

import pytest


@pytest.mark.parametrize("shard", ["0/8", "9/8", "3", "3/8/2", "a/b", "-1/8"])
def test_what_is_no_shard_is_a_mistake_in_usage(dse, tmp_path, shard):
    done = dse("explore", "small", "-o", str(tmp_path / "out"), f"--shard={shard}")
    assert done.returncode == 2
    assert "is not I/N" in done.stderr


def test_a_folder_without_shards_cannot_be_merged(dse, tmp_path):
    (tmp_path / "out").mkdir()
    done = dse("merge", str(tmp_path / "out"))
    assert done.returncode == 1
    assert "contains no shards" in done.stderr


@pytest.mark.thorough
def test_what_is_merged_is_what_one_command_makes(dse, explored, tmp_path):
    out = tmp_path / "out"
    for number in (1, 3):
        done = dse("explore", "small", "-o", str(out), "-j", "1", "--fresh", "--shard", f"{number}/3")
        assert done.returncode == 0, done.stderr
        assert done.stdout.endswith(f"next: dse merge {out}\n")
    merged = dse("merge", str(out))
    assert merged.returncode == 0, merged.stderr
    assert f"{out}: 13 of 20 runs, from 2 folders\n  shard-2-of-3 is not there\n" in merged.stdout
    assert dse("explore", "small", "-o", str(out), "-j", "1", "--fresh", "--shard", "2/3").returncode == 0
    assert f"{out}: 20 of 20 runs, from 3 folders\nnext: dse report {out}\n" in dse("merge", str(out)).stdout
    assert dse("results", str(out)).stdout == dse("results", str(explored)).stdout
    kept = [{path.name: path.read_bytes() for path in (each / "waveforms").iterdir()} for each in (out, explored)]
    assert kept[0] == kept[1]
    pages = []
    for each in (out, explored):
        assert dse("report", str(each), "-o", str(tmp_path / "page.html")).returncode == 0
        pages.append((tmp_path / "page.html").read_bytes())
    assert pages[0] == pages[1]
    assert "all 20 runs were there" in dse("explore", "small", "-o", str(out)).stdout
