"""``dse import fmu``: an existing FMU becomes a component that works at once."""

from __future__ import annotations

import os
import zipfile
from functools import partial
from pathlib import Path

import pytest
from command_line import run_dse
from reference_fmus import MODELS, build

from dse.domain.component import Causality, Kind
from dse.domain.labels import array_of
from dse.errors import DseError
from dse.interchange.importing.component import import_component, name_of
from dse.loading.workspace import Workspace
from dse.testbench.check import check_workspace
from dse.testbench.study import bench_study, prepare_study


def workspace(folder: Path) -> Workspace:
    return Workspace(folder)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("version", [2, 3])
def test_every_reference_fmu_becomes_a_component_without_a_problem(tmp_path, version):
    for model in MODELS:
        imported = import_component(build(model, version, None, tmp_path), tmp_path / "w")
        assert imported.path.is_file()
    problems, counts = check_workspace(workspace(tmp_path / "w"))
    assert problems == []
    assert counts["component"] == len(MODELS)


def test_the_component_reads_back_as_it_was_offered(tmp_path):
    imported = import_component(build("Feedthrough", 3, "CoSimulation", tmp_path), tmp_path / "w", "relay")
    read = workspace(tmp_path / "w").component("relay")
    assert {p.name: (p.causality, p.type) for p in read.interface.ports} == {
        p.name: (p.causality, p.type) for p in imported.component.interface.ports
    }
    assert {p.name: (p.type, p.start, p.tunable) for p in read.parameters} == {
        p.name: (p.type, p.start, p.tunable) for p in imported.component.parameters
    }
    assert read.names == imported.component.names
    assert read.title == imported.component.title


def test_strings_and_binaries_are_ports(tmp_path):
    imported = import_component(build("Feedthrough", 3, "CoSimulation", tmp_path), tmp_path / "w")
    assert imported.left_out == ()
    types = {port.name: str(port.type) for port in imported.component.interface.ports}
    assert (types["Binary_input"], types["String_output"]) == ("binary", "string")
    assert [p.name for p in imported.component.parameters if p.type.kind is Kind.TEXT] == ["text_parameter"]


def test_arrays_are_arrays_of_ports(tmp_path):
    imported = import_component(build("Feedthrough", 3, "CoSimulation", tmp_path), tmp_path / "w")
    assert "Float64_array_input[2,3]" in {port.name for port in imported.component.interface.ports}
    assert "Float64_array_input" not in imported.component.names
    written = (imported.path.parent / "interfaces.yaml").read_text(encoding="utf-8")
    assert 'Float64_array_input: "1[' in written


def test_a_second_fmu_with_the_same_ports_implements_the_same_interface(tmp_path):
    first = import_component(build("VanDerPol", 2, None, tmp_path), tmp_path / "w")
    second = import_component(build("VanDerPol", 3, None, tmp_path), tmp_path / "w")
    assert first.has_own_interface
    assert not second.has_own_interface
    assert second.component.interface.name == first.component.interface.name


def test_an_interface_with_fewer_outputs_in_another_spelling_is_found(tmp_path):
    folder = tmp_path / "w" / "components"
    folder.mkdir(parents=True)
    (folder / "interfaces.yaml").write_text("interfaces: {oscillator: {outputs: {x: {_0: '1'}}}}\n")
    imported = import_component(build("VanDerPol", 2, "CoSimulation", tmp_path), tmp_path / "w", "x")
    assert imported.component.interface.name == "oscillator"
    assert imported.component.names == {"x._0": "x0"}
    assert imported.left_out == ("x1: an output that oscillator does not have",)
    assert check_workspace(workspace(tmp_path / "w"))[0] == []


def test_an_interface_without_inputs_of_the_fmu_is_not_taken(tmp_path):
    folder = tmp_path / "w" / "components"
    folder.mkdir(parents=True)
    (folder / "interfaces.yaml").write_text("interfaces: {blub: {outputs: {Int32_output: int}}}\n")
    imported = import_component(build("Feedthrough", 2, "CoSimulation", tmp_path), tmp_path / "w", "x")
    assert imported.has_own_interface
    assert imported.component.interface.name == "x"
    inputs = [p.name for p in imported.component.interface.ports if p.causality is Causality.INPUT]
    assert "Float64_continuous_input" in inputs
    assert not set(inputs) & {p.name for p in imported.component.parameters}
    wholes = dict.fromkeys(array_of(name) or name for name in inputs)
    assert [start.partition(":")[0] for start in imported.starts] == list(wholes)


def test_nothing_is_overwritten(tmp_path):
    file = build("Stair", 2, "CoSimulation", tmp_path)
    import_component(file, tmp_path / "w", "stair")
    with pytest.raises(DseError, match="already exists"):
        import_component(file, tmp_path / "w", "stair")


def test_a_file_that_is_no_fmu_leaves_nothing_behind(tmp_path):
    file = tmp_path / "x.fmu"
    file.write_bytes(b"no zip")
    with pytest.raises(DseError, match="not a complete zip file"):
        import_component(file, tmp_path / "w")
    assert not (tmp_path / "w").exists()


@pytest.mark.parametrize("name", ["2nd", "a b", "absent", "../x", ""])
def test_a_name_that_is_none_is_refused(tmp_path, name):
    with pytest.raises(DseError):
        import_component(build("Stair", 2, "CoSimulation", tmp_path), tmp_path / "w", name)
    assert not (tmp_path / "w").exists()


@pytest.mark.parametrize(
    ("file", "name"),
    [
        ("Supplier Radar-2.fmu", "supplier_radar_2"),
        ("BouncingBall.fmu", "bouncing_ball"),
        ("77GHz.fmu", "fmu_77ghz"),
        ("ä.fmu", "fmu"),
    ],
)
def test_a_name_is_made_of_the_files(file, name):
    assert name_of(Path(file)) == name


def test_check_tells_of_a_map_to_what_the_fmu_does_not_have(tmp_path):
    imported = import_component(build("VanDerPol", 2, "CoSimulation", tmp_path), tmp_path / "w", "vdp")
    text = imported.path.read_text(encoding="utf-8")
    imported.path.write_text(text + "map: {x0: x9}\n", encoding="utf-8")
    (problem,) = check_workspace(workspace(tmp_path / "w"))[0]
    assert "the FMU of vdp has no variable 'x9'" in problem.what


def test_check_tells_of_fmus_that_do_not_bear_the_algorithm(tmp_path):
    import_component(build("VanDerPol", 1, "CoSimulation", tmp_path), tmp_path, "vdp")  # FMI 1.0 cannot save its state
    lay_out(tmp_path, "adaptive: {},")
    (problem,) = check_workspace(workspace(tmp_path))[0]
    assert problem.what == "oscillator: an adaptive step takes steps back, but VanDerPol cannot save its state"
    assert str(problem.where).endswith("oscillating.yaml:3:1")


def test_an_fmu_for_one_instance_cannot_stand_at_two_places(tmp_path):
    model = build("VanDerPol", 2, "CoSimulation", tmp_path)
    once = tmp_path / "once.fmu"
    with zipfile.ZipFile(model) as source, zipfile.ZipFile(once, "w") as target:
        for name in source.namelist():
            text = source.read(name)
            if name == "modelDescription.xml":
                text = text.replace(b"<CoSimulation ", b'<CoSimulation canBeInstantiatedOnlyOncePerProcess="true" ')
            target.writestr(name, text)
    import_component(once, tmp_path, "vdp")
    lay_out(tmp_path, "")
    (tmp_path / "designs" / "one.yaml").write_text("design: one\nroot: {compound: {oscillator: vdp, other: vdp}}\n")
    (problem,) = check_workspace(workspace(tmp_path))[0]
    assert problem.what == "oscillator and other: VanDerPol can be instantiated only once in a process"
    assert str(problem.where).endswith("oscillating.yaml:3:1")


def lay_out(folder: Path, key: str) -> None:
    for name, text in {"designs/one.yaml": DESIGN, "testbenches/oscillating.yaml": BENCH}.items():
        (folder / name).parent.mkdir()
        (folder / name).write_text(text.replace("step: 10 ms,", f"step: 10 ms, {key}"), encoding="utf-8")


def test_what_cannot_be_fused_is_told_in_the_files(tmp_path):
    import_component(build("VanDerPol", 2, "CoSimulation", tmp_path), tmp_path, "vdp")
    lay_out(tmp_path, "coupling: solve,")
    bench = workspace(tmp_path).bench("oscillating")
    with pytest.raises(DseError) as caught:
        prepare_study(bench_study(bench), cache=tmp_path / "cache", fuse=True)
    component, method = caught.value.problems
    assert method.what.startswith("'coupling' cannot be fused")
    assert str(method.where).endswith("oscillating.yaml:3:1")
    assert component.what == "vdp is an existing FMU, which cannot be fused"
    assert str(component.where).endswith("vdp/component.yaml:1:12")


DESIGN = "design: one\nroot: {compound: {oscillator: vdp}}\n"
BENCH = """\
testbench: oscillating
design: one
simulation: {stop: 1 s, step: 10 ms, record: [oscillator.x0]}
metrics: {end: final(oscillator.x0)}
requirements: {R: {metric: end, at_most: 3}}
"""


@pytest.mark.thorough
def test_an_imported_fmu_is_simulated_as_a_user_would(tmp_path):
    fmu = build("VanDerPol", 2, "CoSimulation", tmp_path)
    dse = partial(run_dse, tmp_path, cache=tmp_path / "cache")
    said = dse("import", "fmu", str(fmu), "--name", "vdp")
    assert said.returncode == 0, said.stderr
    assert "vdp/component.yaml: 2 ports, 1 parameter\n" in said.stdout.replace(os.sep, "/")
    (tmp_path / "designs").mkdir()
    (tmp_path / "designs" / "one.yaml").write_text(DESIGN)
    (tmp_path / "testbenches").mkdir()
    (tmp_path / "testbenches" / "oscillating.yaml").write_text(BENCH)
    assert dse("check").returncode == 0
    # Like all commands, this one looks for the workspace upwards.
    inside = tmp_path / "components" / "vdp"
    assert run_dse(inside, "import", "fmu", str(fmu), "--name", "second", cache=tmp_path / "cache").returncode == 0
    assert (tmp_path / "components" / "second" / "component.yaml").is_file()
    done = dse("simulate", "oscillating")
    assert done.returncode == 0, done.stderr
    assert "pass" in done.stdout
