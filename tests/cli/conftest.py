"""A laid-out example workspace, and the command line run as a user runs it."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from command_line import run_dse
from example_study import small_study

Dse = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    return built_before(tmp_path_factory.mktemp("cache"))


@pytest.fixture(scope="session")
def example(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Path:
    """The example as ``dse init`` lays it out, with a small study beside it. Tests only read it."""
    folder = tmp_path_factory.mktemp("example") / "work"
    done = run_dse(folder.parent, "init", "work", cache=cache)
    assert done.returncode == 0, done.stderr
    (folder / "testbenches" / "small.pet.yaml").write_text(small_study(5, 4), encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def dse(example: Path, cache: Path) -> Dse:
    """Runs ``dse`` in the example workspace."""
    return lambda *arguments: run_dse(example, *arguments, cache=cache)


@pytest.fixture(scope="session")
def dse_in(cache: Path) -> Dse:
    """Runs ``dse`` in the folder that comes first."""
    return lambda folder, *arguments: run_dse(folder, *arguments, cache=cache)


@pytest.fixture(scope="session")
def explored(dse: Dse, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The study folder of the small study."""
    folder = tmp_path_factory.mktemp("explored") / "small"
    done = dse("explore", "small", "-o", str(folder), "--workers", "2")
    assert done.returncode == 0, done.stderr
    return folder
