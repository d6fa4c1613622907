from __future__ import annotations

import subprocess
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from dse.domain.component import Kind
from dse.domain.fmu import Capabilities, FmuModel, Host, Variable
from dse.domain.system import Element, SystemStructure, Wire
from dse.errors import Location
from dse.fmu.toolchain.compiler import find_compiler, find_windows_compiler
from dse.fmu.unpack import isolated
from dse.fmu.windows import bridge_to

SOURCES = Path(__file__).parent / "fmus"

REAL, WHOLE, TRUTH = ("Real", "Float64"), ("Integer", "Int32"), ("Boolean", "Boolean")
RELAYED = {
    2: {"Real": 0, "Integer": 6, "Boolean": 10},
    3: {
        "Float64": 0,
        "Float32": 1,
        "Int8": 2,
        "UInt8": 3,
        "Int16": 4,
        "UInt16": 5,
        "Int32": 6,
        "UInt32": 7,
        "Int64": 8,
        "UInt64": 9,
        "Boolean": 10,
    },
}
VARIABLES = {
    "linear": {"u": REAL, "a": REAL, "b": REAL, "y0": REAL, "y": REAL},
    "gain": {"u": REAL, "k": REAL, "c": REAL, "y": REAL},
    "counter": {"enable": TRUTH, "increment": WHOLE, "count": WHOLE, "odd": TRUTH},
    "liar": {"u": REAL, "y": REAL},
    "told": {"y": REAL},
    "writer": {"y": REAL},
    "stepper": dict.fromkeys(("mode", "most", "u", "y", "steps", "sum"), REAL),
    "eventful": {
        **dict.fromkeys(("u",), REAL),
        **dict.fromkeys(("d",), WHOLE),
        **dict.fromkeys(("period", "announces", "y"), REAL),
        **dict.fromkeys(("seen", "events", "updates", "steps"), WHOLE),
        **dict.fromkeys(("mode",), REAL),
    },
    "speaker": {
        **dict.fromkeys(("mode", "size", "heard"), REAL),
        **dict.fromkeys(("said", "given"), ("String", "String")),
        **dict.fromkeys(("bytes", "taken"), ("Binary", "Binary")),
        "events": WHOLE,
    },
    "osmp": {
        **dict.fromkeys(("mode", "size"), REAL),
        **dict.fromkeys(("in.base.lo", "in.base.hi", "in.size", "out.base.lo", "out.base.hi", "out.size"), WHOLE),
        "y": REAL,
    },
    "faulty": {"mode": WHOLE, "at": REAL, "y": REAL, "n": ("Integer", "Int64"), "u": REAL},
}
INPUTS = {"speaker": {"given", "taken"}, "stepper": {"u"}, "eventful": {"u", "d"}}
OUTPUTS = {"y", "count", "odd", "n", "steps", "sum", "seen", "events", "updates", "heard", "said", "bytes"}


@dataclass(frozen=True)
class Shelf:
    """Compiles the FMUs in fmus/ when they are first asked for, and builds systems of them.

    With *wine*, a cache folder, they are for Windows, behind a bridge; with *apart*, likewise, each is isolated.
    """

    folder: Path
    wine: Path | None = None
    apart: Path | None = None

    def fmu(self, name: str, version: int = 2, *flags: str) -> FmuModel:
        if (self.wine or self.apart) and version == 1:
            pytest.skip("no FMU of FMI 1.0 is behind a bridge")
        key = "_".join([name, f"fmi{version}", *(flag.strip("-") for flag in flags)])
        is_dll = self.wine is not None or sys.platform == "win32"
        library, host = self.folder / f"{key}{'.dll' if is_dll else '.so'}", Host()
        if not library.exists():
            fpic = [] if is_dll else ["-fPIC"]
            source = str(SOURCES / f"{name}.c")
            compiler = find_windows_compiler() if self.wine else find_compiler()
            command = [*compiler.command, "-std=c11", "-O1", "-ffp-contract=off", "-Wall", "-Werror"]
            subprocess.run(
                [
                    *command,
                    *fpic,
                    "-shared",
                    f"-DFMI={version}",
                    f"-DIDENTIFIER={name}",
                    *flags,
                    source,
                    "-o",
                    str(library),
                    "-lm",
                ],
                check=True,
            )
        if self.wine:
            library, host = bridge_to(library, name, Location(name), self.wine)
        model = FmuModel(
            archive=library,
            folder=self.folder,
            library=library,
            version=version,
            identifier=name,
            token="the token",  # noqa: S106  # FMI's word for an identity
            variables={v.name: v for v in variables(name, version)},
            host=host,
            capabilities=Capabilities(can_handle_variable_step=True, once_per_process="-DONCE" in flags),
        )
        return isolated(model, Location(name), self.apart) if self.apart else model

    def system(
        self,
        elements: Mapping[str, FmuModel],
        wires: Sequence[str] = (),
        start: Mapping[str, float] | None = None,
        record: Sequence[str] = (),
    ) -> SystemStructure:
        """Elements by name; wires as "a.y -> b.u"; start by "element.variable"; what is recorded becomes an output."""
        ends = [wire.split(" -> ") for wire in wires]
        sources, targets = {source for source, _ in ends} | set(record), {target for _, target in ends}
        built = [
            Element(
                name,
                model,
                tuple(v for v in model.variables.values() if f"{name}.{v.name}" in targets),
                tuple(v for v in model.variables.values() if f"{name}.{v.name}" in sources),
                {key.split(".", 1)[1]: x for key, x in (start or {}).items() if key.split(".", 1)[0] == name},
            )
            for name, model in elements.items()
        ]
        return SystemStructure(
            "test", tuple(built), tuple(Wire(*source.split(".", 1), *target.split(".", 1)) for source, target in ends)
        )


def variables(name: str, version: int) -> list[Variable]:
    if name == "relay":
        return [
            Variable(f"{side}_{fmi_type}", reference + offset, fmi_type, causality, None)
            for fmi_type, reference in RELAYED[version].items()
            for side, offset, causality in (("from", 0, "input"), ("to", 16, "output"))
        ]
    return [
        Variable(v, number, types[version > 2], causality(name, v), Kind.REAL, is_intermediate=v == "u")
        for number, (v, types) in enumerate(VARIABLES[name].items())
    ]


def causality(name: str, variable: str) -> str:
    if variable in INPUTS.get(name, ()):
        return "input"
    return "output" if variable in OUTPUTS else "parameter"


OF_WINDOWS = {"test_events", "test_steps", "test_texts"}
"""What is tested through wine and isolated, too."""


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "shelf" in metafunc.fixturenames and metafunc.module.__name__.rpartition(".")[2] in OF_WINDOWS:
        places = [
            "here",
            pytest.param("apart", marks=pytest.mark.thorough),
            pytest.param("wine", marks=pytest.mark.thorough),
        ]
        metafunc.parametrize("shelf", places, indirect=True, scope="session")


@pytest.fixture(scope="session")
def shelf(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Shelf:
    place, folder = getattr(request, "param", "here"), tmp_path_factory.mktemp("fmus")
    if place == "apart" and sys.platform != "linux":
        pytest.skip("FMUs are isolated on Linux only")
    wine = request.getfixturevalue("wine_cache") if place == "wine" else None
    return Shelf(folder, wine, folder / "cache" if place == "apart" else None)


@pytest.fixture
def lone(shelf: Shelf):
    """A system of one faulty FMU called world that takes a mode and a time, and a gain it is wired to."""

    def build(version: int, **changes: object) -> SystemStructure:
        model = replace(shelf.fmu("faulty", version), **changes)
        elements = {"world": model, "car": shelf.fmu("gain", version)}
        return shelf.system(elements, ["world.y -> car.u"], {"world.mode": 0, "world.at": 0}, ["car.y", "world.n"])

    return build
