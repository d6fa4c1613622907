"""A study on a disk that gets full, in a name space of its own where small disks can be mounted."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CAN_MOUNT = (
    sys.platform == "linux"
    and shutil.which("unshare") is not None
    and subprocess.run(["unshare", "-rm", "mount", "-t", "tmpfs", "none", "/mnt"], check=False).returncode == 0
)

STUDY = """
import subprocess, sys
from pathlib import Path
from test_explore import content, run
from fake_runners import study_of
from dse.domain.study import Keep
from dse.errors import DseError
from dse.storage.folder import StudyFolder

disk, elsewhere, keep, first = Path(sys.argv[1]), Path(sys.argv[2]), Keep(sys.argv[3]), int(sys.argv[4])


def mount(*options):
    subprocess.run(["mount", "-t", "tmpfs", "-o", ",".join(options), "none", disk], check=True)


study = study_of(levels=24, keep=keep)
told, before = [], set()
size = first
subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", disk], check=True)
while True:
    try:
        run(disk / "study", study)
        break
    except DseError as error:
        told.append(str(error))
    size += size // 2
    subprocess.run(["mount", "-o", f"remount,size={size}k", disk], check=True)
    if (disk / "study" / "study.sqlite").exists():
        with StudyFolder.open(disk / "study") as folder:
            now = folder.finished()
            assert before <= now
            assert {attempt.run for attempt in folder.attempts()} >= now
            before = now
run(elsewhere, study)
assert content(disk / "study") == content(elsewhere)
assert len(told) > 2
for message in told:
    assert "the disk is full" in message or "No space left on device" in message, message
    assert "the same command resumes" in message, message
"""


READ_ONLY = """
import subprocess, sys
from pathlib import Path
from fake_runners import definition_of, study_of
from dse.errors import DseError
from dse.storage.folder import StudyFolder

disk = Path(sys.argv[1])
definition = definition_of(study_of(levels=2), ("a",))
subprocess.run(["mount", "-t", "tmpfs", "none", disk], check=True)
StudyFolder.resume(disk / "study", definition).close()
subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
with StudyFolder.open(disk / "study") as folder:
    assert folder.finished() == set()
for write in (lambda: StudyFolder.resume(disk / "study", definition), lambda: StudyFolder.discard(disk / "study")):
    try:
        write()
    except DseError as error:
        assert "the folder cannot be written to: the file system is read-only" in str(error), error
    else:
        raise SystemExit("was written to")
"""


def in_mounts(script: str, *arguments: object) -> None:
    """Carry out *script* where it may mount."""
    tests = Path(__file__).parent
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(tests), str(tests.parent)])}
    subprocess.run(["unshare", "-rm", sys.executable, "-c", script, *map(str, arguments)], check=True, env=environment)


@pytest.mark.skipif(not CAN_MOUNT, reason="disks cannot be mounted here")
def test_a_read_only_disk_is_named_and_can_be_read(tmp_path: Path) -> None:
    in_mounts(READ_ONLY, tmp_path)


@pytest.mark.thorough
@pytest.mark.skipif(not CAN_MOUNT, reason="disks cannot be mounted here")
@pytest.mark.parametrize(("keep", "room"), [("none", 40), ("all", 90)])
def test_a_full_disk_is_named_and_with_more_room_the_study_ends_as_if_there_had_been_enough(
    tmp_path: Path, keep: str, room: int
) -> None:
    (tmp_path / "disk").mkdir()
    in_mounts(STUDY, tmp_path / "disk", tmp_path / "elsewhere", keep, room)
