"""docs/aeb.md: its commands print what it shows."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from command_line import run_dse

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "aeb.md").read_text(encoding="utf-8")


@pytest.mark.thorough
def test_the_design_space_counts_as_the_page_says(tmp_path: Path) -> None:
    (block,) = re.findall(r"^```console\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)
    lines = block.splitlines()
    assert len(lines) == 4
    for command, shown in zip(lines[::2], lines[1::2], strict=True):
        result = run_dse(ROOT, *shlex.split(command.removeprefix("$ dse ")), cache=tmp_path)
        assert result.stdout.splitlines() == [shown]


def test_what_the_page_names_is_there() -> None:
    for name in re.findall(r"`(aeb_\w+)`", TEXT):
        found = [*ROOT.glob(f"*/{name}.yaml"), *ROOT.glob(f"*/{name}.pet.yaml"), *ROOT.glob(f"components/*/{name}")]
        assert found, name
    for picture in re.findall(r"\]\((images/\S+)\)", TEXT):
        assert (ROOT / "docs" / picture).exists()
