"""Small C components for the tests, and one way to drive FMUs of both FMI versions through FMPy."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest

from dse.domain.component import Causality, Component, CSource, Interface, Kind, Parameter, Port, Type
from dse.domain.fmu import FmiInterface, FmuModel
from dse.errors import DseError
from dse.fmu.component_build import build
from dse.fmu.reading.description import Description, read_description
from dse.fmu.unpack import open_fmu
from dse.units import parse_unit


def real(unit: str = "") -> Type:
    return Type(Kind.REAL, parse_unit(unit))


INTEGER = Type(Kind.INTEGER)
BOOLEAN = Type(Kind.BOOLEAN)


def ports(inputs: dict[str, Type], outputs: dict[str, Type]) -> Interface:
    found = [Port(name, Causality.INPUT, kind) for name, kind in inputs.items()]
    found += [Port(name, Causality.OUTPUT, kind) for name, kind in outputs.items()]
    return Interface("tested", tuple(found))


@dataclass
class Workshop:
    """Writes a component's C into a folder of its own and makes the noun for it."""

    folder: Path

    def component(
        self,
        name: str,
        header: str,
        code: str,
        interface: Interface,
        parameters: tuple[Parameter, ...] = (),
        step: float | None = None,
        **fields: Any,
    ) -> Component:
        (self.folder / f"{name}.h").write_text(
            f"#ifndef GUARD\n#define GUARD\n#include <stdbool.h>\n#include <stdint.h>\n{header}\n#endif\n",
            encoding="utf-8",
        )
        (self.folder / f"{name}.c").write_text(f'#include "{name}.h"\n{code}\n', encoding="utf-8")
        source = CSource(
            files=(self.folder / f"{name}.c",),
            header=self.folder / f"{name}.h",
            struct=name,
            init=f"{name}_init",
            step_function=f"{name}_step",
            step=step,
        )
        return Component(name, interface, source=source, parameters=parameters, **fields)

    def counter(self, step: float = 0.01) -> Component:
        """Counts its sample hits and adds its input up; *total* starts at *first*, or twice that after init."""
        return self.component(
            "counter",
            """
            typedef struct {
                struct { double u; } in;
                struct { int hits; double total; } out;
                struct { double first; int bias; } par;
                double sum;
            } counter;
            void counter_init(counter *c);
            void counter_step(counter *c);
            """,
            """
            void counter_init(counter *c) { c->sum += c->par.first; c->out.total = c->sum + c->in.u; }
            void counter_step(counter *c) { c->out.hits++; c->sum += c->in.u; c->out.total = c->sum + c->par.bias; }
            """,
            ports({"u": real("m")}, {"hits": INTEGER, "total": real("m")}),
            (Parameter("first", real("m"), 3.0), Parameter("bias", INTEGER, 0, tunable=False)),
            step=step,
        )

    def integrator(self) -> Component:
        """The plant x' = gain * rate, by Euler's rule."""
        return self.component(
            "integrator",
            """
            typedef struct {
                struct { double rate; } in;
                struct { double x; int steps; } out;
                struct { double gain; } par;
            } integrator;
            void integrator_init(integrator *c);
            void integrator_step(integrator *c, double h);
            """,
            """
            void integrator_init(integrator *c) { c->out.x = 1.0; }
            void integrator_step(integrator *c, double h) { c->out.x += h * c->par.gain * c->in.rate; c->out.steps++; }
            """,
            ports({"rate": real("m/s")}, {"x": real("m"), "steps": INTEGER}),
            (Parameter("gain", real(), 2.0),),
        )


@dataclass
class Slave:
    """One instance, addressed by variable names; *messages* are what it told its logger."""

    model: FmuModel
    messages: list[str] = field(default_factory=list)
    fmu: Any = None
    keep: Any = None

    def create(self, token: str | None = None) -> Slave:
        from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
        from fmpy.fmi3 import FMU3Slave

        arguments = {
            "unzipDirectory": str(self.model.folder),
            "modelIdentifier": self.model.identifier,
            "instanceName": "tested",
            "guid": token or self.model.token,
        }
        if self.model.version == 2:
            self.fmu = FMU2Slave(**arguments)
            logger = fmi2CallbackLoggerTYPE(lambda env, name, status, category, text: self.messages.append(str(text)))
            self.keep = fmi2CallbackFunctions(logger=logger)
            self.fmu.instantiate(callbacks=self.keep)
        else:
            self.fmu = FMU3Slave(**arguments)
            self.keep = lambda env, status, category, text: self.messages.append(str(text))
            self.fmu.instantiate(logMessage=self.keep)
        return self

    def enter(self, start_time: float = 0.0) -> Slave:
        if self.model.version == 2:
            self.fmu.setupExperiment(startTime=start_time)
            self.fmu.enterInitializationMode()
        else:
            self.fmu.enterInitializationMode(startTime=start_time)
        return self

    def ready(self, start_time: float = 0.0, **start: Any) -> Slave:
        """Through the initialization, with these start values."""
        for name, value in start.items():
            self.set(name, value)
        self.enter(start_time).fmu.exitInitializationMode()
        return self

    def set(self, name: str, value: Any) -> None:
        variable = self.model.variables[name]
        getattr(self.fmu, f"set{variable.fmi_type}")([variable.reference], [value])

    def get(self, name: str) -> Any:
        variable = self.model.variables[name]
        return getattr(self.fmu, f"get{variable.fmi_type}")([variable.reference])[0]

    def step(self, time: float, size: float) -> None:
        self.fmu.doStep(time, size)

    def saved(self) -> bytes:
        """The whole state, as bytes."""
        if self.model.version == 2:
            state = self.fmu.getFMUstate()
            content = bytes(self.fmu.serializeFMUstate(state))
            self.fmu.freeFMUstate(state)
            return content
        state = self.fmu.getFMUState()
        content = bytes(self.fmu.serializeFMUState(state))
        self.fmu.freeFMUState(state)
        return content

    def load(self, content: bytes) -> None:
        if self.model.version == 2:
            self.fmu.setFMUstate(self.fmu.deSerializeFMUstate(content))
        else:
            self.fmu.setFMUState(self.fmu.deserializeFMUState(content))


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One cache for all tests: what one has compiled, the others need not."""
    return tmp_path_factory.mktemp("cache")


@pytest.fixture
def workshop(tmp_path: Path) -> Workshop:
    return Workshop(tmp_path)


@pytest.fixture(params=[2, 3], ids=["fmi2", "fmi3"])
def version(request: pytest.FixtureRequest) -> int:
    value: int = request.param
    return value


@pytest.fixture
def new_slave(cache: Path, version: int) -> Iterator[Callable[[Component], Slave]]:
    """Makes instances of components; they are freed in the end."""
    made: list[Slave] = []

    def make(component: Component) -> Slave:
        model = open_fmu(build(component, version=version, cache=cache), cache=cache)
        made.append(Slave(model).create())
        return made[-1]

    yield make
    for slave in made:
        slave.fmu.freeInstance()


@dataclass
class Reader:
    """Reads texts of modelDescription.xml, as if they were in an archive called m.fmu."""

    folder: Path

    def __call__(self, text: str | bytes, interface: FmiInterface | None = None) -> Description:
        content = text.encode() if isinstance(text, str) else text
        (self.folder / "modelDescription.xml").write_bytes(content)
        return read_description(self.folder, "m.fmu", interface=interface)

    def problems(self, text: str | bytes, interface: FmiInterface | None = None) -> list[str]:
        """What is told of a description that is refused: ``LINE: what``, in the file's order."""
        with pytest.raises(DseError) as caught:
            self(text, interface)
        assert {p.where.file for p in caught.value.problems if p.where} == {"m.fmu/modelDescription.xml"}
        return [f"{problem.where.line if problem.where else 0}: {problem.what}" for problem in caught.value.problems]


@pytest.fixture
def described(tmp_path: Path) -> Reader:
    return Reader(tmp_path)
