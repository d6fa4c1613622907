"""What a host of the repository reads: its jobs run what `.ci/run` does, and its files name what is."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import dse

ROOT = Path(__file__).parents[2]
MAKEFILE = (ROOT / "Makefile").read_text("utf-8")
# Targets with what they need first; those of `make check` that do nothing themselves are made of these.
NEEDS = {target: needed.split() for target, needed in re.findall(r"^(\w+):(?!=)(.*)$", MAKEFILE, re.MULTILINE)}
MADE_OF_OTHERS = ("check", "rest")


def load(path: str):
    return YAML(typ="safe", pure=True).load((ROOT / path).read_text("utf-8"))


def jobs():
    return load(".github/workflows/ci.yml")["jobs"]


def single(target: str) -> set[str]:
    """The targets that *target* is made of, or itself."""
    return {target} if target not in MADE_OF_OTHERS else {each for other in NEEDS[target] for each in single(other)}


def made(text: str) -> set[str]:
    return {each for target in re.findall(r"^[^#\n]*\bmake (\w+)", text, re.MULTILINE) for each in single(target)}


def of_jobs(*, may_fail: bool) -> set[str]:
    return {
        target
        for job in jobs().values()
        if job.get("continue-on-error", False) == may_fail
        for step in job["steps"]
        for target in made(step.get("run", ""))
    }


def test_every_target_of_the_own_run_is_a_job():
    run = (ROOT / ".ci/run").read_text("utf-8")
    wanted = made(run.replace("; then ", "\n")) | single("check")
    assert {"test", "lint", "types", "thorough", "audit"} <= wanted
    assert of_jobs(may_fail=False) == wanted
    assert of_jobs(may_fail=True) == {"setup", "test"}


def test_jobs_run_make_and_nothing_else():
    for job in jobs().values():
        for step in job["steps"]:
            assert re.match(r"make [a-z]+", step["run"]) if "run" in step else step["uses"].startswith("actions/")


def test_the_two_parts_of_the_thorough_tests_are_all_of_them():
    assert jobs()["thorough"]["strategy"]["matrix"]["part"] == ["1/2", "2/2"]
    folders = re.search(r"^FIRST_PART := (.*)$", MAKEFILE, re.MULTILINE)[1].split()
    assert all((ROOT / folder).is_dir() for folder in folders)
    assert "$(FIRST_PART:%=--ignore=%)" in MAKEFILE  # the second part is the rest


def test_the_versions_of_python_are_those_of_the_package():
    named = re.findall(r"Python :: (3\.\d+)", (ROOT / "pyproject.toml").read_text("utf-8"))
    assert jobs()["test"]["strategy"]["matrix"]["python"] == named


def test_hooks_are_tools_of_the_environment():
    (source,) = load(".pre-commit-config.yaml")["repos"]
    assert source["repo"] == "local"
    assert {hook["language"] for hook in source["hooks"]} == {"system"}


@pytest.mark.parametrize(("key", "value"), [("version", dse.__version__), ("license", "Apache-2.0")])
def test_the_citation_is_that_of_this_version(key, value):
    assert load("CITATION.cff")[key] == value
