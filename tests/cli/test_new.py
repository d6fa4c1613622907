"""``dse new``: what it writes is accepted by ``dse check``, and runs."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest
from jsonschema import Draft7Validator
from ruamel.yaml import YAML

from dse.api import Workspace, new_component, write_start
from dse.errors import DseError
from dse.loading import Workspace as Files


@pytest.mark.thorough
def test_a_workspace_can_be_made_of_starts_alone_and_runs(dse_in, tmp_path):
    for line in (
        "new component cruise",
        "new component other --kind modelica --implements cruise",
        "new component third --kind modelica",
        "new component fourth --kind python --implements cruise",
        "new component fifth --kind python",
        "new design car cruise other fourth",
        "new bench step --design car",
        "new study gains --bench step",
    ):
        done = dse_in(tmp_path, *line.split())
        assert done.returncode == 0, (line, done.stderr)
    checked = dse_in(tmp_path, "check")
    assert checked.stdout == "ok: 3 interfaces, 5 components, 1 design space, 1 test bench, 1 study\n", checked.stderr
    done = dse_in(tmp_path, "explore", "gains")
    assert done.stdout.startswith("out/gains: 5 runs, 5 of them new"), done.stderr
    done = dse_in(tmp_path, "simulate", "step", "--set", "cruise.set_speed=2 m/s", "--format", "json")
    assert json.loads(done.stdout)["metrics"]["final_cruise_force"] == pytest.approx(2 * 800)


@pytest.fixture
def example_files(example: Path, tmp_path: Path) -> Files:
    """The interfaces of the example, in a workspace that may be written to."""
    for path in example.glob("components/**/interfaces.yaml"):
        target = tmp_path / path.relative_to(example)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(path.read_bytes())
    return Files(tmp_path)


def starts(files: Files, kind: str) -> Iterator[str]:
    """Interfaces of which there is a start of a component of the *kind*, written down."""
    for interface in files.interfaces:
        name = f"my_{interface}"
        with suppress(DseError):
            write_start(files, name, new_component(files, name, kind, interface))
            yield interface


@pytest.mark.thorough
def test_a_component_in_c_can_be_started_for_every_interface_of_the_example(example_files):
    interfaces = example_files.interfaces.items()
    numbers = {name for name, each in interfaces if all(port.type.kind.is_number for port in each.ports)}
    assert len(interfaces) - len(numbers) == 3  # messages of OSI: how large they are, nobody but their author knows
    assert set(starts(example_files, "c")) == numbers
    assert Workspace(example_files).check() == ()


@pytest.mark.thorough
def test_a_component_in_modelica_can_be_started_for_most_interfaces_of_the_example(example_files):
    assert {"powertrain", "electric_machine", "brake"} <= set(starts(example_files, "modelica"))
    assert Workspace(example_files).check() == ()


@pytest.mark.thorough
@pytest.mark.parametrize(
    "design", ["acc_vehicle --around straight_road", "acc_vehicle", "electric_acc --around car_on_road"]
)
def test_benches_and_studies_can_be_started_for_designs_of_any_size(dse_in, tmp_path, design):
    dse_in(tmp_path, "init", "work")
    work = tmp_path / "work"
    assert dse_in(work, "new", "bench", "mine", "--design", *design.split()).returncode == 0
    assert dse_in(work, "new", "study", "vary", "--bench", "mine").returncode == 0
    checked = dse_in(work, "check")
    assert checked.returncode == 0, checked.stderr
    done = dse_in(work, "simulate", "mine")
    assert done.returncode == 0, done.stderr
    done = dse_in(work, "explore", "vary")
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("out/vary: 25 runs")


def test_nothing_is_overwritten_and_nothing_is_written_beside_it(dse_in, tmp_path):
    assert dse_in(tmp_path, "new", "component", "cruise").returncode == 0
    (tmp_path / "components" / "cruise" / "cruise.c").write_text("mine", encoding="utf-8")
    (tmp_path / "components" / "cruise" / "cruise.h").unlink()
    done = dse_in(tmp_path, "new", "component", "cruise")
    assert done.returncode == 1
    assert "components/cruise/cruise.c: the file already exists" in done.stderr
    assert (tmp_path / "components" / "cruise" / "cruise.c").read_text(encoding="utf-8") == "mine"
    assert not (tmp_path / "components" / "cruise" / "cruise.h").exists()


def test_a_name_that_is_taken_elsewhere_in_the_workspace_is_refused(dse_in, tmp_path):
    there = tmp_path / "components" / "family" / "cruise"
    there.mkdir(parents=True)
    (there / "component.yaml").write_text("component: cruise\n", encoding="utf-8")
    done = dse_in(tmp_path, "new", "component", "cruise")
    assert done.returncode == 1
    assert "components/family/cruise/component.yaml" in done.stderr
    assert not (tmp_path / "components" / "cruise").exists()


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("component bad-name", "'bad-name' cannot be a name"),
        ("component ../out", "cannot be a name"),
        ("component double", "a keyword of C"),
        ("component absent", "tests whether a part is present"),
        ("component x --kind ada", "possible: c, modelica, python"),
        ("component x --kind fmu", "dse import fmu"),
        ("component x --implements brakes", "did you mean 'brake'?"),
        ("design x", "COMPONENT"),
        ("design x pd_ac", "did you mean 'pd_acc'?"),
        ("bench x --design acc_vehicl", "did you mean 'acc_vehicle'?"),
        ("bench x --design electric_acc", "--around a component"),
        ("study x --bench acc_folowing", "did you mean 'acc_following'?"),
        ("study acc_gains --bench acc_following", "the file already exists"),
    ],
)
def test_what_cannot_be_started_is_named_with_what_to_do(dse, example, line, words):
    before = sorted(example.rglob("*"))
    done = dse("new", *line.split())
    assert done.returncode == 1
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert sorted(example.rglob("*")) == before


@pytest.mark.thorough
def test_editors_find_the_schema_of_what_is_written_and_it_accepts_it(dse_in, tmp_path):
    for line in ("component a", "component b --kind modelica", "design c a", "bench d --design c", "study e --bench d"):
        assert dse_in(tmp_path, "new", *line.split()).returncode == 0
    written = [*tmp_path.glob("components/**/*.yaml"), *tmp_path.glob("[dt]*/*.yaml")]
    assert len(written) == 7
    for path in written:
        text = path.read_text(encoding="utf-8")
        named = re.match(r"# yaml-language-server: \$schema=(\S+)\n", text)
        assert named
        schema = json.loads((path.parent / named[1]).read_text(encoding="utf-8"))
        assert list(Draft7Validator(schema).iter_errors(YAML(typ="safe", pure=True).load(text))) == [], path


@pytest.mark.thorough
def test_schemas_that_a_workspace_has_are_left_as_they_are(dse_in, tmp_path):
    (tmp_path / "schemas").mkdir()
    (tmp_path / "schemas" / "component.json").write_text("{}", encoding="utf-8")
    assert dse_in(tmp_path, "new", "component", "a").returncode == 0
    assert [path.name for path in (tmp_path / "schemas").iterdir()] == ["component.json"]
    assert dse_in(tmp_path, "schema", "-o", "schemas").returncode == 0
    assert len(list((tmp_path / "schemas").iterdir())) == 9
    assert (tmp_path / "schemas" / "design.json").read_text(encoding="utf-8") == dse_in(
        tmp_path, "schema", "design"
    ).stdout
