"""Makes the fakes of this folder importable by name, here and in worker processes (spawn hands sys.path on)."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

_DEAR = {
    "test_executor_suite.py": "test_its_results_are_those_of_one_process",
    "test_optimisers.py": "MixedGp",
    "test_sampler_suite.py": "Test_mixed_gp",
}


@pytest.hookimpl(tryfirst=True)  # before tests are chosen by their marks
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Make dear cases of suites and tables thorough."""
    for item in items:
        if (word := _DEAR.get(item.path.name)) and word in item.nodeid:
            item.add_marker(pytest.mark.thorough)
