"""What FMUs of other programs are found to have, given to FMUs that are right apart from that."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import FmiInterface, FmuModel
from dse.errors import DseError
from dse.fmu.unpack import open_fmu
from reference_fmus import build
from reference_fmus.systems import system_of

Foreign = Callable[..., FmuModel]
NAME = "modelDescription.xml"


@pytest.fixture
def foreign(reference_folder: Path, tmp_path: Path) -> Foreign:
    """Opens a reference FMU whose description has been changed: each *old* text in it by the *new* one."""

    def open_changed(name: str, version: int, interface: str | None, *changes: tuple[str, str]) -> FmuModel:
        archive = tmp_path / f"{name}.fmu"
        with (
            zipfile.ZipFile(build(name, version, interface, reference_folder)) as right,
            zipfile.ZipFile(archive, "w") as changed,
        ):
            for entry in right.namelist():
                content = right.read(entry)
                if entry == NAME:
                    text = content.decode()
                    for old, new in changes:
                        assert old in text
                        text = text.replace(old, new)
                    content = text.encode()
                changed.writestr(entry, content)
        return open_fmu(archive, cache=reference_folder / "cache")

    return open_changed


def waveforms(model: FmuModel, record: tuple[str, ...], **start: float) -> np.ndarray:
    given = {f"world.{name}": value for name, value in start.items()}
    system = system_of({"world": model}, record=record, start=given)
    with Simulator(system, record) as simulator:
        return simulator.run(stop=1.0, step=0.125)


TOOL = ("<CoSimulation ", '<CoSimulation needsExecutionTool="true" ')


@pytest.mark.parametrize("version", [2, 3])
def test_an_fmu_that_says_it_needs_a_tool_is_simulated_if_the_tool_is_there(version: int, foreign: Foreign) -> None:
    # PythonFMU and UniFMU write this of what needs nothing but Python.
    model = foreign("Dahlquist", version, "CoSimulation", TOOL)
    assert model.capabilities.needs_tool
    found = waveforms(model, ("world.x",))
    assert np.array_equal(found, waveforms(foreign("Dahlquist", version, "CoSimulation"), ("world.x",)))


def test_that_it_needs_a_tool_is_told_of_an_fmu_that_cannot_be_instantiated(foreign: Foreign) -> None:
    without = ('guid="{', 'guid="{0')
    for changes, ending in (
        ((without,), "fmi2Instantiate returned no instance"),
        ((without, TOOL), "fmi2Instantiate returned no instance, and the FMU declares that it needs another program"),
    ):
        system = system_of({"world": foreign("Dahlquist", 2, "CoSimulation", *changes)}, record=["world.x"])
        with pytest.raises(RunFailed) as kernel, Simulator(system, ["world.x"]) as simulator:
            simulator.run(stop=1.0, step=0.125)
        with pytest.raises(RunFailed) as reference:
            run_reference(system, ["world.x"], stop=1.0, step=0.125)
        assert kernel.value.what == reference.value.what == f"world: {ending}"


def test_model_exchange_is_used_where_only_its_library_is_there(foreign: Foreign) -> None:
    other = '<CoSimulation canHandleVariableCommunicationStepSize="true" modelIdentifier="'
    model = foreign("Dahlquist", 2, None, (other, f"{other}its_tool_"))
    assert model.interface is FmiInterface.MODEL_EXCHANGE
    times = np.arange(9) * 0.125
    # The solver's tolerance is 1e-6 if the FMU says none; its error grows to at most some of those.
    assert np.abs(waveforms(model, ("world.x",))[:, 0] - np.exp(-times)).max() < 1e-5
    with pytest.raises(DseError, match="no library 'its_tool_Dahlquist"):
        foreign("Dahlquist", 2, "CoSimulation", (other, f"{other}its_tool_"))


def test_what_is_said_wrongly_of_dependencies_changes_no_waveform(foreign: Foreign) -> None:
    wrong = foreign("Dahlquist", 2, "CoSimulation", ('<Unknown index="2" dependencies=""/>', '<Unknown index="77"/>'))
    assert wrong.depends == {}
    right = foreign("Dahlquist", 2, "CoSimulation")
    assert right.depends == {"x": ()}
    assert np.array_equal(waveforms(wrong, ("world.x",)), waveforms(right, ("world.x",)))


_SECOND = '<ScalarVariable name="second" valueReference="1" causality="input"><Real start="0"/></ScalarVariable>'
SECOND = ("</ModelVariables>", f"{_SECOND}</ModelVariables>")


def test_an_input_may_have_two_names_but_not_two_wires(foreign: Foreign) -> None:
    model = foreign("Feedthrough", 2, "CoSimulation", SECOND)
    output = ("world.Float64_continuous_output",)
    assert waveforms(model, output, second=2.5)[-1, 0] == 2.5
    assert waveforms(model, output, Float64_continuous_input=1.5)[-1, 0] == 1.5
    wires = [f"a.Float64_continuous_output -> b.{name}" for name in ("second", "Float64_continuous_input")]
    with pytest.raises(DseError) as caught:
        Simulator(system_of({"a": model, "b": model}, wires), [])
    told = "wires end at b.Float64_continuous_input and b.second, which are two names of one input"
    assert [problem.what for problem in caught.value.problems] == [told]


@pytest.mark.parametrize("interface", ["CoSimulation", "ModelExchange"])
def test_arrays_may_be_empty(interface: str, foreign: Foreign) -> None:
    model = foreign("StateSpace", 3, interface)
    # Without inputs x' = x from 1, 2, 3; the outputs are the states.
    found = waveforms(model, ("world.y[1]", "world.y[3]"), m=0)
    times = np.arange(9) * 0.125
    # What the solver may leave by its default tolerance; the FMU's own steps are so short that they leave less.
    assert np.abs(found / np.exp(times)[:, None] - [1.0, 3.0]).max() < 1e-6
    # Without states y = u, which is 1, 2, 3 by itself.
    assert waveforms(model, ("world.y[1]",), n=0)[:, 0].tolist() == [1.0] * 9
    assert waveforms(model, ("world.y[1]",), m=0, n=0)[:, 0].tolist() == [0.0] * 9
