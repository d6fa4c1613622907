"""docs/tutorial.md, boundary.md and highway.md: who does all they say, block by block, has a study and its report."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from page import BLOCK, FILE, follow, text_of

TUTORIAL, HIGHWAY = text_of("tutorial"), text_of("highway")


@pytest.mark.thorough
def test_the_tutorial_leads_from_an_empty_folder_to_a_report(
    tmp_path: Path, built_before: Callable[[Path], Path]
) -> None:
    here, said = follow(TUTORIAL, tmp_path, built_before(tmp_path / "cache"))
    assert said["dse check"].startswith("ok: ")
    assert "2 of 2 configurations are valid" in said["dse enumerate drive"]
    assert said["dse explore gains"].startswith("out/gains: 216 runs, 216 of them new")
    assert "out/start_off  start_off  finished" in said["dse list"]
    learnt = said["dse findings gains"]
    assert "all requirements: met at both conditions in 19 %" in learnt
    assert "(estimated from 21 of 108 designs)" in learnt
    assert "all requirements: met at both conditions if keeper.gain > 140 kg/s and keeper.rate > 15 kg/s2: " in learnt
    assert "robot.mass is" not in learnt
    choice, _, ranking = said["dse best gains --minimize roughness"].partition("\nof 108 designs")
    assert choice.startswith("which design:\n  P gain 148.2 kg/s, I gain 30 kg/s2 (")
    assert "It meets all 3 requirements in both conditions: 6 verdicts. 21 of 108 designs do." in choice
    ranked = f"of 108 designs{ranking}".splitlines()
    assert ranked[0].startswith("of 108 designs 21 meet all requirements")
    assert re.search(r"148\.2 kg/s +30 kg/s2", ranked[2])
    assert (here / "out" / "gains" / "report.html").stat().st_size > 100_000
    with (here / "gains.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {row["keeper"] for row in rows} == {"keeper"}
    # Without an integral, drag and rolling leave an error; a fast run reaches the pace by the motors' limit.
    plain = [float(row["rest [km/h]"]) / 3.6 for row in rows if float(row["keeper.rate [kg/s2]"]) == 0]
    assert min(plain) > 8 / 200 * 0.5
    assert {row["exact.verdict"] for row in rows if float(row["keeper.rate [kg/s2]"]) == 0} == {"fail"}
    verdicts = [{row[f"{name}.verdict"] for name in ("calm", "quick", "exact")} for row in rows]
    assert {"pass"} in verdicts


def test_every_file_of_the_tutorial_is_named_in_its_first_line() -> None:
    named = [FILE.match(text) for kind, text in BLOCK.findall(TUTORIAL) if kind != "sh"]
    assert len(named) > 8
    assert all(named)


@pytest.mark.thorough
def test_a_search_for_a_boundary_ends_before_a_grid_would(tmp_path: Path, built_before: Callable[[Path], Path]) -> None:
    here, said = follow(text_of("boundary"), tmp_path, built_before(tmp_path / "cache"))
    runs = re.search(r"(\d+) runs", said["dse explore speed"])
    assert runs
    assert 32 <= int(runs[1]) <= 80
    assert (here / "out/speed/figures/boundary_R1_0.png").exists()
    assert "boundary: {samples:" in (here / "testbenches" / "closer.pet.yaml").read_text(encoding="utf-8")
    assert said["python"].count("[") == 4


@pytest.mark.thorough
def test_the_counts_beside_the_commands_of_the_highway_are_what_they_print(tmp_path: Path) -> None:
    here, said = follow(HIGHWAY, tmp_path, tmp_path / "cache")
    counted = [line for line in said if "#" in line]
    assert counted
    for line in counted:
        assert line.partition("# ")[2] in said[line]
    assert (here / "out" / "highway_architectures" / "report.html").stat().st_size > 100_000


def test_the_pictures_of_the_highway_are_there() -> None:
    names = re.findall(r"!\[[^]]*\]\((images/[^)]+)\)", HIGHWAY)
    assert names
    assert all((Path(__file__).parents[2] / "docs" / name).stat().st_size < 200_000 for name in names)
