"""docs/ci.md and the action: what they name is there, and the action's scripts do what the page says."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from example_study import small_study
from page import BLOCK, text_of
from ruamel.yaml import YAML

from dse.cli.diagnostics import CheckFormat

ROOT = Path(__file__).parents[2]
TEXT = text_of("ci")


def load(text: str):
    return YAML(typ="safe", pure=True).load(text)


ACTION = load((ROOT / "action.yml").read_text("utf-8"))


def test_the_page_names_every_format_input_and_hook():
    assert all(f"| `{form.value}`" in TEXT for form in CheckFormat)
    workflow, hooks = (load(text) for kind, text in BLOCK.findall(TEXT) if kind == "yaml")
    (step,) = [each for each in workflow["jobs"]["dse"]["steps"] if "with" in each]
    assert set(step["with"]) <= set(ACTION["inputs"])
    named = [hook["id"] for hook in hooks["repos"][0]["hooks"]]
    assert named == [each["id"] for each in load((ROOT / ".pre-commit-hooks.yaml").read_text("utf-8"))]


@pytest.mark.thorough
@pytest.mark.skipif(sys.platform == "win32", reason="the steps run in bash")
def test_the_steps_check_and_gate_and_keep_the_report(tmp_path: Path, built_before: Callable[[Path], Path]):
    steps = {each["name"]: each for each in ACTION["runs"]["steps"] if "name" in each}
    paths = {"RUNNER_TEMP": str(tmp_path), "GITHUB_STEP_SUMMARY": str(tmp_path / "summary.md")}
    given = {"WORKSPACE": "work", "STUDY": "small", "STRICT": "true"}
    environment = {
        **os.environ,
        **paths,
        **given,
        "DSE_CACHE": str(built_before(tmp_path / "cache")),
        "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
    }

    def run(name: str) -> subprocess.CompletedProcess[str]:
        command = ["bash", "--noprofile", "--norc", "-eo", "pipefail", "-c", steps[name]["run"]]
        return subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, encoding="utf-8", check=False
        )

    subprocess.run(["dse", "init", "work"], cwd=tmp_path, env=environment, check=True, capture_output=True)
    study = tmp_path / "work" / "testbenches" / "small.pet.yaml"
    study.write_text(small_study(3, 2), encoding="utf-8")
    assert run("check").returncode == 0
    explored = run("explore")
    assert explored.returncode == 3, explored.stderr  # not every gain meets the requirements
    assert (tmp_path / "dse-report.html").stat().st_size > 100_000
    assert (tmp_path / "summary.md").read_text("utf-8").startswith("```\n")
    study.write_text(small_study(3, 2).replace("kp_speed", "kp_sped", 1), encoding="utf-8")
    checked = run("check")
    assert checked.returncode == 1
    assert checked.stdout.startswith("::error file=work/testbenches/small.pet.yaml,line=")
