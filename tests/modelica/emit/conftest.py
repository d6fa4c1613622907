"""Makes emitted models importable and compiles them once a session's folder."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from dse.modelica.solved_model import Solved

sys.path.insert(0, str(Path(__file__).parent))

from emitted_model import Emitted, Emitter, compiled


@pytest.fixture(scope="session")
def emitted(tmp_path_factory: pytest.TempPathFactory) -> Emitter:
    """Emit, compile and load a solved model; *options* go to the compiler."""

    def make(solved: Solved, *options: str, starts: Mapping[str, float] | None = None) -> Emitted:
        return compiled(tmp_path_factory.mktemp("emitted"), solved, options, starts)

    return make
