"""The sandbox with each version of Landlock, and where there is none; its numbers are those of the kernel."""

from __future__ import annotations

import json
import multiprocessing
import re
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from sandbox_tries import OWN, has_sandbox, try_all

from dse import sandbox
from dse.errors import DseError
from dse.sandbox import REFUSED, Sandbox

needs_sandbox = pytest.mark.skipif(not has_sandbox(), reason="this machine has no sandbox")


def tried(folder: Path) -> list[str]:
    """What a process in a sandbox can do."""
    own, home = folder / "own", folder / "home"
    home.mkdir()
    (home / "kept").write_text("precious")
    process = multiprocessing.get_context("spawn").Process(target=_confined, args=(Sandbox((own,)), own, home))
    Sandbox((own,)).start(process)
    process.join()
    assert (home / "kept").read_text() == "precious"
    assert [path.name for path in home.iterdir()] == ["kept"]
    done: list[str] = json.loads((own / "said").read_text())
    return done


def _confined(own: Sandbox, *places: Path) -> None:
    own.move_in()
    try_all(*places)


@needs_sandbox
@pytest.mark.parametrize("version", [1, *(pytest.param(n, marks=pytest.mark.thorough) for n in (2, 3, 5)), 99])
def test_each_version_of_landlock_keeps_a_process_to_its_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, version: int
) -> None:
    here = sandbox.abi()
    monkeypatch.setattr("dse.sandbox.abi", lambda: min(version, here))
    assert tried(tmp_path) == OWN


@pytest.mark.parametrize(
    ("where", "value", "told"),
    [
        ("sys.platform", "win32", "no sandbox: there is none on"),
        ("platform.machine", lambda: "riscv64", "no sandbox: there is none for processors called riscv64"),
    ],
)
def test_a_machine_without_one_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, where: str, value: object, told: str
) -> None:
    monkeypatch.setattr(f"dse.sandbox.{where}", value)
    with pytest.raises(DseError, match=told):
        sandbox.enforced()
    with pytest.raises(DseError, match=told):
        Sandbox((tmp_path,)).start(multiprocessing.get_context("spawn").Process())


@needs_sandbox
def test_a_kernel_without_landlock_is_told_from_one_with_it(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "Landlock ABI" in sandbox.enforced()
    monkeypatch.setattr("dse.sandbox._CREATE_RULESET", 1 << 20)  # a system call that no kernel has
    with pytest.raises(DseError, match="this kernel has no Landlock"):
        sandbox.enforced()


@needs_sandbox
def test_a_link_in_place_of_a_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "own").symlink_to(tmp_path / "home")
    with pytest.raises(DseError, match="is a link"):
        Sandbox((tmp_path / "own",)).start(multiprocessing.get_context("spawn").Process())


@pytest.mark.thorough
@pytest.mark.parametrize(("machine", "column"), [("x86_64", 1), ("aarch64", 2)])
def test_the_numbers_of_system_calls_are_those_of_the_kernel(machine: str, column: int) -> None:
    compiler = [sys.executable, "-m", "ziglang", "cc", "-target", f"{machine}-linux-gnu"]
    asked = subprocess.run(
        [*compiler, "-E", "-dM", "-x", "c", "-"],
        input="#include <asm/unistd.h>\n",
        capture_output=True,
        text=True,
        check=True,
    )
    defined = dict(re.findall(r"#define __NR(?:3264)?_(\w+) (\d+)", asked.stdout))
    entries = [entry.split() for entry in REFUSED.replace("\n", " ").split(",")]
    known = {entry[0]: entry[column] for entry in entries if entry[0] in defined}
    assert known == {name: defined[name] for name in known}
    assert len(known) > 80 if machine == "x86_64" else len(known) > 70
    absent = {entry[0] for entry in entries if entry[column] == "-"}
    assert not absent & defined.keys()


_ALLOWED = """
import os, resource, signal, subprocess, sys
soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
resource.setrlimit(resource.RLIMIT_NOFILE, (hard - 2, hard))
resource.setrlimit(resource.RLIMIT_FSIZE, (resource.getrlimit(resource.RLIMIT_FSIZE)[1],) * 2)
from dse.sandbox import protect_parent
protect_parent()
resource.setrlimit(resource.RLIMIT_NOFILE, (hard - 1, hard))
resource.setrlimit(resource.RLIMIT_FSIZE, (0, 0))
child = subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE)
child.terminate()
os.kill(os.getppid(), 0)
os.kill(os.getpid(), signal.SIGCONT)
resource.prlimit(os.getppid(), resource.RLIMIT_NOFILE)
limits = [resource.getrlimit(kind)[0] for kind in (resource.RLIMIT_NOFILE, resource.RLIMIT_FSIZE)]
print(child.wait(), limits[0] - hard, limits[1] == 0, flush=True)
"""


@pytest.mark.skipif(sys.platform != "linux", reason="seccomp")
@pytest.mark.parametrize(
    "harm",
    [
        "os.kill(os.getppid(), signal.SIGCONT)",
        "os.kill(0, signal.SIGCONT)",
        "os.killpg(os.getpgrp(), signal.SIGCONT)",
        "",
        "resource.prlimit(os.getppid(), resource.RLIMIT_NOFILE, (soft, hard))",
    ],
)
def test_a_process_that_reaches_for_its_parent_is_ended_and_may_do_all_else(harm: str) -> None:
    script = f"{_ALLOWED}\n{harm}\nprint('went on')"
    process = subprocess.run([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, check=False)
    goes_on = not harm
    assert process.stdout.splitlines() == [f"{-signal.SIGTERM} -1 False", *["went on"] * goes_on]
    assert process.returncode == (0 if goes_on else -signal.SIGSYS)
