"""Small C and Modelica components in systems, simulated through FMI and fused, side by side."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.component import Causality, Component, CSource, Interface, Kind, ModelicaSource, Parameter, Port, Type
from dse.domain.fmu import FmuModel
from dse.domain.fused import FusedLibrary
from dse.domain.method import PLAIN, Algorithm, Method
from dse.domain.system import Element, SystemStructure, Wire
from dse.fmu.component_build import build
from dse.fmu.fusion.fuse import fuse
from dse.fmu.unpack import open_fmu

REAL, WHOLE, TRUTH = Type(Kind.REAL), Type(Kind.INTEGER), Type(Kind.BOOLEAN)
GEAR = Type(Kind.ENUMERATION, items=("park", "reverse", "drive"))


def ports(inputs: Mapping[str, Type], outputs: Mapping[str, Type]) -> Interface:
    found = [Port(name, Causality.INPUT, kind) for name, kind in inputs.items()]
    found += [Port(name, Causality.OUTPUT, kind) for name, kind in outputs.items()]
    return Interface("tested", tuple(found))


@dataclass
class Workshop:
    """Writes components into a folder and joins them to systems; archives go to *cache*."""

    folder: Path
    cache: Path
    version: int = 2
    method: Method = PLAIN
    models: dict[str, FmuModel] = field(default_factory=dict)

    def c(
        self,
        name: str,
        members: str,
        code: str,
        interface: Interface,
        parameters: Sequence[Parameter] = (),
        step: float | None = None,
        more: Mapping[str, str] | None = None,
    ) -> FmuModel:
        """A C component *name*; *more* are further C files by name."""
        folder = self.folder / name
        folder.mkdir()
        arguments = f"{name} *c" if step is not None else f"{name} *c, double h"
        head = f"#include <stdbool.h>\n#include <stdint.h>\ntypedef struct {{ {members} }} {name};\n"
        head += f"void {name}_init({name} *c);\nvoid {name}_step({arguments});\n"
        (folder / f"{name}.h").write_text(f"#ifndef GUARD\n#define GUARD\n{head}\n#endif\n", encoding="utf-8")
        files = {f"{name}.c": f'#include "{name}.h"\n#include <math.h>\n{code}\n', **(more or {})}
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
        source = CSource(
            tuple(folder / file for file in files), folder / f"{name}.h", name, f"{name}_init", f"{name}_step", step
        )
        return self.built(Component(name, interface, source=source, parameters=tuple(parameters)))

    def modelica(self, name: str, text: str, interface: Interface, parameters: Sequence[Parameter] = ()) -> FmuModel:
        """A Modelica component of the model *name*, whose body is *text*."""
        file = self.folder / f"{name}.mo"
        file.write_text(f"model {name}\n{text}\nend {name};\n", encoding="utf-8")
        source = ModelicaSource(name, (file,))
        return self.built(Component(name, interface, source=source, parameters=tuple(parameters)))

    def built(self, component: Component) -> FmuModel:
        return open_fmu(build(component, version=self.version, cache=self.cache), cache=self.cache)

    def fuse(self, system: SystemStructure, record: Sequence[str]) -> FusedLibrary:
        return fuse(system, record, self.method, cache=self.cache)

    def simulator(self, system: SystemStructure, record: Sequence[str], fused: FusedLibrary | None = None) -> Simulator:
        return Simulator(system, record, method=self.method, fused=fused)


def system_of(
    elements: Mapping[str, FmuModel], wires: Sequence[str] = (), record: Sequence[str] = ()
) -> SystemStructure:
    """Elements by name, wires as "a.y -> b.u"; what is recorded is an output, too."""
    ends = [wire.split(" -> ") for wire in wires]
    sources, targets = {source for source, _ in ends} | set(record), {target for _, target in ends}
    built = [
        Element(
            name,
            model,
            tuple(v for v in model.variables.values() if f"{name}.{v.name}" in targets),
            tuple(v for v in model.variables.values() if f"{name}.{v.name}" in sources),
            {},
        )
        for name, model in elements.items()
    ]
    joined = tuple(Wire(*source.split(".", 1), *target.split(".", 1)) for source, target in ends)
    return SystemStructure("tested", tuple(built), joined)


Start = Mapping[str, float]


def both_ways(
    workshop: Workshop, system: SystemStructure, record: Sequence[str], starts: Sequence[Start] = ({},), **times: float
) -> list[NDArray[np.float64]]:
    """The runs for *starts* on one simulator, through FMI; the fused ones are the same bits."""
    options = {"stop": 1.0, "step": 0.01, **times}
    fused = workshop.fuse(system, record)
    made = []
    method = workshop.method
    with (
        Simulator(system, record, method=method) as plain,
        Simulator(system, record, method=method, fused=fused) as quick,
    ):
        for number, start in enumerate(starts):
            expected, found = plain.run(start=start, **options), quick.run(start=start, **options)
            assert found.tobytes() == expected.tobytes()
            # The second run proves the reset, by FMI calls.
            assert quick.fused_steps == (0 if number == 1 else len(expected) - 1)
            assert plain.fused_steps == 0
            made.append(expected)
        assert quick.reset_is_trusted == plain.reset_is_trusted
    return made


def failures(
    workshop: Workshop, system: SystemStructure, record: Sequence[str], start: Start | None = None, **times: float
) -> tuple[RunFailed, RunFailed]:
    """How the same run fails through FMI and fused."""
    options = {"stop": 1.0, "step": 0.01, **times}
    fused = workshop.fuse(system, record)
    found = []
    for library in (None, fused):
        with (
            Simulator(system, record, method=workshop.method, fused=library) as simulator,
            pytest.raises(RunFailed) as caught,
        ):
            simulator.run(start=start or {}, **options)
        found.append(caught.value)
    return found[0], found[1]


def assert_same(failed: tuple[RunFailed, RunFailed]) -> RunFailed:
    """Both fail at the same place and time, with the same words and the same log."""
    plain, quick = failed
    for said in ("element", "call", "time", "what", "log", "fatal"):
        assert getattr(quick, said) == getattr(plain, said), said
    return quick


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One cache for all tests: what one has compiled, the others need not."""
    return tmp_path_factory.mktemp("cache")


IN_TURN = Method(algorithm=Algorithm.GAUSS_SEIDEL)
CASES = {"fmi2": (2, PLAIN), "fmi3": (3, PLAIN), "fmi2-in_turn": (2, IN_TURN), "fmi3-in_turn": (3, IN_TURN)}


@pytest.fixture(params=["fmi2", "fmi3", "fmi3-in_turn", pytest.param("fmi2-in_turn", marks=pytest.mark.thorough)])
def case(request: pytest.FixtureRequest) -> tuple[int, Method]:
    return CASES[request.param]


@pytest.fixture
def version(case: tuple[int, Method]) -> int:
    return case[0]


@pytest.fixture
def method(case: tuple[int, Method]) -> Method:
    return case[1]


@pytest.fixture
def workshop(tmp_path: Path, cache: Path, version: int, method: Method) -> Workshop:
    return Workshop(tmp_path, cache, version, method)
