"""What holds for all tests: how much hypothesis tries, and that nothing is compiled twice."""

from __future__ import annotations

import os
import sys

import compile_cache
import pytest
from hypothesis import HealthCheck, is_hypothesis_test, settings

# The same examples each time, and no blame for a busy machine; `make nightly` looks for new ones, ten times as many.
settings.register_profile("everyday", derandomize=True, deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.register_profile("nightly", parent=settings.get_profile("everyday"), derandomize=False, print_blob=True)
settings.load_profile("everyday")
_NIGHTLY_FACTOR = 10

# Hundreds of tests start a Python of their own; without its bytecode each would compile all it imports.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False


def pytest_configure(config: pytest.Config) -> None:
    """Keep what the C compiler makes in pytest's cache (``pytest --cache-clear`` empties it)."""
    if hasattr(config, "cache"):
        compile_cache.use(config.cache.mkdir("compiled"))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """In the nightly run, multiply the examples of every test: most say their own number, which no profile changes."""
    if config.getoption("--hypothesis-profile") != "nightly":
        return
    for test in {item.obj for item in items if isinstance(item, pytest.Function) and is_hypothesis_test(item.obj)}:
        own = test._hypothesis_internal_use_settings
        test._hypothesis_internal_use_settings = settings(own, max_examples=_NIGHTLY_FACTOR * own.max_examples)


@pytest.fixture
def real_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    """For tests of what compiling the same sources twice gives: nothing is taken from what was kept."""
    compile_cache.leave(monkeypatch)
