"""docs/bring-your-fmu.md: whoever does what it says, from the first command to the last, has a study and its report."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse
from page import follow, text_of

TEXT = text_of("bring-your-fmu")


@pytest.fixture
def cache(tmp_path: Path, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path / "cache")


@pytest.mark.thorough
def test_the_page_leads_from_files_to_a_report(tmp_path: Path, cache: Path) -> None:
    start, rest = TEXT.split("## 1. ")
    folder, _ = follow(start, tmp_path, cache)
    with zipfile.ZipFile(folder / "truck.fmu", "a") as archive:  # an FMU that was packed carelessly
        archive.writestr("extra/aux.txt", "")
    here, printed = follow(rest, folder, cache)
    done = [line.split()[1] for line in printed if line.startswith("dse ")]
    assert done == ["probe", "import", "check", "enumerate", "simulate", "run", "simulate", "explore", "report"]
    assert (here / "out" / "gains" / "report.html").stat().st_size > 100_000
    # What was passed over is told with every result, and stays with the study, wherever it is looked at.
    simulated = run_dse(here, "simulate", "speed_step", "--format", "json", cache=cache)
    (ignored,) = json.loads(simulated.stdout)["ignored"]
    assert ignored.startswith("truck.fmu: the path 'extra/aux.txt'")
    assert ignored in (here / "out" / "gains" / "report.html").read_text(encoding="utf-8")
    told = json.loads(run_dse(here, "results", "out/both", "--format", "json", cache=cache).stdout)
    verdicts = [[requirement["verdict"] for requirement in run["requirements"].values()] for run in told["runs"]]
    # The integrator overshoots; without one the drag leaves 1200 N / 5000 N.s/m.
    assert verdicts == [["fail", "pass"], ["pass", "fail"]]
