"""Standard streams that are closed, full or left by their reader, and errors nobody foresaw: one message at most."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/dev/full and a shell are needed")

DSE = f"{sys.executable} -m dse"
NO_ROOM = "standard output cannot be written: No space left on device\n"


@pytest.fixture
def shell(example, cache):
    def shell(line, **more):
        environment = {**os.environ, "DSE_CACHE": str(cache), **more}
        done = subprocess.run(
            ["bash", "-c", f"set -o pipefail; {line}"], cwd=example, env=environment, capture_output=True, check=False
        )
        return done.returncode, done.stdout.decode(), done.stderr.decode()

    return shell


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("line", "code", "output", "errors"),
    [
        ("{dse} docs > /dev/full", 1, "", NO_ROOM),
        ("{dse} components > /dev/full", 1, "", NO_ROOM),
        ("{dse} --help > /dev/full", 1, "", NO_ROOM),
        ("{dse} enumerate nothing 2> /dev/full", 1, "", ""),
        ("{dse} enumerate 2> /dev/full", 2, "", ""),
        ("{dse} docs formats | head -c 9", 0, "# The fil", ""),
        ("{dse} docs formats 2>&1 | head -c 9", 0, "# The fil", ""),
        ("{dse} enumerate acc_vehicle --count <&- 2>&-", 0, "acc_vehicle: ", ""),
        ("{dse} docs <&- >&- 2>&-", 0, "", ""),
        ("{dse} docs no_page <&- >&-", 1, "", "there is no page 'no_page'\n"),
        ("{dse} export uvl acc_vehicle -o /dev/full", 1, "", "cannot write /dev/full: No space left on device\n"),
    ],
)
def test_streams_are_what_they_are(shell, line, code, output, errors):
    got, out, err = shell(line.format(dse=DSE))
    assert (got, err.partition("    hint")[0], out[: len(output)]) == (code, errors, output)
    assert "Traceback" not in err


def test_a_file_is_not_opened_in_the_place_of_a_closed_stream(example):
    look = "import os; from dse.cli.streams import mend_streams; mend_streams(); print(os.open('designs', os.O_RDONLY))"
    done = subprocess.run(
        ["bash", "-c", f'{sys.executable} -c "{look}" <&- 2>&-'], cwd=example, capture_output=True, check=True
    )
    assert int(done.stdout) > 2


FAILS = """
import sys
from dse.cli.app import app
from dse.cli.entry import run
@app.command("fail")
def fail(): {}
sys.argv = ["dse", "fail"]
run()
"""


def test_an_error_nobody_foresaw_is_one_message_and_its_story_a_file(tmp_path):
    environment = {**os.environ, "DSE_CACHE": str(tmp_path)}
    command = [sys.executable, "-c", FAILS.format("return {}['wrong']")]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    what, hint = done.stderr.splitlines()
    assert what == "KeyError: 'wrong' (<string>:6): this is a mistake in dse"
    assert hint == f"    hint: please report it with the content of {tmp_path / 'mistake.txt'}"
    story = (tmp_path / "mistake.txt").read_text(encoding="utf-8")
    assert "Traceback (most recent call last)" in story
    assert "['dse', 'fail']" in story


@pytest.mark.parametrize(
    ("raised", "said"),
    [
        ("MemoryError()", "there is not enough memory"),
        ("OSError(24, 'Too many open files', '/x')", "/x: Too many open files"),
        ("PermissionError(13, 'Permission denied', b'/x\\xff')", "/x\N{REPLACEMENT CHARACTER}: Permission denied"),
    ],
)
def test_what_the_system_refuses_is_said_as_it_is(tmp_path, raised, said):
    command = [sys.executable, "-c", FAILS.format(f"raise {raised}")]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr.splitlines()[0]) == (1, said)


@pytest.mark.thorough
def test_a_working_folder_that_was_deleted_is_named(tmp_path, cache):
    folder = tmp_path / "gone"
    folder.mkdir()
    command = f"cd {folder}; rmdir {folder}; {DSE} check"
    environment = {**os.environ, "DSE_CACHE": str(cache)}
    done = subprocess.run(["bash", "-c", command], env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert done.stderr.startswith(f"{folder}: the current folder was deleted\n")
