"""docs/questions.md: its commands print what it shows, and its code runs."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import run_dse

from dse.cli import entry

TEXT = (Path(__file__).parents[2] / "docs" / "questions.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    assert run_dse(tmp_path, "init", "study", cache=tmp_path).returncode == 0
    monkeypatch.chdir(tmp_path / "study")
    monkeypatch.setenv("COLUMNS", "100")


@pytest.mark.thorough
def test_every_command_prints_what_is_shown(workspace, monkeypatch, capsys):
    shown = [text.partition("\n") for kind, text in BLOCK.findall(TEXT) if kind == "console"]
    assert len(shown) >= 10
    for command, _, output in shown:
        monkeypatch.setattr("sys.argv", shlex.split(command.removeprefix("$ ")))
        with pytest.raises(SystemExit) as end:
            entry.run()
        assert not end.value.code, command
        printed = [line.rstrip() for line in capsys.readouterr().out.replace("\\", "/").splitlines()]
        assert printed == output.splitlines(), command


@pytest.mark.thorough
def test_the_python_shown_runs(workspace):
    code = "\n".join(text for kind, text in BLOCK.findall(TEXT) if kind == "python")
    subprocess.run([sys.executable, "-c", code], check=True)


def test_every_question_has_its_command_and_its_call():
    folder = Path(__file__).parents[2] / "dse" / "cli" / "commands"
    for path in folder.glob("space_*.py"):
        for command in re.findall(r'space_app\.command\("(\w+)"\)', path.read_text(encoding="utf-8")):
            assert command == "graph" or f"$ dse space {command} " in TEXT
