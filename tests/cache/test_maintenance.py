"""The cache is shown, checked and cleared, whatever lies in it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pytest

import dse
from dse.cache import SECTIONS, CacheWarning, damaged, keep, keep_file, keep_files, left_overs, survey, take_out, unused
from dse.cache.entries import digest_file
from dse.cache.folder import aside
from dse.cli import answers
from dse.errors import DseError


@pytest.fixture
def root(tmp_path):
    """A cache with four entries: one file, two folders, one of plain data."""
    keep_file(tmp_path / "built" / "x.fmu", lambda: b"x" * 1000)
    keep_files(tmp_path / "unpacked" / "u", lambda: {"a": b"a" * 300, "b": b""})
    keep_files(tmp_path / "fused" / "parts" / "p", lambda: {"p.o": b"p" * 10})
    keep(tmp_path / "units" / "k", "k", b"m")
    return tmp_path


def listed(entries):
    return [f"{entry.section.name}/{entry.path.name}" for entry in entries]


def age(root, days):
    """Let nothing have been used for *days*."""
    then = time.time() - days * 86400
    for path in root.rglob("*"):
        os.utime(path, (then, then))


def test_every_folder_of_the_cache_is_in_the_table():
    named = r'cache_folder\([^)]*\)(?:\.absolute\(\))? / "([^".]+)"(?: / "([^"]+)")?'
    sources = [path.read_text(encoding="utf-8") for path in Path(dse.__file__).parent.rglob("*.py")]
    folders = {"/".join(filter(None, found)) for text in sources for found in re.findall(named, text)}
    folders |= {answers.FOLDER}
    assert {"built", "unpacked", "fused/parts", "units"} < folders
    assert sorted(folders) == sorted(shelf.name for shelf in SECTIONS)


def test_every_entry_is_counted_with_its_size(root):
    found = {
        shelf.name: [(entry.path.name, entry.size) for entry in entries] for shelf, entries in survey(root).items()
    }
    assert found["built"] == [("x.fmu", 1000)]
    assert found["fused/parts"][0][0] == "p"
    assert found["unpacked"][0][1] >= 300
    assert {*found} == {"built", "unpacked", "fused/parts", "units"}


DAMAGE = {
    "built/x.fmu": [Path.unlink, lambda path: os.truncate(path, 7)],
    "unpacked/u": [lambda path: (path / "b").unlink(), lambda path: (path / "c").touch()],
    "units/k": [lambda path: os.truncate(path, 0), lambda path: os.truncate(path, 20)],
}


@pytest.mark.parametrize(("name", "damage"), [(name, damage) for name, each in DAMAGE.items() for damage in each])
def test_what_is_damaged_is_found_and_taken_out(root, name, damage):
    assert damaged(root, lambda _: None) == []
    damage(root / name)
    found = damaged(root, lambda _: None)
    assert listed(found) == [name]
    take_out(entry.path for entry in found)
    assert damaged(root, lambda _: None) == []
    assert name not in listed(entry for entries in survey(root).values() for entry in entries)
    assert len(survey(root)) == 3


def test_looking_for_damage_is_no_use_and_tells_nothing_to_others(root):
    age(root, 100)
    damaged(root, lambda _: None)
    assert len(unused(root, days=99)) == 4
    keep_file(root / "built" / "x.fmu", lambda: b"")
    assert len(unused(root, days=99)) == 3


def test_what_earlier_versions_left_is_damaged_but_for_what_is_in_the_making(root):
    digest_file(root / "built" / "x.fmu").unlink()
    assert damaged(root, lambda _: None) == []
    age(root, 1)
    assert listed(damaged(root, lambda _: None)) == ["built/x.fmu"]


def test_what_was_used_longest_ago_makes_room(root):
    for days, name in ((3, "built/x.fmu"), (2, "unpacked/u"), (1, "fused/parts/p")):
        then = time.time() - days * 86400
        os.utime(digest_file(root / name), (then, then))
    assert listed(unused(root, days=1.5)) == ["unpacked/u", "built/x.fmu"]
    size = sum(entry.size for entries in survey(root).values() for entry in entries)
    assert unused(root, size=size) == []
    assert listed(unused(root, size=size - 1)) == ["built/x.fmu"]
    assert len(unused(root, size=0)) == 4


def test_what_is_taken_out_is_absent_not_gone(root, recwarn):
    take_out([root / "built" / "x.fmu"])
    assert keep_file(root / "built" / "x.fmu", lambda: b"again").read_bytes() == b"again"
    assert not [warning for warning in recwarn if issubclass(warning.category, CacheWarning)]


def test_only_what_ended_processes_left_is_left_over(root, monkeypatch):
    code = (
        "import os, sys; from pathlib import Path; from dse.cache.folder import aside\n"
        "with aside(Path(sys.argv[1])) as made: os._exit(0)"
    )
    subprocess.run([sys.executable, "-c", code, str(root / "built")], check=True)
    old = Path(tempfile.mkdtemp(prefix=".", suffix=".tmp", dir=root / "fused" / "parts"))
    with aside(root / "built") as mine:
        (left,) = left_overs(root)
        assert left != mine
        os.utime(old, (0, 0))
        assert left_overs(root) == [left, old]
        take_out(left_overs(root))
        assert mine.is_dir()
    assert len(survey(root)) == 4


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() == 0, reason="nothing is read-only for root")
def test_a_folder_that_cannot_be_written_is_named(root):
    (root / "built").chmod(0o500)
    with pytest.raises(DseError, match=r"the cache folder .*built cannot be written: permission denied"):
        take_out([root / "built" / "x.fmu"])
