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

PORTS = 'input Real speed(unit = "m/s"); input Real set_speed(unit = "m/s"); output Real force(unit = "N");'
MODELS = {
    "cruise_a": f"""
  parameter Real kp(unit = "N.s/m", min = 0) = 2000, ki(unit = "N/m", min = 0) = 100;
  {PORTS}
  Real integral(unit = "N", start = 0, fixed = true);
equation
  der(integral) = ki*(set_speed - speed);
  force = max(-6000, min(6000, kp*(set_speed - speed) + integral));""",
    "cruise_b": f"""
  parameter Real kp(unit = "N.s/m", min = 0) = 5000;
  {PORTS}
equation
  force = max(-8000, min(8000, kp*(set_speed - speed)));""",
    "truck": """
  parameter Real mass(unit = "kg", min = 1) = 4000, drag(unit = "kg/m", min = 0) = 3;
  input Real force(unit = "N");
  output Real speed(unit = "m/s", start = 10, fixed = true);
equation
  mass*der(speed) = force - drag*speed*abs(speed);""",
}


INTERFACES = """interfaces:
  cruise: {inputs: {speed: m/s, set_speed: m/s}, outputs: {force: N}}
  body: {inputs: {force: N}, outputs: {speed: m/s}}
"""


@pytest.fixture
def folder(tmp_path: Path, built_before: Callable[[Path], Path]) -> Path:
    """What somebody was sent: existing FMUs, one of them packed carelessly."""
    makers = tmp_path / "makers" / "components"
    makers.mkdir(parents=True)
    (makers / "interfaces.yaml").write_text(INTERFACES, encoding="utf-8")
    for name, body in MODELS.items():
        (makers / name).mkdir()
        (makers / name / "M.mo").write_text(f"model M{body}\nend M;\n", encoding="utf-8")
        interface = "body" if name == "truck" else "cruise"
        source = "{kind: modelica, model: M, files: [M.mo]}"
        text = f"component: {name}\nimplements: {interface}\nsource: {source}\n"
        (makers / name / "component.yaml").write_text(text, encoding="utf-8")
    made = run_dse(makers, "build", "-o", str(tmp_path), cache=built_before(tmp_path / "made"))
    assert made.returncode == 0, made.stderr
    with zipfile.ZipFile(tmp_path / "truck.fmu", "a") as archive:
        archive.writestr("extra/aux.txt", "")
    return tmp_path


@pytest.mark.thorough
def test_the_page_leads_from_files_to_a_report(folder: Path) -> None:
    here, printed = follow(TEXT, folder, folder / "cache")
    done = [line.split()[1] for line in printed if line.startswith("dse ")]
    assert done == ["probe", "import", "check", "enumerate", "simulate", "run", "simulate", "explore", "report"]
    assert (here / "out" / "gains" / "report.html").stat().st_size > 100_000
    # What was passed over is told with every result, and stays with the study, wherever it is looked at.
    simulated = run_dse(here, "simulate", "speed_step", "--format", "json", cache=folder / "cache")
    (ignored,) = json.loads(simulated.stdout)["ignored"]
    assert ignored.startswith("truck.fmu: the path 'extra/aux.txt'")
    assert ignored in (here / "out" / "gains" / "report.html").read_text(encoding="utf-8")
    told = json.loads(run_dse(here, "results", "out/both", "--format", "json", cache=folder / "cache").stdout)
    verdicts = [[requirement["verdict"] for requirement in run["requirements"].values()] for run in told["runs"]]
    # The integrator overshoots; without one the drag leaves 1200 N / 5000 N.s/m.
    assert verdicts == [["fail", "pass"], ["pass", "fail"]]
