"""What an FMU may change for the whole process, what it prints, and what processes are started with and start."""

from __future__ import annotations

import locale
import os
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import psutil
import pytest
from fake_runners import FakeBench, definition_of, make_fake, study_of

from dse import processes
from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.exploration.supervision import worker_process as process
from dse.exploration.supervision.process_state import ProcessState
from dse.processes import descendants, forget_start, unburdened
from dse.storage.folder import StudyFolder

NESTED = "read line; sleep 60 & sh -c 'sleep 60 & echo; wait' & wait"


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "home"
    folder.mkdir()
    monkeypatch.chdir(folder)
    return folder


def test_the_working_folder_is_put_back(home: Path, tmp_path: Path) -> None:
    surroundings = ProcessState()
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    os.chdir(elsewhere)
    shutil.rmtree(elsewhere)  # so that the process is nowhere at all
    surroundings.restore()
    assert Path.cwd() == home


@pytest.mark.skipif(sys.platform == "win32", reason="C.UTF-8")
def test_the_locale_is_put_back(home: Path) -> None:
    before = locale.setlocale(locale.LC_ALL)
    surroundings = ProcessState()
    try:
        locale.setlocale(locale.LC_NUMERIC, "C.UTF-8")
        assert locale.setlocale(locale.LC_ALL) != before
        surroundings.restore()
        assert locale.setlocale(locale.LC_ALL) == before
    finally:
        locale.setlocale(locale.LC_ALL, before)


@pytest.mark.thorough
def test_what_a_single_run_prints_does_not_fill_the_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(process, "_LARGEST_LOG", 100_000)
    sizes: list[int] = []
    shorten = process.WorkerProcess.shorten_log

    def watched(worker: process.WorkerProcess) -> None:
        sizes.append(worker._log.stat().st_size)
        shorten(worker)
        sizes.append(worker._log.stat().st_size)

    monkeypatch.setattr(process.WorkerProcess, "shorten_log", watched)
    study = study_of(levels=1, variables=1)
    with StudyFolder.create(tmp_path, definition_of(study)) as folder:
        prepared = {"a": FakeBench("a", mischief="prints for a second", when=(0,))}
        explore(study, prepared, folder, executor=Local(workers=1), make_runner=make_fake)
    # It was cut at least once while the run went on, and it never came to hold all of the ten megabytes.
    assert any(before > 100_000 and after < before for before, after in zip(sizes[::2], sizes[1::2], strict=True))
    assert max(sizes) < 10_000_000


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
            known = psutil.Process(shell.pid).children(recursive=True)
            try:
                told.extend(({*descendants(shell.pid)}, {process.pid for process in known}))
                told.append({*descendants(os.getpid())})
            finally:
                for process in known:
                    process.kill()

    told: list[set[int]] = []
    thread = threading.Thread(target=start)  # a child belongs to the thread that started it
    thread.start()
    thread.join()
    found, known, mine = told
    assert found == known
    assert len(found) == 3
    assert found < mine


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
