"""Designs, benches, studies and components that are defined in Python: the same as their YAML, by the same rules."""

from __future__ import annotations

import dataclasses
import linecache
import math
import textwrap
from collections.abc import Mapping
from pathlib import Path, PurePath
from typing import Any

import numpy as np
import pytest
from example_study import example_benches, example_designs, example_studies
from hypothesis import given, strategies as st
from pandas.testing import assert_frame_equal

import dse
from dse.api.authoring.components import ComponentKeys, InterfaceKeys
from dse.api.spaces.design import DesignKeys
from dse.api.studies.bench import BenchKeys, StudyKeys
from dse.domain.component import Component
from dse.domain.design import DesignSpace
from dse.domain.expression import Piece
from dse.errors import Location
from dse.formats import dump_yaml, read_yaml
from dse.loading import Workspace, file_schema, kind_of, read_document

LIMIT = 0.25


class Proportional:
    """Demands a force in proportion to the error of the speed."""

    def __init__(self, parameters):
        self.gain = parameters["gain"]

    def step(self, inputs, h):
        demand = self.gain * math.tanh(inputs["set_speed"] - inputs["speed"]) + LIMIT
        return {"demand": demand, "mode": "push" if demand > 0 else "brake"}


class Lagging(Proportional):
    def step(self, inputs, h):
        return super().step(inputs, h)


@pytest.fixture(scope="module")
def made() -> dse.Workspace:
    """A workspace of its own. What a test defines in it has a name that no other test uses."""
    return dse.Workspace.new()


def sensor(*names: str) -> dict[str, Any]:
    return {"compound": {"sensor": {"alternatives": names}}}


def problem(error: pytest.ExceptionInfo[dse.DseError]) -> dse.Problem:
    (only,) = error.value.problems
    return only


# The same as YAML.


@pytest.mark.parametrize(
    ("kind", "keys", "name"),
    [
        ("design", DesignKeys, "design"),
        ("bench", BenchKeys, "testbench"),
        ("study", StudyKeys, "study"),
        ("component", ComponentKeys, "component"),
    ],
)
def test_the_arguments_are_the_keys_of_the_file(kind, keys, name):
    # The rule that files may include others is for files.
    assert {*keys.__annotations__, name, "include"} == {*file_schema(kind)["properties"]}


def test_the_arguments_of_an_interface_are_its_keys():
    section = file_schema("interfaces")["$defs"]["InterfaceSection"]["properties"]
    assert {*InterfaceKeys.__annotations__} == {*section, "types"}


TEXTS = st.text(
    st.characters(
        codec="utf-8",
        exclude_categories=["Cc", "Cs"],
        exclude_characters="\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069",
    )
)
PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**18), 10**18) | st.floats(allow_nan=False) | TEXTS,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(TEXTS, inner, max_size=4),
    max_leaves=12,
)


@given(data=st.dictionaries(TEXTS, PLAIN, min_size=1, max_size=4))
def test_plain_data_is_read_back_as_the_same(data, tmp_path_factory):
    file = tmp_path_factory.getbasetemp() / "plain.yaml"
    file.write_text(dump_yaml(data), encoding="utf-8", newline="")
    assert repr(read_yaml(file).data) == repr(data)


def bare(value: Any, *, is_top: bool = True) -> Any:
    """*value* without the places in files; of files, and of what has a file of its own, the names."""
    if isinstance(value, DesignSpace | Component) and not is_top:
        return value.name
    if isinstance(value, Location) or (isinstance(value, tuple) and all(isinstance(each, Piece) for each in value)):
        return None
    if isinstance(value, PurePath):
        return value.name if value.suffix else None
    if dataclasses.is_dataclass(value):
        fields = {each.name: bare(getattr(value, each.name), is_top=False) for each in dataclasses.fields(value)}
        return type(value).__name__, fields
    if isinstance(value, Mapping):
        return {key: bare(each, is_top=False) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [bare(each, is_top=False) for each in value]
    return value


ALL = [
    *(("designs", dse.Design, name) for name in example_designs()),
    *(("benches", dse.Bench, name) for name in example_benches()),
    *(("studies", dse.Study, name) for name in example_studies()),
]


@pytest.mark.parametrize(
    ("kind", "class_", "name"),
    [pytest.param(*case, marks=() if case[2].startswith("acc_gains") else pytest.mark.thorough) for case in ALL],
)
def test_what_is_defined_from_the_data_of_a_file_is_the_same(ws, made, kind, class_, name, tmp_path):
    shipped = getattr(ws, kind)[name]
    file = made.root / Path(shipped.noun.where.file).resolve().relative_to(ws.root)
    file.unlink()
    again = class_(**shipped.data, workspace=made)
    assert bare(again.noun) == bare(shipped.noun)
    written = tmp_path / file.name
    assert again.to_yaml(written) == written.read_text(encoding="utf-8")
    assert read_yaml(written).data == shipped.data


@pytest.mark.thorough
def test_a_component_that_is_defined_from_the_data_of_its_file_is_the_same(ws, made, monkeypatch):
    names = [name for name, path in made.files.component_files.items() if path.parent.name == name]
    assert len(names) > 100
    for name in names[::4]:
        file = made.files.component_files[name]
        data = {key: value for key, value in read_document(file, made.root).data.items() if key != "include"}
        file.unlink()
        made.definitions.files = Workspace(made.root)
        monkeypatch.chdir(file.parent)
        assert bare(dse.Component(**data, workspace=made).noun) == bare(ws.components[name])


@pytest.mark.thorough
def test_a_study_made_in_python_gives_the_bits_of_its_yaml(tmp_path):
    text = (Path(__file__).parents[2] / "docs" / "python.md").read_text(encoding="utf-8")
    block = text.split("## Define everything in Python")[1].split("```python\n")[1].split("```")[0]
    assert len(block.strip().splitlines()) < 25  # and the import
    scope: dict[str, Any] = {"dse": dse}
    exec(block.replace('"out/radar_or_lidar"', repr(str(tmp_path / "python"))), scope)  # noqa: S102  # of our docs
    results, study = scope["results"], scope["study"]
    assert len(results) == 200
    folder = dse.Workspace.new(tmp_path / "files")
    study.bench.design.to_yaml(folder.root / "designs" / f"{study.bench.design.name}.yaml")
    study.bench.to_yaml(folder.root / "testbenches" / f"{study.bench.name}.yaml")
    study.to_yaml(folder.root / "testbenches" / f"{study.name}.pet.yaml")
    by_yaml = dse.open(folder.root).studies[study.name].explore(tmp_path / "yaml", fresh=True)
    assert_frame_equal(by_yaml.to_pandas("si"), results.to_pandas("si"), check_exact=True)
    assert results.replay(7).is_same


# Components.


CART = {
    "implements": "cart_control",
    "parameters": {"gain": {"start": "800 kg/s", "unit": "kg/s", "min": 0, "max": 5000}},
    "properties": {"cost": "20 EUR"},
}


@pytest.fixture(scope="module")
def cart_control(made: dse.Workspace) -> dse.Interface:
    return dse.Interface(
        "cart_control",
        inputs={"speed": "m/s", "set_speed": "m/s"},
        outputs={"demand": "N", "mode": "enum[idle, push, brake]"},
        workspace=made,
    )


def test_a_class_becomes_a_module_with_what_it_uses(made, cart_control):
    component = dse.Component("proportional", **CART, source=Proportional, workspace=made)
    assert component.data["source"] == {"kind": "python", "files": ["proportional.py"], "class_name": "Proportional"}
    text = (made.root / "components" / "proportional" / "proportional.py").read_text(encoding="utf-8")
    assert text.startswith("LIMIT = 0.25\nimport math\n\n\nclass Proportional:\n")
    scope: dict[str, Any] = {}
    exec(text, scope)  # noqa: S102  # of this file
    step = scope["Proportional"]({"gain": 2.0}).step({"set_speed": 1.0, "speed": 0.0}, 0.1)
    assert step == {"demand": 2 * math.tanh(1.0) + 0.25, "mode": "push"}


def test_a_class_that_uses_another_one_is_refused_by_name(made, cart_control):
    with pytest.raises(dse.DseError) as error:
        dse.Component("lagging", **CART, source=Lagging, workspace=made)
    assert problem(error).what == "class 'Lagging' uses 'Proportional' from outside"
    assert str(problem(error).where) == "dse.Component('lagging'): source"
    assert "lagging" not in made.components


def test_a_class_without_source_text_is_refused_by_name(made, cart_control):
    scope: dict[str, Any] = {}
    exec("class Hidden:\n    def step(self, inputs, h):\n        return {}\n", scope)  # noqa: S102  # has no file
    with pytest.raises(dse.DseError, match=r"dse.Component\('hidden'\): source: class 'Hidden' has no source text"):
        dse.Component("hidden", **CART, source=scope["Hidden"], workspace=made)


C = """
#include "halving.h"
void halving_init(halving *self) { self->out.demand = 0.0; }
void halving_step(halving *self, double h) { (void)h; self->out.demand = 0.5 * self->in.speed; self->out.mode = 0; }
"""
HEADER = """
typedef struct {
    struct { double speed, set_speed; } in;
    struct { double demand; int mode; } out;
} halving;
void halving_init(halving *self);
void halving_step(halving *self, double h);
"""


def test_c_is_given_as_text_or_as_files(made, cart_control, tmp_path, monkeypatch):
    texts = {"halving.c": C, "halving.h": HEADER}
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    for number, files in enumerate([texts, ["halving.c"], [tmp_path / "halving.c", "halving.h"]]):
        source = {"kind": "c", "files": files, "struct": "halving"}
        component = dse.Component(f"halving_{number}", implements=cart_control, source=source, workspace=made)
        folder = made.root / "components" / component.name
        assert {path.name: path.read_text(encoding="utf-8") for path in folder.glob("*.[ch]")} == texts


def test_types_of_an_interface_are_for_its_arrays(made):
    interface = dse.Interface(
        "sightings", types={"sighting": {"id": "int", "at": "m[2]"}}, outputs={"seen": "sighting[2]"}, workspace=made
    )
    assert [port.name for port in interface.noun.ports][:3] == ["seen[1].id", "seen[1].at[1]", "seen[1].at[2]"]
    assert dse.Component("tracker", implements=interface, workspace=made).noun.interface == interface.noun


def test_a_file_that_is_not_there_is_named(made, cart_control):
    with pytest.raises(dse.DseError) as error:
        dse.Component("nowhere", **CART, source={"kind": "c", "files": ["nowhere.c"]}, workspace=made)
    assert str(problem(error).where) == "dse.Component('nowhere'): source['files'][0]"
    assert problem(error).what == "no such file: nowhere.c"


@pytest.mark.thorough
def test_an_fmu_becomes_a_component_with_its_interface(made, cart_control, tmp_path):
    source = {"kind": "c", "files": {"halving.c": C, "halving.h": HEADER}, "struct": "halving"}
    noun = dse.Component("halving", implements=cart_control, source=source, workspace=made).noun
    archive = kind_of(noun).build(noun, noun.source, version=2, cache=None)
    file = tmp_path / "supplied.fmu"
    file.write_bytes(archive.read_bytes())
    for _ in range(2):  # a cell may run again
        found = dse.Component("supplied", source=file, title="From a supplier", workspace=made)
        assert found.noun.title == "From a supplier"
        assert [port.name for port in found.noun.interface.ports] == ["speed", "set_speed", "demand", "mode"]


# What is wrong is told by its argument.


ERRORS = {
    "an unknown component": (
        lambda ws: dse.Design("e1", root=sensor("radar_77ghz_mid", "radr"), workspace=ws),
        "dse.Design('e1'): root['compound']['sensor']['alternatives'][1]",
        "unknown component 'radr'",
    ),
    "an unknown argument": (
        lambda ws: dse.Design("e2", root=sensor("radar_77ghz_mid"), titel="x", workspace=ws),
        "dse.Design('e2'): titel",
        "unknown key 'titel'",
    ),
    "a missing argument": (
        lambda ws: dse.Bench("e3", design="acc_vehicle", workspace=ws),
        "dse.Bench('e3')",
        "'simulation' is missing",
    ),
    "a wrong unit": (
        lambda ws: dse.Study(
            "e4",
            testbench="acc_following",
            design_variables={"controller.kp_speed": {"range": (0.1, "3 kg"), "levels": 3}},
            workspace=ws,
        ),
        "dse.Study('e4'): design_variables['controller.kp_speed']['range'][1]",
        "wrong unit in '3 kg': expected 1/time, found mass",
    ),
    "an expression": (
        lambda ws: dse.Bench(
            "e5", design="acc_vehicle", simulation={"stop": 1, "step": 0.1}, metrics={"m": "2 *"}, workspace=ws
        ),
        "dse.Bench('e5'): metrics['m']",
        "",
    ),
    "what no file can say": (
        lambda ws: dse.Design("e6", root={"compound": {"sensor": {1, 2}}}, workspace=ws),
        "dse.Design('e6'): root['compound']['sensor']",
        "a set cannot be written to a file",
    ),
    "a character that no text may hold": (
        lambda ws: dse.Design("e7", root=sensor("radar_77ghz_mid"), title="a\x07", workspace=ws),
        "dse.Design('e7'): title",
        "the character U+0007 cannot be used in a text",
    ),
    "a name that is a path": (
        lambda ws: dse.Design("../e8", root=sensor("radar_77ghz_mid"), workspace=ws),
        "dse.Design('../e8'): design",
        "'../e8' is not a name",
    ),
    "a name that a file of the workspace has": (
        lambda ws: dse.Component("pd_acc", workspace=ws),
        "dse.Component('pd_acc')",
        "the workspace has a component 'pd_acc' already",
    ),
    "an unknown interface": (
        lambda ws: dse.Component("e9", implements="acc_controler", workspace=ws),
        "dse.Component('e9'): implements",
        "unknown interface 'acc_controler'",
    ),
    "a unit in a type": (
        lambda ws: dse.Interface("e11", types={"speeds": {"first": "km/h"}}, outputs={"all": "speeds"}, workspace=ws),
        "dse.Interface('e11'): types['speeds']['first']",
        "",
    ),
    "a unit of a port": (
        lambda ws: dse.Interface("e10", inputs={"speed": "km/h"}, workspace=ws),
        "dse.Interface('e10'): inputs['speed']",
        "",
    ),
}


@pytest.mark.parametrize("case", ERRORS)
def test_an_error_names_the_argument(made, case):
    wrong, where, what = ERRORS[case]
    before = sorted(path for path in made.root.rglob("*") if path.is_file())
    with pytest.raises(dse.DseError) as error:
        wrong(made)
    found = error.value.problems[0]
    assert str(found.where) == where
    assert found.what.startswith(what)
    assert sorted(path for path in made.root.rglob("*") if path.is_file()) == before


def test_a_file_that_python_did_not_write_is_left_alone(made):
    file = made.root / "designs" / "acc_vehicle.yaml"
    before = file.read_bytes()
    with pytest.raises(dse.DseError, match=r"acc_vehicle\.yaml already"):
        dse.Design("acc_vehicle", root=sensor("radar_77ghz_mid"), workspace=made)
    assert file.read_bytes() == before


# Defining again.


def test_what_is_defined_anew_takes_the_place_of_what_was(made):
    first = dse.Design("anew", root=sensor("radar_77ghz_mid"), workspace=made)
    second = dse.Design("anew", root=sensor("radar_77ghz_mid", "lidar_905nm"), workspace=made)
    assert (first.count(), second.count(), made.designs["anew"].count()) == (1, 2, 2)
    with pytest.raises(dse.DseError, match="'anew' has been defined anew since"):
        dse.Bench("of_first", design=first, simulation={"stop": 1, "step": 0.1})
    assert dse.Bench("of_second", design=second, simulation={"stop": 1, "step": 0.1}).design.count() == 2


def test_a_definition_that_fails_leaves_the_one_before(made):
    design = dse.Design("kept", root=sensor("radar_77ghz_mid"), workspace=made)
    with pytest.raises(dse.DseError):
        dse.Design("kept", root=sensor("radr"), workspace=made)
    assert made.designs["kept"].count() == 1
    assert made.designs["kept"].data == design.data
    for same in (design, made.designs["kept"]):
        assert dse.Bench("of_kept", design=same, simulation={"stop": 1, "step": 0.1}).design.count() == 1


def test_things_of_two_workspaces_are_not_mixed(made, ws):
    design = dse.Design("here", root=sensor("radar_77ghz_mid"), workspace=made)
    with pytest.raises(dse.DseError, match=r"dse.Bench\('there'\): design: 'here' is in another workspace"):
        dse.Bench("there", design=design, simulation={"stop": 1, "step": 0.1}, workspace=ws)


def test_values_of_numpy_and_pathlib_are_written_as_what_they_are(made):
    study = dse.Study(
        "of_arrays",
        testbench=made.benches["acc_following"],
        configurations={"where": "controller is pd_acc"},
        design_variables={"controller.kp_speed": {"values": np.linspace(0.5, 2, 4), "nominal": np.float64(1)}},
        seed=np.int64(3),
    )
    assert study.noun.seed == 3
    assert study.data["design_variables"]["controller.kp_speed"] == {"values": [0.5, 1.0, 1.5, 2.0], "nominal": 1.0}
    assert study.definitions is made.definitions


def test_a_refined_design_has_yaml_of_its_own(ws, made):
    refined = ws.designs["acc_vehicle"].refine({"sensor": ["lidar_905nm"]})
    file = made.root / "designs" / "refined.yaml"
    refined.to_yaml(file)
    file.write_text(file.read_text(encoding="utf-8").replace("acc_vehicle", "refined"), encoding="utf-8")
    assert dse.open(made.root).designs["refined"].count() == refined.count() > 0


def test_what_was_changed_after_it_was_read_has_no_data(ws):
    study = ws.studies["acc_gains"]
    with pytest.raises(dse.DseError, match="'acc_gains' is not as in a file"):
        _ = dse.Study.of(dataclasses.replace(study.noun, seed=2)).data


def test_a_class_of_a_notebook_is_found_by_its_cell(made, cart_control):
    cell = "import numpy as np\nclass Celled:\n    def step(self, inputs, h):\n        return {'demand': np.pi}\n"
    name = "ipykernel_1/1234.py"
    linecache.cache[name] = (len(cell), None, cell.splitlines(keepends=True), name)
    scope: dict[str, Any] = {"__name__": "__main__"}
    exec(compile(cell, name, "exec"), scope)  # noqa: S102  # as IPython does
    dse.Component("celled", implements=cart_control, source=scope["Celled"], workspace=made)
    text = (made.root / "components" / "celled" / "celled.py").read_text(encoding="utf-8")
    assert text == "import numpy as np\n\n\n" + cell.partition("\n")[2]


@pytest.mark.thorough
def test_components_made_in_python_run(made, cart_control):
    source = {"kind": "c", "files": {"halving.c": C, "halving.h": HEADER}, "struct": "halving"}
    parts = [
        dse.Component("run_in_python", **CART, source=Proportional, workspace=made),
        dse.Component("run_in_c", implements=cart_control, source=source, workspace=made),
    ]
    design = dse.Design("running", root={"compound": {"control": {"alternatives": parts}}})
    bench = dse.Bench(
        "running",
        design=design,
        parameters={"control.speed": "3.6 km/h", "control.set_speed": 3},
        simulation={"stop": 1, "step": 0.1},
        metrics={"demand": "final(control.demand)"},
    )
    found = {run.choices["control"]: run.metrics["demand"] for run in map(bench.simulate, design)}
    # LIMIT + 800 kg/s tanh(3 m/s - 1 m/s), and half the speed.
    assert found == {"run_in_python": pytest.approx(800 * math.tanh(2.0) + LIMIT, rel=1e-15), "run_in_c": 0.5}


def test_a_workspace_is_kept_in_a_folder_that_is_named(tmp_path):
    dse.Design("one", root=sensor("radar_77ghz_mid"), workspace=dse.Workspace.new(tmp_path / "kept"))
    assert dse.open(tmp_path / "kept").designs["one"].count() == 1
    with pytest.raises(dse.DseError, match="the folder is not empty"):
        dse.Workspace.new(tmp_path / "kept")


def test_errors_in_files_are_told_by_file_and_line(made):
    file = made.root / "designs" / "by_hand.yaml"
    file.write_text(textwrap.dedent("design: by_hand\nroot: {compound: {sensor: radr}}\n"), encoding="utf-8")
    with pytest.raises(dse.DseError, match=r"by_hand\.yaml:2:"):
        dse.open(made.root).designs["by_hand"]
    file.unlink()
