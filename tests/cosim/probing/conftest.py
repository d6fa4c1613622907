from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from dse.domain.component import Kind
from dse.domain.fmu import Capabilities, Experiment, FmuModel, Variable
from dse.fmu.toolchain.compiler import find_compiler

SOURCE = Path(__file__).parent / "fmus" / "odd.c"

Odd = Callable[..., FmuModel]


@pytest.fixture(scope="session")
def odd(tmp_path_factory: pytest.TempPathFactory) -> Odd:
    """Compiles odd.c with the flags asked for: an FMU that does one thing wrong, or none."""
    folder = tmp_path_factory.mktemp("odd")

    def make(*flags: str, version: int = 2) -> FmuModel:
        name = "_".join(("odd", f"fmi{version}", *(flag.replace("=", "") for flag in flags)))
        library = folder / f"{name}{'.dll' if sys.platform == 'win32' else '.so'}"
        if not library.exists():
            fpic = [] if sys.platform == "win32" else ["-fPIC"]
            command = [*find_compiler().command, "-std=gnu11", "-O1", "-ffp-contract=off", *fpic, "-shared"]
            defines = [f"-DFMI={version}", *(f"-D{flag}" for flag in flags)]
            subprocess.run([*command, *defines, str(SOURCE), "-o", str(library)], check=True)
        kind = {2: "Real", 3: "Float64"}[version]
        named = (("u", "input"), ("k", "parameter"), ("y", "output"), ("n", "output"))
        variables = {
            v: Variable(v, reference, kind, causality, Kind.REAL, start=("2",) if v == "k" else ())
            for reference, (v, causality) in enumerate(named)
        }
        return FmuModel(
            archive=library,
            folder=folder,
            library=library,
            version=version,
            identifier="odd",
            token="the token",  # noqa: S106  # FMI's word for an identity
            variables=variables,
            capabilities=Capabilities(can_handle_variable_step=True, can_save_state=True),
            content_hash=name.encode().hex().ljust(64, "0"),
            experiment=Experiment(stop=0.5, step=0.01),
        )

    return make
