"""docs/world.md: whoever does what it says, from the first block to the last, has a world of their own."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse
from page import BLOCK, follow, text_of
from sumo_here import needs_sumo

TEXT = text_of("world")
(BY_SUMO,) = re.findall(r"^## Traffic by SUMO\n.*?(?=^## |\Z)", TEXT, re.DOTALL | re.MULTILINE)


@pytest.mark.thorough
def test_the_page_leads_from_an_empty_folder_to_a_world(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    page, cache = TEXT.replace(BY_SUMO, ""), built_before(tmp_path / "cache")
    here, printed = follow(page, tmp_path, cache)
    assert "out/figures/home.png" in "".join(printed.values())
    assert (here / "out" / "figures" / "home.png").read_bytes().startswith(b"\x89PNG")
    assert (here / "out" / "figures" / "home.svg").stat().st_size > 10_000
    assert (here / "home.xodr").read_text(encoding="utf-8").count("<junction ") == 5
    road, (mistake,) = here / "roads" / "home.yaml", [text for kind, text in BLOCK.findall(page) if kind == "text"]
    road.write_text(road.read_text(encoding="utf-8").replace("angle: 70 deg", "angle: 20 deg"), encoding="utf-8")
    refused = run_dse(here, "figure", "home", cache=cache)
    assert (refused.returncode, refused.stderr) == (1, mistake)


@pytest.mark.thorough
@needs_sumo
def test_the_same_for_traffic_by_sumo(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    cache = built_before(tmp_path / "cache")
    assert run_dse(tmp_path, "init", "world", cache=cache).returncode == 0
    _, printed = follow(BY_SUMO, tmp_path / "world", cache)
    assert "2 runs" in "".join(printed.values())
