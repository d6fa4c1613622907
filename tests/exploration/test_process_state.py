"""What an FMU may change for the whole process, and what it prints."""

from __future__ import annotations

import locale
import os
import shutil
import sys
from pathlib import Path

import pytest
from fake_runners import FakeBench, definition_of, make_fake, study_of

from dse.exploration.executors.local import Local
from dse.exploration.loop import explore
from dse.exploration.supervision import worker_process as process
from dse.exploration.supervision.process_state import ProcessState
from dse.storage.folder import StudyFolder


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
