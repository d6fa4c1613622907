"""Temporary folders go with what made them, even if that was killed; nobody else's do."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

from dse.errors import DseError
from dse.scratch import ScratchFolder, _sweep

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="what is open there cannot be removed anyway")

MAKES = "import sys; from dse.scratch import ScratchFolder; f = ScratchFolder(); print(f.name, flush=True); {}"


@pytest.fixture
def temporary(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    _sweep.cache_clear()
    yield tmp_path
    _sweep.cache_clear()


def made_by(temporary, then):
    command = [sys.executable, "-c", MAKES.format(then)]
    process = subprocess.Popen(
        command, env={**os.environ, "TMPDIR": str(temporary)}, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )
    folder = Path(process.stdout.readline().strip())
    (folder / "file").write_text("content")
    return process, folder


def test_what_a_dead_process_left_goes_and_what_a_living_one_has_stays(temporary):
    living, its = made_by(temporary, "sys.stdin.read()")
    killed, left = made_by(temporary, "sys.stdin.read()")
    killed.kill()
    killed.communicate()
    assert left.parent == temporary
    assert left.is_dir()
    with ScratchFolder() as folder:
        assert not left.exists()
        assert its.is_dir()
    assert not Path(folder).exists()
    living.communicate()
    assert not its.exists()


def test_the_process_that_has_the_number_now_is_told_from_the_one_that_had_it(temporary):
    with ScratchFolder() as folder:
        place, process, start = Path(folder).name.split("-")[1:4]
        earlier = temporary / f"dse-{place}-{process}-{int(start) - 1}-abc"
        elsewhere = temporary / f"dse-{int(place, 16) ^ 1:08x}-{process}-{int(start) - 1}-abc"
        for other in (earlier, elsewhere):
            other.mkdir()
    _sweep.cache_clear()
    with ScratchFolder():
        assert [*temporary.glob("*-abc")] == [elsewhere]


def test_what_only_looks_like_ours_stays(temporary):
    with ScratchFolder() as folder:
        left = Path(folder).name.replace(f"-{os.getpid()}-", "-999999999-")
    target = temporary / "kept"
    target.mkdir()
    (temporary / left).symlink_to(target)
    (temporary / f"{left}x").write_text("a file")
    (temporary / "dse-studies").mkdir()
    _sweep.cache_clear()
    with ScratchFolder():
        assert {path.name for path in temporary.iterdir()} >= {"kept", left, f"{left}x", "dse-studies"}


@pytest.mark.skipif(not hasattr(os, "geteuid") or os.geteuid() != 0, reason="only root can give folders away")
def test_what_another_user_left_stays(temporary):
    with ScratchFolder() as folder:
        left = temporary / Path(folder).name.replace(f"-{os.getpid()}-", "-999999999-")
    left.mkdir()
    os.chown(left, 65534, 65534)
    _sweep.cache_clear()
    with ScratchFolder():
        assert left.is_dir()


def test_without_room_for_one_there_is_one_message(monkeypatch):
    def refuse(*_arguments, **_options):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(tempfile, "mkdtemp", refuse)
    with pytest.raises(DseError, match="no temporary folder can be made: No space left on device"):
        ScratchFolder()
