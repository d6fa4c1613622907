"""`isolate: true`: each instance of an FMU has a process of its own."""

from __future__ import annotations

import multiprocessing
import signal
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import psutil
import pytest
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import Host, Special
from dse.errors import DseError, Location
from dse.fmu.toolchain.compiler import find_compiler
from dse.fmu.unpack import isolated

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="FMUs are isolated on Linux only")
WHERE = Location("components/part/component.yaml", 4)
STEP_ERROR, CRASH = 1, 6
SOURCES = Path(__file__).parent / "fmus"


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


def hosts() -> list[psutil.Process]:
    return [p for p in psutil.Process().children(recursive=True) if p.name() == "host"]


@pytest.mark.parametrize("version", [2, 3])
def test_two_instances_of_an_fmu_that_can_live_once_in_a_process(shelf, cache, version):
    once = shelf.fmu("gain", version, "-DONCE")
    wires, start = ["a.y -> b.u"], {"a.c": 3.0, "b.k": 2.0}
    with pytest.raises(DseError, match="can be instantiated only once per process") as refused:
        Simulator(shelf.system({"a": once, "b": once}, wires, start, ["b.y"]), ["b.y"])
    assert "`isolate: true`" in str(refused.value)
    apart = isolated(once, WHERE, cache)
    system = shelf.system({"a": apart, "b": apart}, wires, start, ["b.y"])
    several = shelf.fmu("gain", version)
    expected = run_reference(
        shelf.system({"a": several, "b": several}, wires, start, ["b.y"]), ["b.y"], stop=1, step=0.25
    )
    with Simulator(system, ["b.y"]) as simulator:
        for _ in range(3):
            assert simulator.run(stop=1, step=0.25).tobytes() == expected.tobytes()
        assert len(hosts()) == 2
    assert hosts() == []


def test_what_an_isolated_fmu_says_is_told_as_usual(shelf, cache):
    model = isolated(shelf.fmu("faulty", 2), WHERE, cache)
    system = shelf.system({"world": model}, [], {"world.mode": STEP_ERROR, "world.at": 0.5}, ["world.y"])
    with Simulator(system, ["world.y"]) as simulator, pytest.raises(RunFailed) as failed:
        simulator.run(stop=1, step=0.25)
    assert str(failed.value) == "world: fmi2DoStep at t = 0.5 s returned error: tyre left the road 42"


def test_a_wrong_environment_is_no_crash_behind_a_bridge_either(shelf, cache):
    astray = isolated(shelf.fmu("faulty", 2, "-DASTRAY"), WHERE, cache)
    system = shelf.system({"world": astray}, [], {"world.mode": STEP_ERROR}, ["world.y"])
    with Simulator(system, ["world.y"]) as simulator, pytest.raises(RunFailed, match="tyre left the road 42"):
        simulator.run(stop=1, step=0.25)


def crash(system) -> None:
    with Simulator(system, ["world.y"]) as simulator:
        simulator.run(stop=1, step=0.25)


def test_a_crash_ends_the_worker_as_that_of_any_fmu_does(shelf, cache):
    model = isolated(shelf.fmu("faulty", 2), WHERE, cache)
    system = shelf.system({"world": model}, [], {"world.mode": CRASH, "world.at": 0.5}, ["world.y"])
    worker = multiprocessing.get_context("fork").Process(target=crash, args=(system,))
    worker.start()
    worker.join(60)
    assert worker.exitcode == -signal.SIGABRT


def test_what_cannot_be_isolated_is_refused_by_name(shelf, cache):
    model = shelf.fmu("gain", 2)
    for other, why in (
        (replace(model, version=1), "that is supported for FMI 2.0 and 3.0 only"),
        (replace(model, host=Host(("wine",), is_wine=True)), "it has another process already"),
    ):
        with pytest.raises(DseError, match=why) as refused:
            isolated(other, WHERE, cache)
        assert str(WHERE) in str(refused.value)


def test_a_library_that_cannot_be_loaded_is_named_with_the_reason(shelf, cache, tmp_path):
    broken = tmp_path / "broken.so"
    broken.write_bytes(b"no library")
    model = isolated(replace(shelf.fmu("gain", 2), library=broken), WHERE, cache)
    with pytest.raises(DseError, match=r"cannot be loaded: .*broken.so: file too short"):
        Simulator(shelf.system({"a": model}, record=["a.y"]), ["a.y"])


def test_a_library_may_use_mathematics_without_naming_its_library(shelf, cache, tmp_path):
    model = replace(shelf.fmu("gain", 2), library=tmp_path / "unnamed.so")
    made = ["-shared", "-fPIC", "-DFMI=2", "-DIDENTIFIER=gain", "-DROOT", str(SOURCES / "gain.c")]
    subprocess.run([*find_compiler().command, *made, "-o", str(model.library)], check=True)
    system = shelf.system({"a": isolated(model, WHERE, cache)}, start={"a.u": 9.0}, record=["a.y"])
    with Simulator(system, ["a.y"]) as simulator:
        assert simulator.run(stop=1, step=0.5)[-1].tolist() == [3.0]


def test_isolation_is_part_of_how_an_fmu_is_known(shelf, cache):
    model = isolated(shelf.fmu("gain", 2, "-DONCE"), WHERE, cache)
    assert model.special == {Special.ISOLATED}
    assert model.manner == "CoSimulation-isolated"
    assert not model.capabilities.once_per_process
