"""The example workspace with a small study beside it, opened through the front door."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from example_study import small_study

import dse

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Iterator[None]:
    """FMUs are built once for all tests."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("DSE_CACHE", str(built_before(tmp_path_factory.mktemp("cache"))))
        yield


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The workspace's folder. Tests only read it."""
    place = tmp_path_factory.mktemp("example")
    for name in ("components", "designs", "roads", "testbenches"):
        shutil.copytree(ROOT / name, place / name)
    (place / "testbenches" / "small.pet.yaml").write_text(small_study(3, 2), encoding="utf-8")
    return place


@pytest.fixture(scope="session")
def ws(folder: Path) -> dse.Workspace:
    return dse.open(folder)


@pytest.fixture(scope="session")
def told() -> list[dse.Progress]:
    """What the exploration of `results` told of its progress."""
    return []


@pytest.fixture(scope="session")
def results(ws: dse.Workspace, told: list[dse.Progress], tmp_path_factory: pytest.TempPathFactory) -> dse.Results:
    """The small study, explored."""
    return ws.studies["small"].explore(tmp_path_factory.mktemp("out") / "small", workers=1, progress=told.append)
