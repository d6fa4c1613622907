"""Makes the language cases and their solutions importable by name; one cache for all builds of a worker."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

from modelica_components import Built, MakeModel, component

from dse.domain.fmu import FmuModel
from dse.fmu.building import build
from dse.fmu.toolchain import compilation
from dse.fmu.unpack import open_fmu


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory, worker_id: str, built_before: Callable[[Path], Path]) -> Path:
    """What one test has compiled, the others need not; in parallel runs the workers share it."""
    base = tmp_path_factory.getbasetemp()
    return built_before((base if worker_id == "master" else base.parent) / "modelica-cache")


@pytest.fixture(scope="session")
def without_optimization() -> Iterator[None]:
    """Hundreds of FMUs in a minute: a test of its own shows that the optimizer changes no bit."""
    with pytest.MonkeyPatch.context() as patch:
        quick = tuple("-O0" if option == "-O2" else option for option in compilation.LANGUAGE_OPTIONS)
        patch.setattr(compilation, "LANGUAGE_OPTIONS", quick)
        yield


@pytest.fixture(scope="session")
def built(cache: Path, without_optimization: None) -> Built:
    """Builds and opens the FMU of a model file, for FMI 2 or 3."""

    def make(file: Path, version: int, structural: Mapping[str, float] | None = None) -> FmuModel:
        return open_fmu(build(component(file, structural), version=version, cache=cache), cache=cache)

    return make


@pytest.fixture
def made(cache: Path, without_optimization: None) -> MakeModel:
    """Builds and opens the FMU of a model file that needs libraries of these folders."""

    def make(file: Path, roots: tuple[Path, ...]) -> FmuModel:
        return open_fmu(build(component(file, roots=roots), cache=cache), cache=cache)

    return make
