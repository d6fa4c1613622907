"""docs/world.md: whoever does what it says, from the first block to the last, has a world of their own."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

from command_line import run_dse

TEXT = (Path(__file__).parents[2] / "docs" / "world.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"(?:# |/\* )([\w./]+?)(?: \*/)?\n")


def test_the_page_leads_from_an_empty_folder_to_a_world(tmp_path: Path) -> None:
    here, said = tmp_path, ""
    for kind, text in BLOCK.findall(TEXT):
        if kind == "text":  # a mistake in the file before, and what is said of it
            road = here / "roads" / "home.yaml"
            right = road.read_text(encoding="utf-8")
            road.write_text(right.replace("angle: 70 deg", "angle: 20 deg"), encoding="utf-8")
            told = run_dse(here, "figure", "home", cache=tmp_path / "cache")
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
                result = run_dse(here, *arguments, cache=tmp_path / "cache")
                assert result.returncode == 0, (line, result.stdout, result.stderr)
                said += result.stdout
        else:
            named = FILE.match(text)
            assert named, text
            target = here / named[1]
            target.parent.mkdir(exist_ok=True, parents=True)
            target.write_text(text, encoding="utf-8")
    assert "out/figures/home.png" in said
    assert (here / "out" / "figures" / "home.png").read_bytes().startswith(b"\x89PNG")
    assert (here / "out" / "figures" / "home.svg").stat().st_size > 10_000
    assert (here / "home.xodr").read_text(encoding="utf-8").count("<junction ") == 5
