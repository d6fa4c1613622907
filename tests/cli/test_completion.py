"""What shells offer: as the scripts that typer installs ask for it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest
from example_study import example_benches, example_designs, example_studies

# As the console script does: shells know the program as 'dse'.
DSE = [sys.executable, "-c", "import sys; sys.argv[0] = 'dse'; from dse.cli import main; main()"]


def completed(folder, cache, line: str, **more: str) -> list[str]:
    """What bash would offer at the end of *line*."""
    words = line.split(" ")
    environment = {
        **os.environ,
        "DSE_CACHE": str(cache),
        "_DSE_COMPLETE": "complete_bash",
        "COMP_WORDS": line,
        "COMP_CWORD": str(len(words) - 1),
        **more,
    }
    done = subprocess.run(DSE, cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    return done.stdout.split()


@pytest.fixture(scope="module")
def workspace(dse_in, tmp_path_factory):
    folder = tmp_path_factory.mktemp("completed")
    assert dse_in(folder, "init", "work").returncode == 0
    (folder / "work" / "out" / "acc_gains").mkdir(parents=True)
    (folder / "work" / "out" / "all").mkdir()
    return folder / "work"


@pytest.mark.sampled(4)
@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("dse expl", ["explore"]),
        ("dse explore ", example_studies()),
        ("dse explore acc_gains_", ["acc_gains_4d", "acc_gains_boundary", "acc_gains_coded"]),
        ("dse explore acc_gains --sh", ["--shard"]),
        ("dse run ", example_benches()),
        ("dse simulate electric_acc_m", ["electric_acc_motorway"]),
        ("dse report ", ["acc_gains", "all"]),
        ("dse merge al", ["all"]),
        ("dse enumerate ", example_designs()),
        ("dse space count electric_a", ["electric_acc"]),
        ("dse space cou", ["count"]),
        ("dse build radar", ["radar_77ghz_long", "radar_77ghz_mid"]),
        ("dse build --fuse acc", ["acc_coded", "acc_following"]),
        ("dse new study x --bench acc", ["acc_coded", "acc_following"]),
        ("dse new design x pd", ["pd_acc", "pd_acc_coded"]),
        ("dse results all --format p", ["parquet"]),
        ("dse docs tut", ["tutorial"]),
        ("dse schema st", ["study"]),
    ],
)
def test_names_of_the_workspace_are_offered(workspace, cache, line, offered):
    assert completed(workspace / "designs", cache, line) == offered


@pytest.mark.thorough
def test_outside_of_a_workspace_there_are_no_names(tmp_path, cache):
    assert completed(tmp_path, cache, "dse explore ") == []
    assert completed(tmp_path, cache, "dse report ") == []
    assert completed(tmp_path, cache, "dse rep") == ["report", "replay"]


@pytest.mark.parametrize(
    ("shell", "words"), [("bash", "complete -o default -F"), ("zsh", "#compdef dse"), ("fish", "dse")]
)
def test_the_script_for_a_shell_is_shown(tmp_path, cache, shell, words):
    environment = {**os.environ, "DSE_CACHE": str(cache), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    command = [*DSE, "--show-completion", shell]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stderr
    assert words in done.stdout
    assert "_DSE_COMPLETE" in done.stdout


@pytest.mark.skipif(sys.platform == "win32", reason="there is no bash")
def test_what_is_installed_for_bash_is_a_script_bash_can_read(tmp_path, cache):
    environment = {
        **os.environ,
        "HOME": str(tmp_path),
        "DSE_CACHE": str(cache),
        "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1",
    }
    command = [*DSE, "--install-completion", "bash"]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, encoding="utf-8", check=False)
    assert done.returncode == 0, done.stderr
    (script,) = tmp_path.rglob("dse.sh")
    assert str(script) in (tmp_path / ".bashrc").read_text(encoding="utf-8")
    assert subprocess.run(["bash", "-n", script], check=False).returncode == 0
