"""Makes the language cases and their solutions importable by name; one cache for all builds of a worker."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from modelica_components import Built, MakeModel, Opened, component
from quick_builds import unoptimized

from dse.domain.component import Component
from dse.domain.fmu import FmuModel
from dse.fmu.component_build import build
from dse.fmu.unpack import open_fmu


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, worker_id: str, built_before: Callable[[Path], Path]) -> Path:
    """What one test has compiled, the others need not; in parallel runs the workers share it."""
    base = tmp_path_factory.getbasetemp()
    return built_before((base if worker_id == "master" else base.parent) / "modelica-cache")


@pytest.fixture(scope="session")
def opened(cache: Path) -> Opened:
    """Builds and opens a component's FMU without the optimizer, of which a test of its own shows that it changes no bit
    of a model: hundreds in a minute."""

    def make(component: Component, version: int = 2) -> FmuModel:
        with unoptimized():  # of C that others write the last bit may depend on it
            return open_fmu(build(component, version=version, cache=cache), cache=cache)

    return make


@pytest.fixture(scope="session")
def built(opened: Opened) -> Built:
    """Builds and opens the FMU of a model file, for FMI 2 or 3."""

    def make(file: Path, version: int, structural: Mapping[str, float] | None = None) -> FmuModel:
        return opened(component(file, structural), version)

    return make


@pytest.fixture(scope="session")
def made(opened: Opened) -> MakeModel:
    """Builds and opens the FMU of a model file that needs libraries of these folders."""

    def make(file: Path, roots: tuple[Path, ...]) -> FmuModel:
        return opened(component(file, roots=roots))

    return make
