"""``dse import fmu``: a finished FMU becomes a component that works at once."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from reference_fmus import MODELS, build

from dse.domain.component import Kind
from dse.errors import DseError
from dse.loading.workspace import Workspace
from dse.testbench.check import check_workspace
from dse.testbench.importing import import_component, name_of


def workspace(folder: Path) -> Workspace:
    return Workspace(folder)


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


def test_what_no_port_can_carry_is_told(tmp_path):
    imported = import_component(build("Feedthrough", 3, "CoSimulation", tmp_path), tmp_path / "w")
    assert "Binary_input: of type Binary" in imported.left_out
    assert "String_output: of type String" in imported.left_out
    assert [p.name for p in imported.component.parameters if p.type.kind is Kind.TEXT] == ["text_parameter"]


def test_values_of_arrays_are_ports_of_their_own(tmp_path):
    imported = import_component(build("Feedthrough", 3, "CoSimulation", tmp_path), tmp_path / "w")
    assert imported.component.names["Float64_array_input_2_3"] == "Float64_array_input[2,3]"


def test_a_second_fmu_with_the_same_ports_implements_the_same_interface(tmp_path):
    first = import_component(build("VanDerPol", 2, None, tmp_path), tmp_path / "w")
    second = import_component(build("VanDerPol", 3, None, tmp_path), tmp_path / "w")
    assert first.has_own_interface
    assert not second.has_own_interface
    assert second.component.interface.name == first.component.interface.name


def test_an_interface_with_fewer_ports_in_another_spelling_is_found(tmp_path):
    folder = tmp_path / "w" / "components"
    folder.mkdir(parents=True)
    (folder / "interfaces.yaml").write_text(
        "interfaces:\n  relay:\n    inputs: {int32_input: int, booleanInput: bool}\n"
        "    outputs: {int32: {output: int}}\n"
    )
    imported = import_component(build("Feedthrough", 2, "CoSimulation", tmp_path), tmp_path / "w", "x")
    assert imported.component.interface.name == "relay"
    assert imported.component.names["int32.output"] == "Int32_output"
    assert "Float64_continuous_input" in {p.name for p in imported.component.parameters}
    assert check_workspace(workspace(tmp_path / "w"))[0] == []


def test_nothing_is_overwritten(tmp_path):
    file = build("Stair", 2, "CoSimulation", tmp_path)
    import_component(file, tmp_path / "w", "stair")
    with pytest.raises(DseError, match="is there already"):
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


BENCH = """\
testbench: oscillating
design: one
simulation: {stop: 1 s, step: 10 ms, record: [oscillator.x0]}
metrics: {end: final(oscillator.x0)}
requirements: {R: {metric: end, at_most: 3}}
"""


def test_an_imported_fmu_is_simulated_as_a_user_would(tmp_path):
    fmu = build("VanDerPol", 2, "CoSimulation", tmp_path)
    environment = {**os.environ, "DSE_CACHE": str(tmp_path / "cache")}

    def dse(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "dse", *arguments]
        return subprocess.run(
            command, cwd=tmp_path, env=environment, capture_output=True, text=True, encoding="utf-8", check=False
        )

    said = dse("import", "fmu", str(fmu), "--name", "vdp")
    assert said.returncode == 0, said.stderr
    assert "vdp/component.yaml: 2 ports, 1 parameters" in said.stdout.replace(os.sep, "/")
    (tmp_path / "designs").mkdir()
    (tmp_path / "designs" / "one.yaml").write_text("design: one\nroot: {compound: {oscillator: vdp}}\n")
    (tmp_path / "testbenches").mkdir()
    (tmp_path / "testbenches" / "oscillating.yaml").write_text(BENCH)
    assert dse("check").returncode == 0
    done = dse("simulate", "oscillating")
    assert done.returncode == 0, done.stderr
    assert "pass" in done.stdout
