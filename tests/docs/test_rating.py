"""docs/rating.md: its rating is for the cells it names. The shipped rating runs; the official command reads it."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import run_dse
from page import text_of

from dse.loading import Workspace
from dse.loading.bench.rating import read_rating
from dse.rating import Protocol
from dse.rating.cases import case_studies
from dse.testbench import one_configuration

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def workspace() -> Workspace:
    return Workspace(ROOT)


@pytest.mark.thorough
def test_the_rating_of_the_page_is_for_the_cells_it_names(workspace, tmp_path):
    block = re.search(r"```yaml\n(# testbenches/rear.rating.yaml\n.*?)```", text_of("rating"), re.DOTALL)
    assert block
    path = tmp_path / "rear.rating.yaml"
    path.write_text(block[1], encoding="utf-8")
    rating = read_rating(path, workspace.bench, tmp_path)
    design, protocol = workspace.design("aeb_vehicle"), Protocol("euroncap-rating-2026")
    (study,) = case_studies(rating, protocol, protocol.cells(), design, [one_configuration(design, None)])
    assert study.study.bench.name == "aeb_car_to_car"
    assert len([case for case in study.points if not case[1]]) == 8
    assert {dict(key[1])["Impact location"] for key, _ in study.points} == {"50%"}


@pytest.mark.thorough
def test_the_shipped_rating_is_run_and_its_workbook_has_the_same_points(tmp_path, kept_cache):
    import openpyxl

    arguments = ("rate", "aeb_vehicle", "--layers", "--format", "json", "-o", str(tmp_path / "out"), "--workers", "2")
    done = run_dse(ROOT, *arguments, cache=tmp_path / "cache")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    (rated,) = found["configurations"]
    # Cells in the middle of the lane, and again in fog those of the standard range.
    assert found["partly_simulated"] == {
        "CCRs": {"cells": 8, "of": 56},
        "CCRm": {"cells": 11, "of": 77},
        "CPNA day": {"cells": 18, "of": 30},
        "CPFA day": {"cells": 6, "of": 30},
    }
    assert found["simulated"] == 2 * (8 + 11 + 18 + 6)
    assert 0.0 < rated["points"] < 10.0
    scores = {(s["scenario"], s["layer"]): s for s in rated["scores"] if s["layer"]}
    assert scores["CCRs", "Standard"]["points"] > 0
    assert scores["CPFA", "Standard"]["points"] > 0
    assert scores["CCRb", "Standard"]["points"] == 0
    command = [
        sys.executable,
        "-m",
        "euroncap_rating_2026",
        "crash_avoidance",
        "compute-score",
        "-i",
        rated["workbook"],
    ]
    subprocess.run([*command, "-o", str(tmp_path)], cwd=tmp_path, check=True, capture_output=True)
    (report,) = tmp_path.glob("ca_*_report.xlsx")
    sheet = openpyxl.load_workbook(report)["Scenario Scores"]
    column = next(cell.column for cell in sheet[1] if cell.value == "Score")
    official = [float(sheet.cell(row, column).value) for row in range(2, sheet.max_row + 1)]
    assert official == [s["points"] for s in rated["scores"] if s["layer"]]
    # The report of a study gives each cell of the page a link to its run.
    assert "href" not in (tmp_path / "out/rating.html").read_text(encoding="utf-8").split("<body>")[1]
    bench = tmp_path / "out" / "aeb_pedestrian"
    assert run_dse(ROOT, "report", str(bench), cache=tmp_path / "cache").returncode == 0
    assert run_dse(ROOT, *arguments, cache=tmp_path / "cache").returncode == 0
    links = re.findall(r'href="([^"]*)"', (tmp_path / "out/rating.html").read_text(encoding="utf-8").split("<body>")[1])
    assert len(links) == 18 + 6
    assert all(re.fullmatch(r"aeb_pedestrian/report.html#run=\d+", link) for link in links)
