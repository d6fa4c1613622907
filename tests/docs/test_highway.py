"""docs/highway.md: its commands work, and its counts are those of the design space."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from command_line import run_dse

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "highway.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
COMMANDS = [line for kind, text in BLOCK.findall(TEXT) if kind == "sh" for line in text.splitlines()]


def carried_out(folder: Path, commands: list[str]) -> list[str]:
    """What they print, each the text after its ``#`` if it has one."""
    here, said = folder, []
    for line in commands:
        command, *arguments = shlex.split(line, comments=True)
        if command == "cd":
            here = here / arguments[0]
            continue
        assert command == "dse"
        result = run_dse(here, *arguments, cache=folder / "cache")
        assert result.returncode == 0, (line, result.stdout, result.stderr)
        if "#" in line:
            assert line.partition("# ")[2] in result.stdout
        said.append(result.stdout)
    return said


@pytest.mark.thorough
def test_the_space_has_the_configurations_that_the_page_tells(tmp_path: Path) -> None:
    light = [line for line in COMMANDS if line.startswith(("dse init", "cd", "dse enumerate"))]
    assert len(light) >= 4
    carried_out(tmp_path, light)


@pytest.mark.thorough
def test_the_page_leads_from_an_empty_folder_to_a_report(tmp_path: Path) -> None:
    carried_out(tmp_path, COMMANDS)
    assert (tmp_path / "highway" / "out" / "highway_architectures" / "report.html").stat().st_size > 100_000


def test_its_pictures_are_there() -> None:
    names = re.findall(r"!\[[^]]*\]\((images/[^)]+)\)", TEXT)
    assert names
    assert all((ROOT / "docs" / name).stat().st_size < 200_000 for name in names)
