"""Every Modelica component of the library as FMUs: valid, and the same in FMPy and in our master, FMI 2 and 3."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from slaves import instance, run_cs, run_master

from dse.domain.component import Causality, Component, Kind, ModelicaSource
from dse.loading.workspace import Workspace

LIBRARY = Workspace.around(Path(__file__).parents[2] / "components")
# By their text: to read them all takes a second whenever tests are collected.
PARTS = sorted(name for name, file in LIBRARY.component_files.items() if "kind: modelica" in file.read_text("utf-8"))
STEP, STEPS = 0.01, 300

every_part = pytest.mark.parametrize("part", PARTS, indirect=True)


@pytest.fixture
def part(request: pytest.FixtureRequest) -> Component:
    return LIBRARY.component(request.param)


def outputs_of(part: Component) -> list[str]:
    return [part.variable(p.name) for p in part.interface.ports if p.causality is Causality.OUTPUT]


def constant_inputs(part: Component) -> Mapping[str, float]:
    """A load that makes every part work: a demand of torque or power, a car that moves, a charged battery."""
    typical = {"power": 8e3, "torque": 90.0, "wheel": 40.0, "speed": 200.0, "voltage": 350.0, "soc": 0.47, "ratio": 8.0}
    given = {}
    for port in part.interface.ports:
        if port.causality is Causality.INPUT and port.type.kind is Kind.REAL:
            name = part.variable(port.name)
            given[name] = next((value for word, value in typical.items() if word in name), 1.0)
    return given


@pytest.mark.thorough
def test_the_library_has_all_its_components() -> None:
    assert len(PARTS) >= 17
    sources = {name: LIBRARY.component(name).source for name in LIBRARY.component_files}
    assert [name for name in sorted(sources) if isinstance(sources[name], ModelicaSource)] == PARTS


@pytest.mark.thorough
@every_part
@pytest.mark.parametrize("version", [2, 3], ids=["fmi2", "fmi3"])
def test_the_fmu_of_a_component_is_valid(part: Component, version: int, opened) -> None:
    from fmpy.validation import validate_fmu

    assert validate_fmu(str(opened(part, version).archive)) == []


@pytest.mark.thorough
@every_part
@pytest.mark.parametrize("version", [2, 3], ids=["fmi2", "fmi3"])
def test_a_component_runs_in_our_master_as_in_fmpy(part: Component, version: int, opened) -> None:
    model, given = opened(part, version), constant_inputs(part)
    own = run_master(model, outputs_of(part), STEPS, STEP, given)
    theirs = run_cs(model, outputs_of(part), STEPS, STEP, given, {}, None)
    assert own == theirs
    assert any(own[-1].values())  # it did something


@pytest.mark.thorough
@every_part
def test_a_component_gives_the_same_bits_in_fmi_2_and_3(part: Component, opened) -> None:
    given, names = constant_inputs(part), outputs_of(part)
    found = []
    for version in (2, 3):
        rows = []
        with instance(opened(part, version)) as slave:
            slave.start(given, None)
            for k in range(STEPS):
                for name, value in given.items():
                    slave.set(name, value * (1 + 0.2 * ((k // 20) % 2)))
                slave.fmu.doStep(k * STEP, STEP)
                rows.append(slave.values(names))
        found.append(rows)
    assert found[0] == found[1]
