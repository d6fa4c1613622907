"""A page of the documentation, followed as a reader does: its files are written, its commands carried out in turn."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from pathlib import Path

from command_line import run_dse

BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"(?:# |/\* )([\w./]+?)(?: \*/)?\n")
"""The first line of a block that is a file."""


def text_of(name: str) -> str:
    """The page docs/NAME.md."""
    return (Path(__file__).parents[1] / "docs" / f"{name}.md").read_text(encoding="utf-8")


def follow(page: str, here: Path, cache: Path) -> tuple[Path, dict[str, str]]:
    """Do what *page* says, from the folder *here* on: where that leads to, and what each command line prints.

    Code in Python prints as ``python``. Blocks of the kind ``text`` are passed over.
    """
    printed: dict[str, str] = {}
    for kind, text in BLOCK.findall(page):
        if kind == "python":
            code = [sys.executable, "-c", text]
            printed[kind] = subprocess.run(code, cwd=here, check=True, capture_output=True, text=True).stdout
        elif kind == "sh":
            for line in text.splitlines():
                here, printed[line] = _carried_out(line, here, cache)
        elif kind != "text":
            named = FILE.match(text)
            assert named, text
            target = here / named[1]
            target.parent.mkdir(exist_ok=True, parents=True)
            target.write_text(text, encoding="utf-8")
    return here, printed


def _carried_out(line: str, here: Path, cache: Path) -> tuple[Path, str]:
    command, *arguments = shlex.split(line, comments=True)
    if command in ("cd", "mkdir"):
        there = here / arguments[0]
        there.mkdir(exist_ok=True)
        return there if command == "cd" else here, ""
    assert command == "dse"
    result = run_dse(here, *arguments, cache=cache)
    assert result.returncode == 0, (line, result.stdout, result.stderr)
    return here, result.stdout
