"""The commands and files of the README and of the tour run as they are shown."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import pytest
from command_line import run_dse

from dse.loading.workspace import Workspace

ROOT = Path(__file__).parents[2]
README, TOUR = ROOT / "README.md", ROOT / "docs/tour.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)


def blocks(language: str, *pages: Path) -> list[str]:
    found = [BLOCK.findall(page.read_text(encoding="utf-8")) for page in pages or (README, TOUR)]
    return [text for page in found for kind, text in page if kind == language]


def write(files: Iterable[str], folder: Path) -> None:
    for text in files:
        (folder / text.splitlines()[0].removeprefix("# ").split(":")[0]).write_text(text, encoding="utf-8")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("readme")
    assert run_dse(folder, "init", "my-study", cache=folder).returncode == 0
    write(blocks("yaml", README), folder / "my-study")
    return folder / "my-study"


def test_the_readme_can_be_read_in_a_few_minutes():
    assert len(README.read_text(encoding="utf-8").split()) <= 900


@pytest.mark.thorough
@pytest.mark.parametrize("page", [README, TOUR], ids=["readme", "tour"])
def test_every_command_succeeds(workspace, tmp_path, built_before, page):
    cache = built_before(tmp_path / "cache")
    commands = [shlex.split(line, comments=True) for block in blocks("sh", page) for line in block.splitlines()]
    ours = [command for command in commands if command and command[0] == "dse" and command[1] != "init"]
    assert len(ours) >= 5
    for command in ours:
        done = run_dse(workspace, *command[1:], cache=cache)
        assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"


def test_the_numbers_beside_the_commands_are_those_they_print(workspace):
    text = README.read_text(encoding="utf-8")
    claimed = re.search(r"# (\d+) of (\d+) configurations meet", text)
    done = run_dse(workspace, "enumerate", "acc_vehicle", "--count", cache=workspace)
    assert claimed
    assert f"{claimed[1]} of {claimed[2]} configurations" in done.stdout


def test_the_files_shown_can_be_read(workspace, tmp_path):
    copy = shutil.copytree(workspace, tmp_path / "copy")
    write(blocks("yaml"), copy)
    shown, shipped = (
        (root / "testbenches/acc_gains.pet.yaml").read_text(encoding="utf-8") for root in (copy, workspace)
    )
    assert shown.partition("\n")[2] == shipped.partition("\n")[2]  # less the schema, and the file's name
    study = Workspace(copy).study("acc_gains")
    assert study.bench.design.constraints[0].name == "budget"
    assert len(Workspace(copy).study("two_gains").variables) == 2


@pytest.mark.thorough
def test_the_python_shown_runs(workspace, tmp_path, built_before):
    copy = shutil.copytree(workspace, tmp_path / "copy", ignore=shutil.ignore_patterns("out"))
    study = copy / "testbenches" / "acc_gains.pet.yaml"
    # The same study on a coarse grid: 18 runs.
    study.write_text(study.read_text(encoding="utf-8").replace("levels: 33", "levels: 3"), encoding="utf-8")
    (text,) = blocks("python")
    done = subprocess.run(
        [sys.executable, "-c", text],
        cwd=copy,
        env={**os.environ, "DSE_CACHE": str(built_before(tmp_path / "cache"))},
        capture_output=True,
        text=True,
        encoding="utf-8",
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "configurations below 6000 EUR" in done.stdout
    assert re.search(r"^pass +\d", done.stdout, re.MULTILINE)
    assert done.stdout.endswith(" s\n")
    assert "18/18" in done.stderr
