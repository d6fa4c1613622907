"""Components of the kind udp, and the two halves of a system that they join."""

from __future__ import annotations

import gc
import socket
import threading
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path

import pytest

from dse.cosim import Simulator
from dse.domain.component import Causality, Component, Interface, Kind, Parameter, Port, Type
from dse.domain.fmu import FmuModel
from dse.domain.system import Element, SystemStructure
from dse.domain.udp import LINK, UdpSource
from dse.fmu import build, open_fmu
from dse.units import parse_unit

REAL = Type(Kind.REAL)
_OPENED = Path("/proc/self/fd")
COUNTED = tuple(
    Port(name, Causality.OUTPUT, Type(Kind.REAL, parse_unit("s")) if name == LINK[-1] else REAL) for name in LINK
)


def outside(
    source: UdpSource,
    cache: Path,
    inputs: Sequence[str | Port] = (),
    outputs: Sequence[str | Port] = (),
    parameters: Sequence[Parameter] = (),
    version: int = 2,
) -> FmuModel:
    """The FMU of a component of the kind udp; ports that are names only are real numbers."""
    named = [(Causality.INPUT, port) for port in inputs] + [(Causality.OUTPUT, port) for port in outputs]
    ports = tuple(port if isinstance(port, Port) else Port(port, way, REAL) for way, port in named)
    component = Component("outside", Interface("outside", ports), source=source, parameters=tuple(parameters))
    return open_fmu(build(component, version=version, cache=cache), cache=cache)


def alone(model: FmuModel, start: dict[str, float] | None = None) -> SystemStructure:
    """A system of that FMU alone, ``it``."""
    outputs = tuple(v for v in model.variables.values() if v.causality == "output")
    return SystemStructure("alone", (Element("it", model, (), outputs, start or {}),), ())


def simulator_of(model: FmuModel, start: dict[str, float] | None = None) -> Simulator:
    """A simulator of that FMU alone, which records all outputs."""
    system = alone(model, start)
    return Simulator(system, [f"it.{variable.name}" for variable in system.elements[0].outputs])


@pytest.fixture(autouse=True)
def _nothing_stays_open() -> Iterator[None]:
    """Fail the test that leaves a socket open or a thread running: the next one at the port would not be to blame."""
    sockets, threads = open_sockets(), set(threading.enumerate())
    yield
    if open_sockets() - sockets:
        gc.collect()  # one that nobody has any more warns of itself, and that fails this test, too
    running = [thread.name for thread in set(threading.enumerate()) - threads]
    assert (open_sockets() - sockets, running) == (set(), [])


def open_sockets() -> set[str]:
    """Those of this process, by their numbers in the system; none where it does not say."""
    found = set()
    for opened in _OPENED.iterdir() if _OPENED.is_dir() else ():
        with suppress(OSError):  # closed since
            found.add(str(opened.readlink()))
    return {name for name in found if name.startswith("socket:")}


@pytest.fixture(scope="session")
def port() -> int:
    """A port that nobody listens at but tests one after another: it is compiled in."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as found:
        found.bind(("127.0.0.1", 0))
        number: int = found.getsockname()[1]
        return number


@pytest.fixture(scope="session")
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("live")
