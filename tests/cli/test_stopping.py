"""Ctrl-C, SIGTERM and SIGHUP at any moment: one line, no traceback, nothing left behind."""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import dse


def nightly(value: str) -> object:
    return pytest.param(value, marks=pytest.mark.nightly)


pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="interrupts are sent otherwise there")

SCRIPT = "import sys\nfrom dse.cli import main\nsys.exit(main())"
"""What the console script does."""

WORKS = """
import os, signal, sys, time
from dse.cli import signals
from dse.cli.app import app
from dse.cli.entry import run
from dse.scratch import ScratchFolder
signals.end_at_once()

@app.command("work")
def work():
    with ScratchFolder():
        try:
            {first}
            time.sleep(60)
        finally:
            {then}
            time.sleep(0.1)
            print("tidied up")

sys.argv = ["dse", "work"]
run()
"""

SIGNALS = {"SIGINT": 130, "SIGTERM": 143, "SIGHUP": 129}


def started(command, folder, temporary, **more):
    environment = {**os.environ, "TMPDIR": str(temporary), **more}
    return subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, start_new_session=True
    )


@pytest.mark.parametrize("name", SIGNALS)
def test_a_signal_ends_a_command_once_and_more_of_them_leave_it_to_tidy_up(tmp_path, name):
    send = f"os.kill(os.getpid(), signal.{name})"
    code = WORKS.format(first=send, then=send)
    process = started([sys.executable, "-c", code], tmp_path, tmp_path)
    said = process.communicate(timeout=120)
    assert (process.returncode, *said) == (SIGNALS[name], b"tidied up\n", b"stopped\n")
    assert list(tmp_path.iterdir()) == []


def test_an_interrupt_where_nothing_can_be_raised_is_not_lost(tmp_path):
    lost = "import weakref; t = set(); w = weakref.ref(t, lambda _: os.kill(os.getpid(), signal.SIGTERM)); del t"
    process = started([sys.executable, "-c", WORKS.format(first=lost, then="pass")], tmp_path, tmp_path)
    assert process.communicate(timeout=50)[1] == b"stopped\n"
    assert process.returncode == 143


def test_a_hang_up_is_ignored_where_it_was(tmp_path):
    code = WORKS.format(first="os.kill(os.getpid(), signal.SIGHUP); return", then="pass")
    command = ["nohup", sys.executable, "-c", code]
    process = started(command, tmp_path, tmp_path)
    said, _ = process.communicate(timeout=120)
    assert (process.returncode, said) == (0, b"tidied up\n")


@pytest.mark.thorough
@pytest.mark.parametrize("words", [*map(nightly, ["--help", "check"]), "explore small -o {out}"])
@pytest.mark.parametrize("name", ["SIGINT", nightly("SIGTERM")])
def test_a_command_is_stopped_at_any_moment_of_its_start(example, cache, tmp_path, words, name):
    delays = random.Random(words)  # noqa: S311  # no secret
    command = [sys.executable, "-c", SCRIPT, *words.format(out=tmp_path / "out").split()]
    (temporary := tmp_path / "temporary").mkdir()
    for _ in range(40):
        process = started(command, example, temporary, DSE_CACHE=str(cache))
        time.sleep(delays.uniform(0, 1.2))
        os.killpg(process.pid, getattr(signal, name))
        errors = process.communicate(timeout=120)[1].decode()
        # Before the first line of ours it is Python that is interrupted: no file of ours runs yet.
        assert f'File "{Path(dse.__file__).parent}' not in errors, errors
        assert process.returncode in (0, 1, SIGNALS[name], -getattr(signal, name)), errors
        assert list(temporary.iterdir()) == []


@pytest.mark.nightly
def test_a_study_is_stopped_at_any_moment_and_goes_on(example, cache, tmp_path):
    """With more signals while it tidies up, to the process or to all of its group."""
    shutil.rmtree(cache / "runs", ignore_errors=True)  # what other tests made would be taken
    delays = random.Random(5)  # noqa: S311  # no secret
    (temporary := tmp_path / "temporary").mkdir()
    command = [sys.executable, "-c", SCRIPT, "explore", "small", "-o", str(tmp_path / "out"), "-j", "2"]
    codes = set()
    for number in range(12):
        process = started(command, example, temporary, DSE_CACHE=str(cache))
        send, name = (os.kill, os.killpg)[number % 2], [*SIGNALS][number % 3]
        for delay in (delays.uniform(0.5, 5), *[delays.uniform(0, 0.2) for _ in range(number % 4)]):
            time.sleep(delay)
            if process.poll() is None:
                send(process.pid, getattr(signal, name))
        errors = process.communicate(timeout=120)[1].decode()
        assert "Traceback" not in errors
        assert process.returncode in (0, SIGNALS[name], -getattr(signal, name)), errors
        codes.add(process.returncode)
        assert list(temporary.iterdir()) == []
    assert codes - {0}
    done = started(command, example, temporary, DSE_CACHE=str(cache))
    assert done.communicate()[0].startswith(f"{tmp_path / 'out'}: ".encode())
    assert done.returncode == 0
