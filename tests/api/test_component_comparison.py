"""Two components on the same inputs, side by side."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from coded_texts import STEP, whole_program

from dse.api import Column, compare_components, pair_as_data
from dse.errors import DseError
from dse.fmu import build
from dse.loading import Workspace

ROOT = Path(__file__).parents[2]

INTERFACES = """\
interfaces:
  gain:
    inputs: {speed: m/s, enable: bool, kind: "enum[slow, quick]", number: int}
    outputs: {y: m/s, sum: int}
  other:
    inputs: {speed: m/s}
    outputs: {y: m/s}
"""
CODE = """\
#include <stdbool.h>
#include <stdint.h>
typedef struct {
    struct { double speed; bool enable; int32_t kind, number; } in;
    struct { double y; int32_t sum; } out;
    struct { double factor; } par;
} gain;
static void gain_step(gain *self) {
    self->out.y = self->par.factor * self->in.speed * (self->in.enable ? 1 + self->in.kind : 1);
    self->out.sum = self->in.number + 10 * self->in.kind;
}
static void gain_init(gain *self) { gain_step(self); }
"""


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A workspace of gains: of 2, the same every 20 ms, of a little more, and one of another interface."""
    parts = {"two": ("gain", 2, 10), "slow": ("gain", 2, 20), "more": ("gain", "2.000000002", 10)}
    parts |= {"odd": ("gain", 2, 10.0001), "another": ("other", 2, 10)}
    (tmp_path / "components").mkdir()
    (tmp_path / "components" / "interfaces.yaml").write_text(INTERFACES, "utf-8")
    (tmp_path / "components" / "gain.h").write_text(CODE.replace("static void", "static inline void"), "utf-8")
    (tmp_path / "components" / "gain.c").write_text('#include "gain.h"\n', "utf-8")
    for name, (interface, factor, step) in parts.items():
        folder = tmp_path / "components" / name
        folder.mkdir()
        (folder / "component.yaml").write_text(
            f"component: {name}\nimplements: {interface}\nparameters: {{factor: {{start: {factor}}}}}\n"
            f"source: {{kind: c, files: [../gain.c], header: ../gain.h, struct: gain, step: {step} ms}}\n",
            "utf-8",
        )
    return tmp_path


@pytest.mark.thorough
def test_two_that_are_equal_differ_in_nothing_and_every_input_moves_them(place: Path) -> None:
    shutil.copytree(place / "components" / "two", place / "components" / "twin")
    file = place / "components" / "twin" / "component.yaml"
    file.write_text(file.read_text("utf-8").replace("component: two", "component: twin"), "utf-8")
    found = compare_components("two", "twin", near=place, steps=300)
    assert (found.step, found.steps, found.is_within) == (0.01, 300, True)
    assert [(each.output, each.absolute, each.moves) for each in found.outputs] == [
        ("y", 0.0, True),
        ("sum", 0.0, True),
    ]
    assert found.parameters == {}


@pytest.mark.thorough
def test_a_changed_gain_is_found_and_named(place: Path) -> None:
    found = compare_components("two", "more", near=place, inputs={"speed": (0.0, 40.0)})
    y, total = found.outputs
    assert not found.is_within
    assert y.relative == pytest.approx(1e-9, rel=1e-3)
    assert 0.5 < y.values[0] / 80 <= 2
    assert y.absolute == pytest.approx(y.values[0] * 1e-9, rel=1e-5)
    assert total.absolute == 0
    assert found.parameters == {"factor": (2.0, 2.000000002)}
    assert replace(found, tolerance=2e-9).is_within
    data = json.loads(json.dumps(pair_as_data(found)))
    assert (data["within"], data["outputs"]["y"]["relative"]) == (False, y.relative)


@pytest.mark.thorough
def test_the_step_fits_both_sample_times(place: Path) -> None:
    found = compare_components("two", "slow", near=place, steps=100)
    assert found.step == 0.01
    assert not found.is_within  # the slow one keeps what it said for a second step
    with pytest.raises(DseError, match=r"'two' every 0.01 s and 'odd' every 0.0100001 s: no step fits both"):
        compare_components("two", "odd", near=place)


@pytest.mark.thorough
def test_an_input_is_constant_or_a_column_of_a_file_if_that_is_given(place: Path) -> None:
    (place / "cycle.csv").write_text("time;v [km/h]\n0;36\n100;36\n", "utf-8")
    given = {"speed": Column(place / "cycle.csv", "v"), "enable": 1.0, "kind": 1.0}
    y, _ = compare_components("two", "more", near=place, inputs=given, steps=20).outputs
    assert y.values == pytest.approx((40.0, 40.00000004), rel=1e-12)
    assert not y.moves


@pytest.mark.parametrize(
    ("second", "inputs", "said"),
    [
        ("another", {}, "'two' implements 'gain', 'another' 'other': there is nothing to compare"),
        ("two", {}, "'two' is compared with itself"),
        ("more", {"sped": 1.0}, "there is no input 'sped'"),
        ("more", {"number": (0.0, 0.5)}, "'number' is int: it moves between whole numbers"),
        ("more", {"kind": (0.0, 2.0)}, "'kind' has the items 0 to 1"),
        ("more", {"speed": (3.0, 2.0)}, "'speed' cannot move from 3 to 2"),
        ("more", {"speed": Column(Path("nowhere.csv"), "v")}, "no such file: nowhere.csv"),
        ("nobody", {}, "nobody"),
    ],
)
def test_what_cannot_be_compared_is_refused_by_name(place: Path, second: str, inputs: dict, said: str) -> None:
    with pytest.raises(DseError, match=said):
        compare_components("two", second, near=place, inputs=inputs)


@pytest.mark.thorough
def test_one_that_fails_is_named_with_the_time(tmp_path: Path) -> None:
    pytest.importorskip("clang.cindex")
    (tmp_path / "components").mkdir()
    interfaces = 'interfaces:\n  lag:\n    inputs: {speed: "1", enable: bool}\n    outputs: {filtered: "1"}\n'
    (tmp_path / "components" / "interfaces.yaml").write_text(interfaces, "utf-8")
    for name, limit in (("sound", "1000.0"), ("strict", "5.0")):
        folder = tmp_path / "components" / name / "lag_ert_rtw"
        folder.mkdir(parents=True)
        for file, text in whole_program().items():
            (folder / file).write_text(text.replace("1000.0", limit), "utf-8")
        (folder.parent / "component.yaml").write_text(
            f"component: {name}\nimplements: lag\nsource: {{kind: simulink, folder: lag_ert_rtw, step: 100 ms}}\n",
            "utf-8",
        )
    given = {"speed": 20.0, "enable": 1.0}  # 5 is passed in the third step
    with pytest.raises(DseError, match=r"strict: .*t = 0\.2.*over the top"):
        compare_components("sound", "strict", near=tmp_path, inputs=given, steps=50)
    assert compare_components("sound", "strict", near=tmp_path, inputs=given, steps=2).is_within
    assert STEP == 0.1


@pytest.mark.thorough
def test_the_fmu_of_a_coded_component_is_the_component(tmp_path: Path) -> None:
    pytest.importorskip("clang.cindex")
    shutil.copytree(ROOT / "components" / "controllers", tmp_path / "components" / "controllers")
    shutil.copy(ROOT / "components" / "interfaces.yaml", tmp_path / "components")
    shutil.copytree(ROOT / "components" / "osi", tmp_path / "components" / "osi")
    coded = Workspace(tmp_path).component("pd_acc_coded")
    text = (tmp_path / "components/controllers/pd_acc_coded/component.yaml").read_text("utf-8")
    before, _, after = text.partition("source: ")
    for version in (2, 3):
        folder = tmp_path / "components" / f"exported{version}"
        folder.mkdir()
        shutil.copy(build(coded, version=version), folder / "controller.fmu")
        rest = after.partition("\n")[2]
        renamed = before.replace("pd_acc_coded", f"exported{version}")
        (folder / "component.yaml").write_text(f"{renamed}source: {{kind: fmu, file: controller.fmu}}\n{rest}", "utf-8")
        for name in ("pd_acc_coded", "pd_acc"):
            found = compare_components(name, f"exported{version}", near=tmp_path, steps=400, tolerance=0.0)
            assert (found.step, found.is_within, found.parameters) == (0.01, True, {})
            assert all(each.moves for each in found.outputs)
