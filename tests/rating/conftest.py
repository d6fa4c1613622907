"""The protocol's package, opened once, and the workbooks of three designs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from rated_cars import ANSWERS, FILES, RATING, WARNED, predicted
from workspaces import written

from dse.loading import Workspace
from dse.rating import Filled, Protocol, fill


@pytest.fixture(scope="session")
def protocol() -> Protocol:
    return Protocol("euroncap-rating-2026")


@pytest.fixture(scope="session")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Workspace:
    """Tests only read it."""
    return Workspace(written(tmp_path_factory.mktemp("rated"), {**FILES, "testbenches/small.rating.yaml": RATING}))


@pytest.fixture
def rating_file(workspace: Workspace, tmp_path: Path) -> Callable[[str], Path]:
    """Writes a rating of the workspace's bench."""

    def write(text: str) -> Path:
        path = tmp_path / "small.rating.yaml"
        path.write_text(text, encoding="utf-8")
        return path

    return write


@pytest.fixture(scope="session")
def filled(protocol: Protocol) -> dict[str, Filled]:
    """The workbooks of the three designs."""
    return {name: fill(protocol, predicted(protocol, name), WARNED) for name in ANSWERS}
