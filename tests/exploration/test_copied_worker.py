"""A run outside of a study is made in a copy of the command's process, which guards it as any other worker."""

from __future__ import annotations

import subprocess
import sys
import threading
from pathlib import Path

import pytest

from dse import processes

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes are copied on Linux alone")

SCRIPT = """
import os, sys, threading
sys.path[:0] = {path!r}
from multiprocessing import util
from dse.domain.run import Outcome, Run
from fake_runners import METRICS, REQUIREMENTS, benches, make_fake
from dse.exploration.supervision.single_run import simulate_alone
from dse.processes import mark_command
from dse.storage import Measures

mischief, copied = sys.argv[1], sys.argv[2] == "copied"
held = os.open(sys.executable, os.O_RDONLY)


class Looking:
    runs_left = None

    def run(self, request, *, keep):
        there = os.path.exists(f"/proc/self/fd/{{held}}") and os.readlink(f"/proc/self/fd/{{held}}")
        return Run(request, Outcome.FAILED, problem=f"{{held}} is {{there}}")

    def close(self):
        pass


def make(bench, progress):
    return Looking() if mischief == "looks" else make_fake(bench, progress)


if copied:
    mark_command()
    util.spawnv_passfds = None  # no interpreter can be started
prepared = benches("a", mischief=mischief.replace("looks", ""), when=(0,), timeout=1)["a"]
run = simulate_alone(prepared, make if copied else make_fake, "a", Measures(METRICS, REQUIREMENTS))
print(run.outcome, run.problem, run.metrics, run.waveforms and [*run.waveforms.values])
"""


def told(mischief: str, way: str) -> str:
    script = SCRIPT.format(path=[str(Path(__file__).parent), str(Path(__file__).parents[1])])
    done = subprocess.run([sys.executable, "-c", script, mischief, way], capture_output=True, text=True, check=True)
    return done.stdout + done.stderr


@pytest.mark.thorough
@pytest.mark.parametrize("mischief", ["", "crashes", "exits", "prints and exits", "hangs", "dies loading", "refuses"])
def test_a_copy_is_guarded_as_a_new_process(mischief: str) -> None:
    copied = told(mischief, "copied")
    assert copied == told(mischief, "spawned")
    assert ("done" in copied) == (not mischief)


@pytest.mark.thorough
def test_a_copy_does_not_hold_what_the_command_has_open() -> None:
    found = told("looks", "copied")
    assert " is " in found
    assert Path(sys.executable).resolve().name not in found


def test_only_a_command_without_threads_is_copied(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threading, "enumerate", lambda: [threading.main_thread()])
    monkeypatch.setattr(processes, "_runs_command", False)
    monkeypatch.setattr(processes, "_OPENMP", ())  # other tests may have loaded it
    assert not processes.can_be_copied()
    processes.mark_command()
    assert processes.can_be_copied()
    others = [threading.main_thread(), threading.Timer(1.0, print)]
    monkeypatch.setattr(threading, "enumerate", lambda: others)
    assert processes.can_be_copied()
    others.append(threading.Thread())
    assert not processes.can_be_copied()
    others.pop()
    monkeypatch.setattr(processes, "_OPENMP", (b"libc",))
    assert not processes.can_be_copied()
