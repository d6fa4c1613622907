"""What a picture of a road shows, by value; that it is drawn is looked at."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from dse.api import picture_of
from dse.loading import Workspace
from dse.report import draw_road, save_drawing
from dse.report.drawing.road_picture import crossings
from dse.report.roads import road_picture, with_driven
from dse.world import lane_middle, open_roads, place, road_tables

ROOT = Path(__file__).parents[2]


@pytest.fixture
def network(tmp_path):
    def made(**road):
        (tmp_path / "made.yaml").write_text(json.dumps({"road": "made", **road}), encoding="utf-8")
        return open_roads(str(tmp_path / "made.yaml"), Workspace(tmp_path))

    return made


def test_lanes_lie_where_they_are_and_look_the_way_they_are_driven(network):
    left, right = road_picture(network(segments=[{"straight": 100}], lanes=1), "made").strips
    # Against the road: its right border is the outer one, at 3.5 m.
    assert left.right[0] == pytest.approx([100, 3.5])
    assert left.left[-1] == pytest.approx([0, 0])
    assert right.right[0] == pytest.approx([0, -3.5])
    assert right.left[-1] == pytest.approx([100, 0])


def test_a_curve_is_drawn_by_points_of_its_circles_so_many_that_it_looks_round(network):
    curve = {"curve": {"radius": 50, "angle": 180}}
    _, right = road_picture(network(segments=[curve]), "made").strips
    for side, radius in ((right.left, 50.0), (right.right, 53.5)):
        x, y = (side - [0, 50]).T
        assert np.hypot(x, y) == pytest.approx(radius)
        assert np.abs(np.diff(np.unwrap(np.arctan2(y, x)))).max() <= 0.05


def test_ice_is_drawn_on_the_map_and_along_the_way(network):
    ice = [{"along": [20, 30], "friction": 0.1}, {"along": [40, 60], "across": [-3.5, -1.75], "friction": 0.2}]
    picture = road_picture(network(segments=[{"straight": 100, "friction": ice}]), "made")
    assert sorted(area.friction for area in picture.areas) == [0.1, 0.1, 0.2]
    half = next(area.outline for area in picture.areas if area.friction == 0.2)
    assert (half.min(axis=0).tolist(), half.max(axis=0).tolist()) == ([40, -3.5], [60, -1.75])
    along = next(area.outline for area in picture.along.areas if area.friction == 0.2)
    assert along[:, 1].min() == pytest.approx(-1.75)
    assert along[:, 1].max() == pytest.approx(0.0)


def test_the_profile_below_has_height_bank_and_curvature(network):
    curve = {"curve": {"radius": 100, "angle": 90, "spiral": 50, "bank": 0.05}}
    along = road_picture(network(segments=[{"hill": {"grade": 0.05, "radius": 500}}, curve]), "made").along
    assert along.height.max() == pytest.approx(0.05**2 * 500, rel=1e-4)
    assert along.slope.min() == pytest.approx(-0.05)
    assert along.curvature.max() == pytest.approx(1 / 100, rel=1e-3)


def test_lights_stand_beside_the_lanes_they_are_for(network):
    shape = {"intersection": {"lights": {"cycle": 40}}}
    picture = road_picture(network(segments=[{"straight": 50}, shape, {"straight": 50}]), "made")
    # 8 m from the border of the other road, 1 m beside the own one.
    expected = [(50, -4.5), (73, 4.5), (57, 11.5), (66, -11.5)]
    assert np.array(sorted(picture.lights.tolist())) == pytest.approx(np.array(sorted(expected)))
    assert picture.along.lights.tolist() == [50.0]
    (box,) = crossings(picture.strips)
    assert box.left < 50
    assert box.right > 73


def test_a_path_that_was_driven_has_its_distance_from_the_middle_of_the_lane(network):
    roads = network(segments=[{"straight": 50}, {"curve": {"radius": 80, "angle": 60, "spiral": 20}}])
    (path,) = road_tables(roads).paths
    stations = np.linspace(1, path.length - 1, 5000)
    beside = 0.3 * np.sin(stations / 10)
    driven = place(path, stations, lane_middle(path, stations) + beside)
    (shown,) = with_driven(road_picture(roads, "made"), roads, "me", driven.x, driven.y).driven
    assert len(shown.x) <= 2000
    assert shown.offset == pytest.approx(np.interp(shown.station, stations, beside), abs=1e-4)


@pytest.mark.thorough
@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_the_same_road_gives_the_same_bytes(tmp_path, kind):
    for name in ("one", "other"):
        save_drawing(draw_road(picture_of(ROOT / "roads" / "straight.yaml")), tmp_path / f"{name}.{kind}")
    assert (tmp_path / f"one.{kind}").read_bytes() == (tmp_path / f"other.{kind}").read_bytes()


@pytest.mark.parametrize(
    ("source", "what"),
    [("x.csv", "no position was recorded"), ("x.txt", "nor a file of waveforms"), ("no.csv", "nor a file of")],
)
def test_what_has_no_path_is_refused(tmp_path, source, what):
    if source.startswith("x"):
        (tmp_path / source).write_text("time,chassis.speed [m/s]\n0,1\n", encoding="utf-8")
    with pytest.raises(Exception, match=what):
        picture_of(ROOT / "roads" / "straight.yaml", [(tmp_path / source, 0)])


def test_a_path_is_read_from_the_waveforms_of_a_simulation(tmp_path):
    rows = "".join(f"{t},{10 * t},-1.5\n" for t in range(20))
    (tmp_path / "w.csv").write_text(f"time,chassis.motion.x [m],chassis.motion.y [m]\n{rows}", encoding="utf-8")
    picture = picture_of(ROOT / "roads" / "straight.yaml", [(tmp_path / "w.csv", 0)])
    (driven,) = picture.driven
    assert driven.label == "w"
    assert driven.station == pytest.approx(10 * np.arange(20))
    assert driven.offset == pytest.approx(0.25)
