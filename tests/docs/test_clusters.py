"""docs/clusters.md: its scripts are scripts, its commands are commands, and its plan adds up."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest
from ruamel.yaml import YAML

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "clusters.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)( no-run)?\n(.*?)^```$", TEXT, re.DOTALL | re.MULTILINE)


def blocks(*kinds: str) -> list[str]:
    return [text for kind, _, text in BLOCKS if kind in kinds]


@pytest.mark.skipif(sys.platform == "win32", reason="there is no bash")
@pytest.mark.parametrize("script", blocks("sh", "bash"))
def test_scripts_can_be_read_by_a_shell(script: str) -> None:
    done = subprocess.run(["bash", "-n"], input=script, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")


def test_commands_and_their_options_are_there() -> None:
    from typer.main import get_command

    from dse.cli.app import app
    from dse.cli.commands import register

    register()
    commands = get_command(app).commands
    told = re.findall(r"\bdse (explore|merge|report|results) ([^\"`\n#]*)", TEXT)
    assert len(told) > 8
    for name, rest in told:
        options = {option for parameter in commands[name].params for option in parameter.opts}
        assert set(re.findall(r"(?<!\S)--?[a-z][a-z-]*", rest)) <= options


def test_what_is_yaml_can_be_read() -> None:
    job, *_ = [YAML(typ="safe").load(text) for text in blocks("yaml")]
    assert job["spec"]["completions"] == job["spec"]["parallelism"] == 8
    assert job["spec"]["template"]["spec"]["containers"][0]["command"][-1].endswith("/8")


@pytest.mark.parametrize("code", blocks("python"))
def test_what_is_python_is_python(code: str) -> None:
    compile(code, "clusters.md", "exec")


@pytest.fixture
def plan(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(ROOT / "benchmarks"))
    import plan_cluster

    return plan_cluster


def test_the_plan_without_losses_is_work_by_workers(plan) -> None:
    case = plan.Case("small", 2000, 60.0, 20, spread=0.0, lost_after=1e12, arrive=0.0)
    outcome = plan.simulate(case, plan.Costs(start=0.0, trip=0.0))
    # The first minute is the canary's.
    assert outcome.hours * 3600 == pytest.approx(60.0 + 2000 * 60.0 / 20, rel=0.001)
    assert (outcome.lost_runs, outcome.loads) == (0, 2000)


def test_in_the_plan_workers_that_are_lost_cost_time_and_no_run(plan) -> None:
    case = plan.Case("small", 2000, 60.0, 20, lost_after=3600.0)
    calm, rough = (plan.simulate(plan.replace(case, lost_after=after), plan.Costs()) for after in (1e12, 1800.0))
    assert rough.lost_runs > 10
    assert rough.hours > calm.hours


def test_the_plan_of_the_page_is_of_these_cases(plan) -> None:
    assert plan.HEAD in TEXT
    for case in plan.CASES:
        assert f"| {case.name} | {case.runs:,} | {case.seconds:g} s | {case.workers:,} |" in TEXT
