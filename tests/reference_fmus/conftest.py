from __future__ import annotations

from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def reference_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where this session's archives are built; each is built once."""
    return tmp_path_factory.mktemp("reference_fmus")
