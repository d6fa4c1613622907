"""What an archive made of Modelica tells and keeps: its description, its states, the bits of its numbers."""

from __future__ import annotations

import struct
import xml.etree.ElementTree as ET
from pathlib import Path

import compile_cache
import pytest
from language_case import CASES
from modelica_components import Built, component
from slaves import Rows, Slave, instance, run_cs

from dse.fmu.component_build import build
from dse.fmu.unpack import open_fmu

both_versions = pytest.mark.parametrize(
    "version", [2, pytest.param(3, marks=pytest.mark.thorough)], ids=["fmi2", "fmi3"]
)
WITH_MEMORY = (
    *("BouncingBall", "SampledController", "StateMachine", "DiscreteFeedback", "IdealDiode", "VanDerPol"),
    "PendulumGoesRound",
)
RUN_TWICE = ("SampledController", "IdealDiode", "MathFunctions", "Tables2D", "Pendulum", "StiffDecay")


def case(name: str) -> Path:
    return CASES / f"{name}.mo"


@both_versions
def test_units_limits_starts_and_texts_are_in_the_description(version: int, built: Built) -> None:
    model = built(case("TypesAndUnits"), version)
    root = ET.parse(model.folder / "modelDescription.xml").getroot()  # noqa: S314  # written by the build itself
    assert root.get("description") == "torque of a machine"
    found = {}
    for variable in root.find("ModelVariables") or ():
        attributes = dict(variable.attrib)
        for child in variable:
            attributes |= child.attrib
        found[attributes["name"]] = attributes
    demand, efficiency, speed = found["demand"], found["efficiency"], found["speed"]
    assert (demand["causality"], demand["unit"], float(demand["start"])) == ("input", "N.m", 50.0)
    assert [float(demand[key]) for key in ("min", "max", "nominal")] == [0.0, 500.0, 100.0]
    assert demand["description"] == "what is asked for"
    assert (efficiency["causality"], efficiency["variability"]) == ("parameter", "tunable")
    assert [float(efficiency[key]) for key in ("min", "max", "start")] == [0.0, 0.99, 0.9]
    assert (speed["causality"], speed["unit"], speed.get("initial", "calculated")) == ("output", "rad/s", "calculated")
    assert found["torque"]["description"] == "what is given"
    assert {unit.get("name") for unit in root.iter("Unit")} >= {"N.m", "rad/s"}


@both_versions
def test_a_dependent_parameter_cannot_be_set_and_is_called_calculated(version: int, built: Built) -> None:
    model = built(case("DependentParameters"), version)
    causalities = {name: model.variables[name].causality for name in ("radius", "middle", "last", "list[2]")}
    assert causalities["radius"] == "parameter"
    assert {causalities[name] for name in ("middle", "last", "list[2]")} == {"calculatedParameter"}


def saved(slave: Slave) -> bytes:
    if slave.model.version == 2:
        state = slave.fmu.getFMUstate()
        content = bytes(slave.fmu.serializeFMUstate(state))
        slave.fmu.freeFMUstate(state)
        return content
    state = slave.fmu.getFMUState()
    content = bytes(slave.fmu.serializeFMUState(state))
    slave.fmu.freeFMUState(state)
    return content


def load(slave: Slave, content: bytes) -> None:
    if slave.model.version == 2:
        slave.fmu.setFMUstate(slave.fmu.deSerializeFMUstate(content))
    else:
        slave.fmu.setFMUState(slave.fmu.deserializeFMUState(content))


@pytest.mark.sampled(3)
@both_versions
@pytest.mark.parametrize("name", WITH_MEMORY)
def test_a_saved_state_goes_on_as_if_nothing_had_happened(name: str, version: int, built: Built) -> None:
    model = built(case(name), version)
    outputs = [v.name for v in model.variables.values() if v.causality == "output"]

    def later(slave: Slave) -> Rows:
        rows = []
        for k in range(6, 14):
            slave.fmu.doStep(k * 0.09, 0.09)
            rows.append(slave.values(outputs))
        return rows

    with instance(model) as first, instance(model) as second:
        first.start({}, None)
        for k in range(6):
            first.fmu.doStep(k * 0.09, 0.09)
        content = saved(first)
        straight = later(first)
        load(first, content)
        assert later(first) == straight
        second.start({}, None)
        load(second, content)
        assert later(second) == straight


@both_versions
def test_ticks_are_counted_from_the_start_that_the_importer_gives(version: int, built: Built) -> None:
    with instance(built(case("SampleFromStart"), version)) as slave:
        slave.start({}, None, time=2.05)
        counts = []
        for k in range(5):
            slave.fmu.doStep(2.05 + k * 0.08, 0.08)
            counts.append(slave.get("count"))
        assert counts == [0, 1, 1, 2, 2]
        assert slave.get("at") == pytest.approx(2.35, abs=1e-12)


@pytest.mark.sampled(6)
@pytest.mark.parametrize("name", RUN_TWICE)
@pytest.mark.thorough
def test_the_optimizer_changes_no_bit(name: str, built: Built, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    quick = built(case(name), 2)
    monkeypatch.setenv(compile_cache.OPTIMIZED, "1")
    optimized = open_fmu(build(component(case(name)), cache=tmp_path), cache=tmp_path)
    assert quick.library.read_bytes() != optimized.library.read_bytes()
    outputs = [v.name for v in quick.variables.values() if v.causality == "output"]
    one, other = (run_cs(model, outputs, 14, 0.07, {}, {}, None) for model in (quick, optimized))
    assert [[struct.pack("<d", value) for value in row.values()] for row in one] == [
        [struct.pack("<d", value) for value in row.values()] for row in other
    ]


def test_a_build_does_not_depend_on_where_the_model_lies(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    archives = []
    for place in ("here", "there/and/deeper"):
        folder = tmp_path / place
        folder.mkdir(parents=True)
        file = folder / "NonlinearSystem.mo"
        file.write_bytes(case("NonlinearSystem").read_bytes())
        monkeypatch.chdir(tmp_path)
        archives.append(build(component(file), cache=tmp_path / "cache" / place))
    assert archives[0].read_bytes() == archives[1].read_bytes()
