"""docs/serve.md: its commands do what it says."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import urllib.request
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse

from dse.report.page.pdf import BROWSERS

TEXT = (Path(__file__).parents[2] / "docs" / "serve.md").read_text(encoding="utf-8")
COMMANDS = [
    shlex.split(line, comments=True)[1:]
    for block in re.findall(r"^```sh\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)
    for line in block.splitlines()
]


def test_there_are_commands_of_each_kind() -> None:
    assert {command[0] for command in COMMANDS} == {"serve", "explore", "compare", "report"}


@pytest.mark.thorough
def test_every_command_runs(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    cache = built_before(tmp_path / "cache")
    assert run_dse(tmp_path, "init", "work", cache=cache).returncode == 0
    work = tmp_path / "work"
    # Studies come before servers of them.
    for command in sorted(COMMANDS, key=lambda command: command[0] != "explore"):
        if command[0] == "serve":
            look_at_served(work, command)
        elif "--pdf" in command and not any(map(shutil.which, BROWSERS)):
            assert "CI" not in os.environ, "printing is tested with a Chromium"
        else:
            done = run_dse(work, *command, cache=cache)
            assert done.returncode == 0, (command, done.stderr)
    assert (work / "gains.pdf").is_file() or "CI" not in os.environ


def look_at_served(work: Path, command: list[str]) -> None:
    """The server prints an address at which there are the studies; its port is any free one."""
    words = [word for word in command if not word.isdigit() and word != "--port"]
    with subprocess.Popen(
        [sys.executable, "-m", "dse", *words, "--port", "0"], cwd=work, stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None
            address = process.stdout.readline().strip()
            local = re.sub(r"//[^:/]*:", "//127.0.0.1:", address)
            with urllib.request.urlopen(local, timeout=60) as answer:  # noqa: S310  # what it has printed
                assert answer.status == 200
        finally:
            process.kill()


def test_limits_are_those_of_the_program() -> None:
    from dse.serving import PORT, Limits
    from dse.serving.open_studies import _FEW, _MANY
    from dse.serving.study_index import DEPTH

    assert f"http://127.0.0.1:{PORT}/" in TEXT
    assert f"in size ({Limits().body // 1024} kB)" in TEXT
    assert f"more than {_MANY:,} runs it has the waveforms of {_FEW}," in TEXT
    assert DEPTH == 4
    assert "four levels deep" in TEXT
