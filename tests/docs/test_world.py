"""docs/world.md: whoever does what it says, from the first block to the last, has a world of their own."""

from __future__ import annotations

import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse
from sumo_here import needs_sumo

TEXT = (Path(__file__).parents[2] / "docs" / "world.md").read_text(encoding="utf-8")
(BY_SUMO,) = re.findall(r"^## Traffic by SUMO\n.*?(?=^## |\Z)", TEXT, re.DOTALL | re.MULTILINE)
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"(?:# |/\* )([\w./]+?)(?: \*/)?\n")


@pytest.mark.thorough
def test_the_page_leads_from_an_empty_folder_to_a_world(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    here, said = followed(TEXT.replace(BY_SUMO, ""), tmp_path, built_before(tmp_path / "cache"))
    assert "out/figures/home.png" in said
    assert (here / "out" / "figures" / "home.png").read_bytes().startswith(b"\x89PNG")
    assert (here / "out" / "figures" / "home.svg").stat().st_size > 10_000
    assert (here / "home.xodr").read_text(encoding="utf-8").count("<junction ") == 5


@pytest.mark.thorough
@needs_sumo
def test_the_same_for_traffic_by_sumo(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    cache = built_before(tmp_path / "cache")
    assert run_dse(tmp_path, "init", "world", cache=cache).returncode == 0
    _, said = followed(BY_SUMO, tmp_path / "world", cache)
    assert "2 runs" in said


def followed(page: str, here: Path, cache: Path) -> tuple[Path, str]:
    """Do what *page* says, from the folder *here* on: where that leads to, and what the commands say."""
    said = ""
    for kind, text in BLOCK.findall(page):
        if kind == "text":  # a mistake in the file before, and what is said of it
            road = here / "roads" / "home.yaml"
            right = road.read_text(encoding="utf-8")
            road.write_text(right.replace("angle: 70 deg", "angle: 20 deg"), encoding="utf-8")
            told = run_dse(here, "figure", "home", cache=cache)
            assert (told.returncode, told.stderr) == (1, text)
            road.write_text(right, encoding="utf-8")
        elif kind == "sh":
            for line in text.splitlines():
                command, *arguments = shlex.split(line, comments=True)
                if command in ("cd", "mkdir"):
                    here = here / arguments[0] if command == "cd" else here
                    (here if command == "cd" else here / arguments[0]).mkdir(exist_ok=True)
                    continue
                assert command == "dse"
                result = run_dse(here, *arguments, cache=cache)
                assert result.returncode == 0, (line, result.stdout, result.stderr)
                said += result.stdout
        else:
            named = FILE.match(text)
            assert named, text
            target = here / named[1]
            target.parent.mkdir(exist_ok=True, parents=True)
            target.write_text(text, encoding="utf-8")
    return here, said
