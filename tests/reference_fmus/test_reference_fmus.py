"""The reference FMUs themselves, as FMPy sees them: what they are measured with must be right first."""

from __future__ import annotations

from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu

from reference_fmus import MODELS, build
from reference_fmus.cases import ALL, INTERFACES, bounce_times, names_of

ONE_OF_EACH = [(name, version, interface) for name in MODELS for version, interface in INTERFACES]


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("name", "version", "interface"), ONE_OF_EACH, ids=names_of)
def test_each_archive_is_valid_by_fmpys_measure(
    name: str, version: int, interface: str | None, reference_folder: Path
) -> None:
    assert validate_fmu(str(build(name, version, interface, reference_folder))) == []


@pytest.mark.sampled(2)
@pytest.mark.parametrize("version", [1, 2, 3])
@pytest.mark.usefixtures("real_compiler")
def test_the_same_model_gives_the_same_bytes(version: int, tmp_path: Path) -> None:
    archives = [build("Feedthrough", version, "CoSimulation", tmp_path / folder) for folder in ("one", "two")]
    assert archives[0].read_bytes() == archives[1].read_bytes()


@pytest.mark.parametrize(("name", "version", "interface"), [c for c in ALL if c[0] == "Dahlquist"], ids=names_of)
def test_fmpy_finds_the_exponential(name: str, version: int, interface: str, reference_folder: Path) -> None:
    archive = build(name, version, interface, reference_folder)
    found = fmpy.simulate_fmu(
        str(archive),
        fmi_type=interface,
        stop_time=5,
        output_interval=0.1,
        start_values={"k": 2},
        relative_tolerance=1e-8,
    )
    # Runge-Kutta of order 4 with h = 0.01: k^5 h^4 t exp(-k t) / 120 < 1e-9; CVode keeps to its own tolerance.
    assert found["x"] == pytest.approx(np.exp(-2 * found["time"]), abs=1e-8 if interface == "CoSimulation" else 1e-6)


@pytest.mark.parametrize(("version", "interface"), [(v, i) for v, i in INTERFACES if i], ids=names_of)
def test_fmpy_sees_the_ball_bounce_until_it_rests(version: int, interface: str, reference_folder: Path) -> None:
    archive = build("BouncingBall", version, interface, reference_folder)
    found = fmpy.simulate_fmu(str(archive), fmi_type=interface, stop_time=3, output_interval=0.01)
    times = bounce_times()
    assert found["bounces"][-1] == len(times)
    # Where FMPy records both sides of an event, the later one counts.
    late = [np.flatnonzero(found["time"] > t)[0] for t in times]
    assert found["bounces"][late].tolist() == list(range(1, len(times) + 1))
    assert (found["resting"] == (found["bounces"] == len(times))).all()


def test_a_call_at_the_wrong_time_is_refused_with_a_reason(reference_folder: Path) -> None:
    archive = build("Dahlquist", 2, "CoSimulation", reference_folder)
    unpacked = fmpy.extract(str(archive), str(reference_folder / "by_hand"))
    description = fmpy.read_model_description(unpacked)
    said: list[str] = []
    # FMPy prints log messages with C's printf unless it is given a logger of its own.
    logger = fmpy.fmi2.fmi2CallbackLoggerTYPE(lambda _, name, status, category, text: said.append(category.decode()))
    callbacks = fmpy.fmi2.fmi2CallbackFunctions()
    callbacks.logger = logger
    callbacks.allocateMemory = fmpy.fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.fmi2.calloc)
    callbacks.freeMemory = fmpy.fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.fmi2.free)
    slave = fmpy.fmi2.FMU2Slave(
        guid=description.guid, unzipDirectory=unpacked, modelIdentifier="Dahlquist", instanceName="d"
    )
    slave.instantiate(callbacks=callbacks)
    try:
        with pytest.raises(fmpy.fmi1.FMICallException):
            slave.enterInitializationMode()
        slave.setupExperiment(startTime=0)
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        with pytest.raises(fmpy.fmi1.FMICallException):
            slave.setReal([3], [2.0])
        with pytest.raises(fmpy.fmi1.FMICallException):
            slave.doStep(0.5, 0.1)
        slave.doStep(0.0, 0.1)
    finally:
        slave.freeInstance()
    assert said == ["logStatusError"] * 3
