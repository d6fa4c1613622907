"""What processes of ours start, and how it is found."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import psutil
import pytest

from dse import processes
from dse.processes import descendants, forget_start, unburdened

NESTED = "read line; sleep 60 & sh -c 'sleep 60 & echo; wait' & wait"


@pytest.mark.skipif(sys.platform == "win32", reason="the shell of POSIX")
@pytest.mark.parametrize("is_listed", [True, False])
def test_all_that_a_process_has_started_is_found(monkeypatch: pytest.MonkeyPatch, is_listed: bool) -> None:
    if not is_listed:
        monkeypatch.setattr(processes, "Path", lambda _: Path("nowhere"))

    def start() -> None:
        with subprocess.Popen(["sh", "-c", NESTED], stdin=subprocess.PIPE, stdout=subprocess.PIPE) as shell:
            assert shell.stdin
            assert shell.stdout
            assert descendants(shell.pid) == []
            shell.stdin.write(b"\n")
            shell.stdin.flush()
            shell.stdout.readline()
            try:
                found = [psutil.Process(pid) for pid in descendants(shell.pid)]
                names = sorted(process.name() for process in found)
                mine = descendants(psutil.Process().pid)
            finally:
                for process in psutil.Process(shell.pid).children(recursive=True):
                    process.kill()
        told.append((names, {shell.pid, *(process.pid for process in found)} <= {*mine}))

    told: list[tuple[list[str], bool]] = []
    thread = threading.Thread(target=start)  # a child belongs to the thread that started it
    thread.start()
    thread.join()
    assert told == [(["sh", "sleep", "sleep"], True)]


def test_a_process_is_started_without_threads_for_linear_algebra_and_forgets_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delenv("OPENBLAS_NUM_THREADS", raising=False)
    monkeypatch.setenv("PYTHONSAFEPATH", "yes")
    before = dict(os.environ)
    with unburdened():
        assert (os.environ["OPENBLAS_NUM_THREADS"], os.environ["PYTHONSAFEPATH"]) == ("1", "yes")
    assert dict(os.environ) == before
    with unburdened():
        forget_start()
        assert dict(os.environ) == before
    monkeypatch.setenv("OPENBLAS_NUM_THREADS", "4")
    with unburdened():
        assert os.environ["OPENBLAS_NUM_THREADS"] == "4"
        forget_start()
        assert os.environ["OPENBLAS_NUM_THREADS"] == "4"
