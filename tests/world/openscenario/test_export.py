"""Driven paths as an OpenSCENARIO file, which our own reader and player take."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from opendrive_texts import geometry, lane, opendrive, road, section

from dse.api import export_scenario, open as open_workspace, play_scenario
from dse.domain.component import Kind, Type
from dse.interchange import DrivenEntity, scenario_text
from dse.report import SceneSignals
from dse.world import read_scenario

ROOT = Path(__file__).parents[3]
ROAD = opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 500.0), 500.0, section(0.0, "", lane(-1))))


def driven(name: str, class_: int, first: float, last: float) -> DrivenEntity:
    times = np.linspace(first, last, 11)
    return DrivenEntity(name, class_, (4.0, 1.8, 1.5), times, 20.0 * times, 0 * times - 1.75, 0 * times, 0 * times)


def written(folder: Path, *entities: DrivenEntity) -> Path:
    (folder / "road.xodr").write_text(ROAD, "utf-8")
    path = folder / "driven.xosc"
    path.write_text(scenario_text(entities, "road.xodr", 'a "run" <of> ours & more'), "utf-8")
    return path


def test_what_is_written_can_be_read_whatever_the_names(tmp_path: Path) -> None:
    names = ["Ego", 'a "quoted" <name> & more', "walker", "post"]
    entities = [driven(name, class_, 0.0, 5.0) for name, class_ in zip(names, (1, 2, 5, 6), strict=True)]
    scenario = read_scenario(written(tmp_path, *entities))
    assert list(scenario.entities) == names
    assert [row["class"] for row in scenario.tables.rows["entities"]] == [1, 2, 5, 6]  # type: ignore[index,call-overload]
    assert [element.kind for element in scenario.elements] == ["story"]
    assert scenario.ignored == ()


def test_who_comes_later_or_leaves_early_has_events(tmp_path: Path) -> None:
    scenario = read_scenario(written(tmp_path, driven("Ego", 1, 0.0, 5.0), driven("guest", 1, 1.0, 4.0)))
    events = [element.name.rpartition("/")[2] for element in scenario.elements if element.kind == "event"]
    assert events == ["guest appears", "guest disappears"]


@pytest.mark.thorough
def test_a_run_on_a_bench_drives_again_as_it_did(tmp_path: Path) -> None:
    """Between the written poses, 0.1 s apart, the motion is straight: below 1 cm at the accelerations of the run."""
    bench = open_workspace(ROOT).files.bench("highway_cut_in")
    sizes, warnings = {"scene.host_length": "5 m", "scene.host_front": "2.8 m"}, list[str]()
    _, count = export_scenario(bench, None, sizes, tmp_path / "run.xosc", warn=warnings.append)
    assert warnings == ["parts of the bench differ in host_front: 2.3 m, 2.8 m; used: 2.8 m"]
    assert count == 2
    played = play_scenario(tmp_path / "run.xosc", ROOT, {}, stop=31.0)
    assert played.ended == pytest.approx(30.0)
    text = (tmp_path / "run.xosc").read_text("utf-8")
    assert '<Dimensions length="5" width="1.8" height="1.6"/>' in text
    for name in ("Ego", "Actor1"):
        poses = text.split(f'<Trajectory name="{name}"')[1].split("</Polyline>")[0]
        rows = [part.split('"')[1::2] for part in poses.split("<Vertex ")[1:]]
        for time, x, y, *_ in (tuple(map(float, row)) for row in rows[1:-1]):
            at = round(time / 0.01)
            assert played.poses[f"{name}.x"][at] == pytest.approx(x, abs=0.01)
            assert played.poses[f"{name}.y"][at] == pytest.approx(y, abs=0.01)


def test_the_size_of_the_host_is_that_of_its_bench_else_there_is_a_warning() -> None:
    columns = {f"chassis.motion.{name}": np.zeros(2) for name in ("x", "y", "heading", "speed")}
    signals = dict.fromkeys(columns, Type(Kind.REAL))
    sizes = {"scene.host_length": 5.0, "scene.host_width": 2.0, "scene.host_front": 2.8}
    host = SceneSignals(signals, sizes, ()).host(columns)
    assert (host.length, host.width, host.front) == (5.0, 2.0, 2.8)
    assert host.doubts == ("no part of the bench states host_height; assumed: 1.5 m",)
    sizes |= {"scene.host_height": 1.7}
    assert SceneSignals(signals, {"other.host_width": 1.9, **sizes}, ()).host(columns).doubts == (
        "parts of the bench differ in host_width: 1.9 m, 2 m; used: 2 m",
    )
