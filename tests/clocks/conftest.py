from __future__ import annotations

import pytest

from clocks.fmus import Workshop


@pytest.fixture(scope="session")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    """Where this session's FMUs with clocks are built."""
    return Workshop(tmp_path_factory.mktemp("clocks"))
