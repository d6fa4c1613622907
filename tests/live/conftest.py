"""Components of the kind udp, and the two halves of a system that they join."""

from __future__ import annotations

import gc
import re
import shutil
import socket
import subprocess
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

CLIENTS = Path(__file__).parents[2] / "clients"
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


@pytest.fixture(scope="session")
def unity_world(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The scene of the README of clients/unity, against the signatures of Unity."""
    compiler, runtime = shutil.which("mcs"), shutil.which("mono")
    if not (compiler and runtime):
        pytest.skip("no C# compiler: mcs and mono of the packages mono-mcs and mono-runtime")
    folder, package = tmp_path_factory.mktemp("unity"), CLIENTS / "unity"
    (code,) = re.findall(r"```csharp\n(.*?)```", (package / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    (folder / "Outside.cs").write_text(re.sub("(?m)^   ", "", code), encoding="utf-8")
    stubs = Path(__file__).parent / "unity"
    sources = [*sorted((package / "Runtime").glob("*.cs")), *sorted(stubs.glob("*.cs")), folder / "Outside.cs"]
    options = ["-langversion:7", "-warnaserror", "-nowarn:0649", f"-out:{folder / 'Scene.exe'}"]
    subprocess.run([compiler, *options, *map(str, sources)], check=True)
    return [runtime, str(folder / "Scene.exe")]


@pytest.fixture(scope="session")
def godot_world(tmp_path_factory: pytest.TempPathFactory) -> list[str]:
    """The example of clients/godot in Godot 3; another script can take the place of the last word."""
    godot = shutil.which("godot3-server")
    if not godot:
        pytest.skip("no Godot 3: godot3-server")
    project = tmp_path_factory.mktemp("godot") / "project"
    shutil.copytree(CLIENTS / "godot", project)
    shutil.copytree(Path(__file__).parent / "godot", project, dirs_exist_ok=True)
    return [godot, "--path", str(project), "-s", "run.gd"]
