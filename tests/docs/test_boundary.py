"""docs/boundary.md: its commands and its code run, and the search ends before a grid would."""

from __future__ import annotations

import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse

TEXT = (Path(__file__).parents[2] / "docs" / "boundary.md").read_text(encoding="utf-8")
BLOCK = re.compile(r"^```(sh|yaml|python)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


@pytest.mark.thorough
def test_the_page_leads_from_a_study_to_its_band(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    here, cache, said = tmp_path, built_before(tmp_path / "cache"), {}
    for kind, text in BLOCK.findall(TEXT):
        if kind == "yaml":
            (here / text.splitlines()[0].removeprefix("# ")).write_text(text, encoding="utf-8")
            continue
        if kind == "python":
            said[kind] = subprocess.run(
                [sys.executable, "-c", text], cwd=here, check=True, capture_output=True, text=True
            ).stdout
            continue
        for line in text.splitlines():
            command, *arguments = shlex.split(line, comments=True)
            if command == "cd":
                here = here / arguments[0]
                continue
            done = run_dse(here, *arguments, cache=cache)
            assert done.returncode == 0, (line, done.stdout, done.stderr)
            said[line] = done.stdout
    runs = re.search(r"(\d+) runs", said["dse explore speed"])
    assert runs
    assert 32 <= int(runs[1]) <= 80
    assert (here / "out/speed/figures/boundary_R1_0.png").exists()
    assert "boundary: {samples:" in (here / "testbenches" / "closer.pet.yaml").read_text(encoding="utf-8")
    assert said["python"].count("[") == 4
