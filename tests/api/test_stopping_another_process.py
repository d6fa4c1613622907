"""Stopping another process that explores a study."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from served_studies import store_study

from dse.api import stop
from dse.errors import DseError
from dse.scratch import start_of
from dse.storage import WriterLock, this_process

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="there it is refused")

HOLDS = """
import sys, time
from pathlib import Path
from dse.storage import WriterLock
try:
    with WriterLock(Path(sys.argv[1])):
        print("held", flush=True)
        time.sleep(300)
except KeyboardInterrupt:
    print("interrupted")
"""

SLEEPS = "import time; print('here', flush=True); time.sleep(300)"


@pytest.fixture
def study(tmp_path: Path) -> Path:
    return store_study(tmp_path / "study", [0.5])


def started(code: str, *arguments: str) -> subprocess.Popen[str]:
    process = subprocess.Popen([sys.executable, "-c", code, *arguments], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    assert process.stdout.readline()
    return process


@pytest.fixture
def holder(study: Path) -> Iterator[subprocess.Popen[str]]:
    with started(HOLDS, str(study)) as process:
        yield process
        process.kill()


def note(study: Path, process: int, host: str = "") -> None:
    """What stands beside the lock says that *process* writes."""
    here = this_process().rpartition("/")[0]
    told = {"host": host or here, "process": process, "started": start_of(process)}
    (study / "writer.json").write_text(json.dumps(told), encoding="utf-8")


def test_who_writes_is_interrupted_as_by_ctrl_c(study: Path, holder: subprocess.Popen[str]) -> None:
    assert stop(study).process == holder.pid
    assert holder.communicate(timeout=60)[0] == "interrupted\n"


BACKGROUND = """
import signal
signal.signal(signal.SIGINT, signal.SIG_IGN)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells what a process hears")
def test_what_runs_in_the_background_of_a_shell_is_stopped_as_it_can_be(study: Path) -> None:
    handles = "signal.signal(signal.SIGTERM, signal.default_int_handler)\n"
    with started(BACKGROUND + handles + HOLDS, str(study)) as process:
        assert stop(study).process == process.pid
        assert process.communicate(timeout=60)[0] == "interrupted\n"


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells what a process hears")
def test_what_would_not_tidy_up_is_not_ended(study: Path) -> None:
    with started(BACKGROUND + HOLDS, str(study)) as process:
        with pytest.raises(DseError, match="it ignores interrupts"):
            stop(study)
        assert process.poll() is None
        process.kill()


def test_where_nobody_writes_nobody_is_stopped(study: Path) -> None:
    with pytest.raises(DseError, match="no process explores this study"):
        stop(study)


def test_a_process_that_only_a_note_names_is_left_alone(study: Path) -> None:
    with WriterLock(study), started(SLEEPS) as bystander:
        note(study, bystander.pid)
        with pytest.raises(DseError, match=rf"process {bystander.pid} .* cannot be stopped .* does not hold"):
            stop(study)
        assert bystander.poll() is None
        bystander.kill()


def test_another_machine_s_process_is_refused_by_name(study: Path, holder: subprocess.Popen[str]) -> None:
    note(study, holder.pid, host="elsewhere")
    with pytest.raises(DseError, match=r"on elsewhere cannot be stopped from here: it is on another machine"):
        stop(study)
    assert holder.poll() is None


def test_another_user_s_process_is_refused_by_name(
    study: Path, holder: subprocess.Popen[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.getuid", lambda: 123456)
    with pytest.raises(DseError, match="it belongs to another user"):
        stop(study)
    assert holder.poll() is None


def test_the_program_does_not_stop_itself(study: Path) -> None:
    with WriterLock(study), pytest.raises(DseError, match="it is this program itself"):
        stop(study)
