"""A study in own units: its folder says all about them, for any process and without the workspace."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import dse
from dse.api.studies.exploration import merge_into
from dse.errors import DseError
from dse.units import UnitError, parse_unit

SOURCE = """\
class Cart:
    def __init__(self, parameters):
        self.way = parameters["way"]

    def step(self, inputs, h):
        return {"position": self.way}
"""
FILES = {
    "components/interfaces.yaml": "units: {CR: {currency: true}, stride: 0.75 m}\n"
    "interfaces: {going: {outputs: {position: m}}}\n",
    "components/cart/component.yaml": "component: cart\nimplements: going\nsource: {kind: python, files: [cart.py]}\n"
    "parameters: {way: {start: 4 stride, min: 1 stride, max: 9 stride}}\nproperties: {cost: 40 CR}\n",
    "components/cart/cart.py": SOURCE,
    "designs/car.yaml": "design: car\nunits: {kCR: 1000 CR}\nroot: {compound: {cart: cart}}\n"
    "constraints: {budget: {require: sum(cost) <= 1 kCR}}\n",
    "testbenches/go.yaml": "testbench: go\ndesign: car\nsimulation: {stop: 1 s, step: 100 ms}\n"
    "metrics: {far: {expression: final(cart.position) + 1 stride, unit: stride}}\n"
    "requirements: {R1: {metric: far, at_least: 5 stride}}\n"
    "figures: {way: {current: cart.position, unit: stride}}\n",
    "testbenches/ways.pet.yaml": "study: ways\ntestbench: go\n"
    "design_variables: {cart.way: {range: [2 stride, 6 stride], levels: 3}}\n"
    "constraints: [cart.way >= 2 stride]\nobjectives: [minimize sum(cost) / 1 kCR + far / 1 stride]\n",
}


def workspace(folder: Path, stride: str = "0.75 m") -> dse.Workspace:
    for name, text in FILES.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text.replace("0.75 m", stride), encoding="utf-8")
    return dse.open(folder)


@pytest.mark.thorough
def test_a_study_in_own_units_is_resumed_merged_read_and_shown(tmp_path):
    results = workspace(tmp_path / "there").studies["ways"].explore(tmp_path / "out")
    bench = dse.open(tmp_path / "there").benches["go"]
    assert bench.simulate(set={"cart.way": "3 stride"}).metrics["far"] == 3  # 4 stride, in m
    shutil.copytree(tmp_path / "out", tmp_path / "other")
    target, _ = merge_into([tmp_path / "out", tmp_path / "other"], tmp_path / "merged")
    shutil.rmtree(tmp_path / "there")  # what is in the folder is enough
    for folder in (tmp_path / "out", target):
        frame = dse.results(folder).to_pandas()
        assert frame["far"].tolist() == [3, 5, 7]
        assert frame.attrs["units"]["far"] == "stride"
        assert frame.attrs["units"]["sum(cost)"] == "CR"
    definition = results.definition
    assert {entry.unit for entry in definition.metrics} == {"stride{0.75 m}"}
    assert dict(definition.units) == {"kCR": "kCR{1000 ¤CR}", "stride": "stride{0.75 m}"}
    page = tmp_path / "page.html"
    dse.results(target).report(page)
    assert "¤" not in page.read_text(encoding="utf-8")
    assert "stride{" not in page.read_text(encoding="utf-8")
    with pytest.raises(UnitError):
        parse_unit("stride")


@pytest.mark.thorough
def test_a_unit_with_another_meaning_makes_another_study(tmp_path):
    workspace(tmp_path / "one").studies["ways"].explore(tmp_path / "out")
    workspace(tmp_path / "two", "0.5 m").studies["ways"].explore(tmp_path / "other")
    with pytest.raises(DseError, match="units"):
        merge_into([tmp_path / "out", tmp_path / "other"], tmp_path / "merged")
