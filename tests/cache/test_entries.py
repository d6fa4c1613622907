"""What is taken from the cache is what was put into it, whatever happened to the folder meanwhile."""

from __future__ import annotations

import errno
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from dse.cache import CacheWarning, entries, folder as rooms, keep_content, keep_file, keep_files, keep_folder
from dse.cache.entries import digest_file
from dse.errors import DseError

CONTENT = b"a library" * 1000


def emptied(path):
    path.write_bytes(b"")


def cut_short(path):
    os.truncate(path, 100)


def flipped(path):
    """One bit differs; size and time do not."""
    before = path.stat()
    content = bytearray(path.read_bytes())
    content[17] ^= 1
    path.write_bytes(content)
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))


def turned_into_a_folder(path):
    path.unlink()
    (path / "below").mkdir(parents=True)


def turned_into_a_link(path):
    path.rename(path.with_name("elsewhere"))
    path.symlink_to(path.with_name("elsewhere"))


DAMAGE = [emptied, cut_short, flipped, Path.unlink, turned_into_a_folder, turned_into_a_link]


@pytest.fixture
def fresh(monkeypatch):
    """Forgets what was checked, as another process that begins."""
    return lambda: monkeypatch.setattr(entries, "_checked", {})


def never():
    raise AssertionError("it is made again")


@pytest.mark.parametrize("damage", DAMAGE)
@pytest.mark.parametrize("is_same_process", [True, False], ids=["same process", "another process"])
def test_a_damaged_file_is_made_again_and_told(tmp_path, fresh, damage, is_same_process):
    target = tmp_path / "built" / "x.so"
    assert keep_file(target, lambda: CONTENT) == target
    assert keep_file(target, never).read_bytes() == CONTENT
    damage(target)
    if not is_same_process:
        fresh()
    with pytest.warns(CacheWarning, match=rf"the cache entry {target} is (damaged|gone) and has to be made again"):
        keep_file(target, lambda: CONTENT)
    assert not target.is_symlink()
    assert keep_file(target, never).read_bytes() == CONTENT
    assert len(list(target.parent.glob(".*"))) == 0


FILES = {"first": b"1", "second": CONTENT}


def fill(target):
    for place in ("", "below/deeper"):
        (target / place).mkdir(parents=True, exist_ok=True)
        for name, content in FILES.items():
            (target / place / name).write_bytes(content)
    (target / "empty").mkdir()


def listed(target):
    return {p.relative_to(target).as_posix(): p.read_bytes() if p.is_file() else None for p in target.rglob("*")}


FOLDER_DAMAGE = {
    **{damage.__name__: lambda at, damage=damage: damage(at / "below" / "deeper" / "second") for damage in DAMAGE},
    "more": lambda at: (at / "below" / "left behind").write_bytes(b""),
    "more folders": lambda at: (at / "below" / "more" / "of them").mkdir(parents=True),
    "less": lambda at: shutil.rmtree(at / "below"),
    "less of what is empty": lambda at: (at / "empty").rmdir(),
    "nothing": shutil.rmtree,
    "a file": lambda at: (shutil.rmtree(at), at.write_bytes(b"a file")),
    "a folder for a file": lambda at: turned_into_a_folder(at / "second"),
    "a file for a folder": lambda at: (shutil.rmtree(at / "below"), (at / "below").write_bytes(b"")),
    "a link to a folder": lambda at: turned_into_a_link(at / "below"),
    "a pipe": lambda at: ((at / "first").unlink(), os.mkfifo(at / "first")),
}


@pytest.mark.parametrize("damage", FOLDER_DAMAGE)
def test_a_damaged_folder_is_made_again_and_told(tmp_path, damage):
    target = keep_folder(tmp_path / "unpacked" / "x", fill)
    whole = listed(target)
    assert keep_folder(target, never) == target
    FOLDER_DAMAGE[damage](target)
    assert damage == "nothing" or target.is_file() or listed(target) != whole or damage == "turned_into_a_link"
    with pytest.warns(CacheWarning, match="unpacked"):
        keep_folder(target, fill)
    assert listed(keep_folder(target, never)) == whole
    assert not any(path.is_symlink() for path in target.rglob("*"))


def test_nothing_is_written_into_a_file_that_may_be_mapped(tmp_path):
    target = keep_files(tmp_path / "x", lambda: FILES)
    first, second = (target / name for name in FILES)
    whole, damaged = first.stat().st_ino, second.stat().st_ino
    os.link(second, tmp_path / "mapped")
    flipped(second)
    seen = (tmp_path / "mapped").read_bytes()
    with pytest.warns(CacheWarning):
        keep_files(target, lambda: FILES)
    assert (tmp_path / "mapped").read_bytes() == seen
    assert second.stat().st_ino != damaged
    assert first.stat().st_ino == whole


@pytest.mark.parametrize("left", [None, "", "cut off"])
def test_what_has_no_digest_is_made_again_without_a_word(tmp_path, left):
    """So it is left by earlier versions, and by a power cut."""
    target = keep_file(tmp_path / "x", lambda: b"half of it")
    if left is None:
        digest_file(target).unlink()
    else:
        digest_file(target).write_text(left)
    assert keep_file(target, lambda: CONTENT).read_bytes() == CONTENT
    assert keep_file(target, never).read_bytes() == CONTENT


def test_everything_is_on_the_disk_before_it_has_its_name(tmp_path, monkeypatch):
    synced, moved = set(), []

    really_replace = Path.replace

    def replace(made, target):
        below = [made, *made.rglob("*")]
        moved.append((target.name, {path.stat().st_ino for path in below} <= synced))
        really_replace(made, target)

    monkeypatch.setattr(os, "fsync", lambda file: synced.add(os.fstat(file).st_ino))
    monkeypatch.setattr(Path, "replace", replace)
    keep_folder(tmp_path / "x", fill)
    keep_file(tmp_path / "y", lambda: CONTENT)
    assert moved == [(name, True) for name in ("x", "x.digest", "y", "y.digest")]
    assert tmp_path.stat().st_ino in synced


HEAL = """
import os, sys, warnings
from pathlib import Path
from dse.cache import keep_folder
warnings.simplefilter("ignore")
os.fsync = lambda file: None
target = Path(sys.argv[1])
def fill(folder):
    for number in range(40):
        (folder / str(number)).write_bytes(bytes([number]) * 5000)
for turn in range(8):
    keep_folder(target, fill)
    assert all((target / str(number)).read_bytes() == bytes([number]) * 5000 for number in range(10, 40))
    for number in range(10):
        if turn % 3 == 0:
            (target / str(number)).unlink(missing_ok=True)
"""


def test_processes_that_mend_one_entry_at_once_do_not_meet(tmp_path):
    """Files 10 to 39 are right all the time, so they must be there all the time."""
    command = [sys.executable, "-c", HEAL, str(tmp_path / "x")]
    healers = [subprocess.Popen(command, stderr=subprocess.PIPE, text=True) for _ in range(3)]
    assert [healer.communicate()[1] for healer in healers] == [""] * 3
    assert [path.name for path in tmp_path.iterdir() if path.suffix == ".tmp"] == []


def fails(number):
    def fail(*_arguments, **_options):
        raise OSError(number, os.strerror(number))

    return fail


def test_a_warm_cache_may_be_read_only(tmp_path, fresh, monkeypatch):
    target = keep_file(tmp_path / "x", lambda: CONTENT)
    os.utime(digest_file(target), (0, 0))
    monkeypatch.setattr(tempfile, "mkdtemp", fails(errno.EROFS))
    monkeypatch.setattr(os, "utime", fails(errno.EROFS))
    fresh()
    assert keep_file(target, never) == target
    assert keep_content(tmp_path / "y", lambda: b"worked out") == b"worked out"
    with pytest.raises(DseError, match=rf"^the cache folder {tmp_path} cannot be written: read-only file system\n"):
        keep_file(tmp_path / "y", lambda: CONTENT)


@pytest.mark.parametrize("place", [(os, "lstat"), (os, "scandir"), (Path, "read_bytes"), (Path, "read_text")])
@pytest.mark.parametrize("number", [errno.EIO, errno.EACCES, errno.EMFILE, errno.ENOMEM])
def test_what_cannot_be_read_is_neither_damaged_nor_made_again(tmp_path, fresh, monkeypatch, place, number):
    target = keep_folder(tmp_path / "x", fill)
    fresh()
    with monkeypatch.context() as broken:
        broken.setattr(*place, fails(number))
        with pytest.raises(DseError, match=rf"^{target}: the cache entry cannot be read: {os.strerror(number)}\n"):
            keep_folder(target, never)
        assert keep_content(tmp_path / "y", lambda: b"worked out") == b"worked out"
    assert keep_folder(target, never) == target


@pytest.mark.parametrize("place", ["write_file", "sync"])
def test_a_full_disk_is_named_and_leaves_no_half_entry(tmp_path, monkeypatch, place):
    target = keep_file(tmp_path / "x", lambda: CONTENT)
    for module in (entries, rooms):
        monkeypatch.setattr(module, place, fails(errno.ENOSPC))
    full = rf"^the cache folder {tmp_path} cannot be written: no space left on device\n +hint: make room, .*DSE_CACHE"
    with pytest.raises(DseError, match=full):
        keep_folder(tmp_path / "y", fill)
    assert keep_content(tmp_path / "z", lambda: b"worked out") == b"worked out"
    assert keep_file(target, never) == target
    monkeypatch.undo()
    assert [path.name for path in tmp_path.iterdir() if path.suffix == ".tmp"] == []
    assert listed(keep_folder(tmp_path / "y", fill))["second"] == CONTENT
