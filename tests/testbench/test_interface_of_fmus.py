"""A component with an existing FMU says by which interface it is simulated."""

from __future__ import annotations

import math
import sys
from pathlib import Path

import pytest
from reference_fmus import build

from dse.domain.fmu import FmiInterface, FmuModel
from dse.domain.run import RunRequest
from dse.errors import DseError
from dse.fmu import build as build_component, open_component
from dse.interchange.importing.component import import_component
from dse.loading.workspace import Workspace
from dse.testbench.check import check_workspace
from dse.testbench.runner import Runner
from dse.testbench.study import bench_study, prepare_study

FILE = "components/decay/component.yaml"
BENCH = """\
testbench: decaying
design: alone
simulation: {stop: 2 s, step: 2 s, tolerance: TOLERANCE}
metrics: {end: final(part.x)}
"""


def laid_out(
    folder: Path, interface: str, *, fmu: str | None = None, version: int = 3, tolerance: float = 1e-6
) -> Path:
    """A workspace with one part; *interface* is what its source says besides the file."""
    imported = import_component(build("Dahlquist", version, fmu, folder), folder, "decay")
    text = imported.path.read_text(encoding="utf-8")
    imported.path.write_text(text.replace("file: decay.fmu", f"file: decay.fmu{interface}"), encoding="utf-8")
    texts = {
        "designs/alone.yaml": "design: alone\nroot: {compound: {part: decay}}\n",
        "testbenches/decaying.yaml": BENCH.replace("TOLERANCE", str(tolerance)),
    }
    for name, text in texts.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


def opened(folder: Path, name: str) -> FmuModel:
    component = Workspace(folder).component(name)
    return open_component(component, build_component(component))


def simulated(folder: Path):
    ((identity, prepared),) = prepare_study(bench_study(Workspace(folder).bench("decaying"))).benches.items()
    with Runner(prepared) as runner:
        (element,) = prepared.system.elements
        return element.model.interface, runner.run(RunRequest(0, identity, {}), keep=False).metrics["end"]


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ("", FmiInterface.CO_SIMULATION),
        (", interface: co_simulation", FmiInterface.CO_SIMULATION),
        (", interface: model_exchange", FmiInterface.MODEL_EXCHANGE),
    ],
)
def test_an_fmu_that_has_both_is_simulated_as_its_component_says(tmp_path, version, said, expected):
    interface, end = simulated(laid_out(tmp_path, said, version=version))
    assert interface is expected
    assert end == pytest.approx(math.exp(-2.0), rel=1e-5)


def test_what_is_integrated_here_is_as_exact_as_the_bench_says(tmp_path):
    errors = []
    for tolerance in (1e-3, 1e-10):
        folder = tmp_path / f"{tolerance:g}"
        folder.mkdir()
        _, end = simulated(laid_out(folder, ", interface: model_exchange", tolerance=tolerance))
        errors.append(abs(end - math.exp(-2.0)))
    assert errors[1] < 1e-8 < errors[0]


@pytest.mark.parametrize(
    ("interface", "fmu", "version", "what"),
    [
        ("model_exchange", "CoSimulation", 2, "the FMU is not for model exchange, only for co-simulation"),
        ("co_simulation", "ModelExchange", 3, "the FMU is not for co-simulation, only for model exchange"),
        ("model_exchange", "CoSimulation", 1, "model exchange of FMI 1.0 is not supported"),
    ],
)
def test_what_the_fmu_does_not_have_is_refused_where_it_is_asked_for(tmp_path, interface, fmu, version, what):
    folder = laid_out(tmp_path, f", interface: {interface}", fmu=fmu, version=version)
    (problem,) = check_workspace(Workspace(folder))[0]
    line = (
        (folder / FILE)
        .read_text(encoding="utf-8")
        .splitlines()
        .index(f"source: {{kind: fmu, file: decay.fmu, interface: {interface}}}")
    )
    assert f"{FILE}:{line + 1}:" in str(problem.where)
    assert "component 'decay'" in problem.what
    assert what in problem.what
    with pytest.raises(DseError, match=what):
        simulated(folder)


def test_a_word_that_is_none_is_refused(tmp_path):
    folder = laid_out(tmp_path, ", interface: model_exchang")
    (problem, *_) = check_workspace(Workspace(folder))[0]
    assert problem.what == "'model_exchang' is none of co_simulation, model_exchange"
    assert "did you mean 'model_exchange'?" in problem.hint


def test_event_mode_can_be_switched_off(tmp_path):
    imported = import_component(build("BouncingBall", 3, None, tmp_path), tmp_path, "ball")
    usual = opened(tmp_path, "ball")
    text = imported.path.read_text(encoding="utf-8")
    imported.path.write_text(text.replace("ball.fmu", "ball.fmu, event_mode: off"), encoding="utf-8")
    without = opened(tmp_path, "ball")
    assert (usual.ticks, without.ticks) == (True, False)
    assert (usual.manner, without.manner) == ("CoSimulation", "CoSimulation-no_event_mode")


@pytest.mark.skipif(sys.platform != "linux", reason="FMUs are isolated on Linux only")
def test_a_component_has_its_fmu_isolated_with_the_same_result(tmp_path):
    ends = []
    for said in ("", ", isolate: true"):
        folder = tmp_path / f"said{len(said)}"
        folder.mkdir()
        ends.append(simulated(laid_out(folder, said, version=2)))
    assert ends[0] == ends[1]
    assert opened(folder, "decay").manner == "CoSimulation-isolated"


@pytest.mark.skipif(sys.platform != "linux", reason="FMUs are isolated on Linux only")
def test_an_fmu_that_cannot_be_isolated_is_refused_where_that_is_asked_for(tmp_path):
    folder = laid_out(tmp_path, ", isolate: true", fmu="CoSimulation", version=1)
    (problem,) = check_workspace(Workspace(folder))[0]
    assert problem.what.endswith("it cannot be isolated: that is supported for FMI 2.0 and 3.0 only")
    assert FILE in str(problem.where)


@pytest.mark.parametrize(("version", "interface"), [(2, ""), (3, ", interface: model_exchange")])
def test_event_mode_that_there_is_none_of_cannot_be_switched_off(tmp_path, version, interface):
    folder = laid_out(tmp_path, f"{interface}, event_mode: off", version=version)
    (problem,) = check_workspace(Workspace(folder))[0]
    assert problem.what.endswith("the FMU has no event mode that could be off")
    assert FILE in str(problem.where)
    with pytest.raises(DseError, match="no event mode that could be off"):
        simulated(folder)
