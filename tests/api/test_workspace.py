"""A workspace: what it has, by name."""

from __future__ import annotations

import shutil

import pytest
from example_study import example_benches, example_designs, example_studies

import dse


def test_it_is_found_from_a_folder_within(folder):
    assert dse.open(folder / "designs").root == folder.resolve()


def test_without_one_the_error_says_how_to_get_one(tmp_path):
    with pytest.raises(dse.DseError, match="dse init"):
        dse.open(tmp_path)


def test_everything_is_listed_by_name_without_reading_it(ws):
    assert list(ws.designs) == example_designs()
    assert list(ws.benches) == example_benches()
    assert list(ws.studies) == sorted([*example_studies(), "small"])
    assert "pd_acc" in ws.components
    assert len(ws.components) > 75


def test_a_thing_is_read_once(ws):
    assert ws.benches["acc_following"] is ws.benches["acc_following"]


@pytest.mark.parametrize(
    ("kind", "name", "hint"),
    [
        ("designs", "acc_vehicel", "did you mean 'acc_vehicle'?"),
        ("benches", "acc_folowing", "did you mean 'acc_following'?"),
        ("studies", "smal", "did you mean 'small'?"),
        ("components", "pd_ac", "did you mean 'pd_acc'?"),
    ],
)
def test_an_unknown_name_hints_at_the_nearest(ws, kind, name, hint):
    with pytest.raises(dse.DseError) as error:
        getattr(ws, kind)[name]
    assert error.value.problems[0].hint == hint
    assert getattr(ws, kind).get(name) is None
    assert name not in getattr(ws, kind)


def test_a_component_is_a_noun(ws):
    assert ws.components["pd_acc"].interface.name == "acc_controller"


def test_a_name_may_be_a_file(ws, folder):
    assert ws.designs[str(folder / "designs" / "acc_vehicle.yaml")].name == "acc_vehicle"


@pytest.mark.thorough
def test_check_reads_the_files_as_they_are_now(folder, tmp_path):
    copy = shutil.copytree(folder, tmp_path / "copy")
    for path in (copy / "testbenches").iterdir():
        path.unlink()
    opened = dse.open(copy)
    assert opened.designs["acc_vehicle"].count() == 227
    design = copy / "designs" / "acc_vehicle.yaml"
    design.write_text(design.read_text(encoding="utf-8").replace("9500 EUR", "9500 EURO"), encoding="utf-8")
    (problem,) = [problem for problem in opened.check() if "EURO" in problem.what]
    assert problem.where
    assert problem.where.file.endswith("acc_vehicle.yaml")


def test_notebooks_show_tables_with_everything_escaped(ws):
    assert f"<td>{', '.join(list(ws.studies))}</td>" in ws._repr_html_()
    shown = ws.benches["acc_following"]._repr_html_()
    assert "<td>R1</td>" in shown
    assert "<td>speed P gain</td>" in ws.studies["acc_gains"]._repr_html_()
    assert (
        "<td>radar_77ghz_long, radar_77ghz_mid, lidar_905nm, camera_mono</td>"
        in ws.designs["acc_vehicle"]._repr_html_()
    )


def test_things_say_what_they_are(ws):
    assert repr(ws).endswith(
        f" {len(ws.components)} components, {len(example_designs())} designs, "
        f"{len(example_benches())} benches, {len(ws.studies)} studies>"
    )
    assert repr(ws.designs) == f"<designs: {', '.join(example_designs())}>"
    assert repr(ws.designs["acc_vehicle"]) == "<Design acc_vehicle: 624 combinations, 7 constraints>"
    assert repr(ws.benches["acc_following"]).startswith("<Bench acc_following of acc_vehicle: 60 s")
    assert repr(ws.studies["small"]) == "<Study small on acc_following: controller.kp_speed, controller.kd_speed>"
