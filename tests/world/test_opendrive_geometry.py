"""Lanes of paths against OpenDRIVE's text, evaluated by other means to 1e-6 m (the tables keep 1e-7)."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import opendrive_oracle as oracle
import pytest
from opendrive_texts import factors, geometry, lane, opendrive, road, section

from dse.world import LanePlace, RoadPath, lane_graph, place, project, read_network, value
from dse.world.flatten import path_along
from dse.world.lane_graph import entries
from dse.world.routes import list_ways
from dse.world.ways import Way

ALKS = Path(__file__).parents[3] / "shared/data/alks/road_networks"
FILES = ["different_curvatures", "straight"] + [
    f"{side}_radius_{r}m" for side in ("left", "right") for r in (250, 1000)
]

CURVES = {
    "line": (80.0, "<line/>"),
    "arc to the left": (120.0, '<arc curvature="0.01"/>'),
    "arc to the right, more than a circle": (200.0, '<arc curvature="-0.05"/>'),
    "spiral": (100.0, '<spiral curvStart="0" curvEnd="0.008"/>'),
    "spiral from left to right": (150.0, '<spiral curvStart="0.02" curvEnd="-0.03"/>'),
    "spiral that hardly changes": (300.0, '<spiral curvStart="0.01" curvEnd="0.010001"/>'),
    "spiral that winds up": (100.0, '<spiral curvStart="0" curvEnd="0.5"/>'),
    "poly3": (60.0, f"<poly3{factors(0.0, 0.0, 0.01, -1e-4)}/>"),
    "poly3 that begins elsewhere and turned": (60.0, f"<poly3{factors(2.0, 0.5, -0.005, 2e-5)}/>"),
}


def _curve_road(name: str, **more: str) -> str:
    length, shape = CURVES[name]
    return opendrive(road("1", geometry(0.0, 100.0, -50.0, 0.7, length, shape), length, **more))


def _ways(text: str | Path, folder: Path) -> tuple[str, list[tuple[Way, RoadPath]]]:
    file = text if isinstance(text, Path) else folder / "road.xodr"
    if isinstance(text, str):
        file.write_text(text, "utf-8")
    graph = lane_graph(read_network(file, file.name))
    return file.read_text("utf-8-sig"), [(way, path_along(graph, way, "path")) for way in list_ways(graph)]


def _check(text: str, way: Way, path: RoadPath, points: int, tolerance: float = 1e-6) -> None:
    """Own lane and height of a path, *points* of each road, against the text of its roads."""
    roads = oracle.roads_of(text)
    begin = 0.0
    for passage in way.passages:
        element = roads[passage[0].road]
        length = float(element.get("length", ""))
        starts = [float(x.get("s", "")) for x in element.iter("laneSection")]
        along = _runs_along(element, passage[0])
        for station in np.linspace(0.0, length, points + 2)[1:-1]:
            s = station if along else length - station
            number = sum(start <= s for start in starts) - 1
            id_ = next(x.lane for x in passage if x.section == number)
            sides = oracle.borders(element, s, id_)
            here = np.array([begin + station])
            for t, side in zip(sorted(sides, reverse=not along), ("right", "left"), strict=True):
                x, y = oracle.place(element, s, t)
                found = place(path, here, value(getattr(path.lanes[0], side), here))
                assert math.hypot(found.x[0] - x, found.y[0] - y) <= tolerance
                assert abs(found.z[0] - oracle.height(element, s, t)) <= tolerance
        begin += length
    assert abs(path.length - begin) <= 1e-9


def _runs_along(element: object, first: LanePlace) -> bool:
    return (first.lane < 0) == (element.get("rule") != "LHT")  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", FILES)
def test_lanes_of_the_road_networks_of_alks_lie_where_their_files_say(name: str, tmp_path: Path) -> None:
    file = ALKS / f"alks_road_{name}.xodr"
    if not file.exists():
        pytest.skip("the road networks of ALKS are not there (../shared)")
    text, ways = _ways(file, tmp_path)
    assert len(ways) == 6  # a lane for each way: three and three, and no hard shoulder
    for way, path in ways:
        _check(text, way, path, 40)


@pytest.mark.parametrize("name", CURVES)
def test_lanes_follow_every_curve_in_both_directions(name: str, tmp_path: Path) -> None:
    text, ways = _ways(_curve_road(name), tmp_path)
    assert len(ways) == 2
    for way, path in ways:
        _check(text, way, path, 25)


@pytest.mark.parametrize("range_", ["normalized", "arcLength"])
def test_parametric_cubics_are_followed_by_their_length(range_: str, tmp_path: Path) -> None:
    u, v = (0.0, 60.0, 5.0, -8.0), (0.0, 0.0, 30.0, -12.0)
    length = oracle._arc_length(list(u), list(v), 1.0)
    scale = 1.0 if range_ == "normalized" else length
    said = "".join(
        f' {name}{axis}="{value / scale**power!r}"'
        for axis, values in (("U", u), ("V", v))
        for power, (name, value) in enumerate(zip("abcd", values, strict=True))
    )
    plan = geometry(0.0, 0.0, 0.0, 2.0, length, f'<paramPoly3 pRange="{range_}"{said}/>')
    text, ways = _ways(opendrive(road("1", plan, length)), tmp_path)
    for way, path in ways:
        _check(text, way, path, 15)


def test_widths_borders_offsets_and_sections_place_lanes(tmp_path: Path) -> None:
    width = f'<width sOffset="0"{factors(3.0, 0.01, 2e-3, -2e-5)}/><width sOffset="25"{factors(4.0, -0.02)}/>'
    border = f'<border sOffset="0"{factors(-3.5, 0.0, -1e-3)}/><border sOffset="30"{factors(-4.4)}/>'
    first = section(0.0, lane(1, width, after=1), lane(-1, border, after=-2))
    second = section(60.0, lane(1, 3.0, before=1), lane(-1, 3.0) + lane(-2, 3.5, before=-1))
    offset = f'<laneOffset s="0"{ZERO_OFFSET}/><laneOffset s="40"{factors(0.5, 0.02, -4e-4)}/>'
    plan = geometry(0.0, 5.0, 6.0, -2.0, 100.0, '<spiral curvStart="-0.01" curvEnd="0.01"/>')
    text, ways = _ways(opendrive(road("1", plan, 100.0, first + second, offset=offset)), tmp_path)
    assert {way.passages[0][0].lane for way, _ in ways} == {1, -1}
    for way, path in ways:
        _check(text, way, path, 60)


ZERO_OFFSET = factors(0.0, 0.0125)


def test_sections_for_one_side_leave_the_other_as_it_was(tmp_path: Path) -> None:
    both = section(0.0, lane(1, 3.0), lane(-1, 3.2, after=-1))
    right = section(40.0, "", lane(-1, 3.2, before=-1) + lane(-2, 2.0), ' singleSide="true"')
    plan = geometry(0.0, 0.0, 0.0, 0.0, 90.0, '<arc curvature="0.02"/>')
    text, ways = _ways(opendrive(road("1", plan, 90.0, both + right)), tmp_path)
    assert len(ways) == 2
    for way, path in ways:
        _check(text, way, path, 30)


def test_heights_and_banks_are_seen_in_the_direction_of_travel(tmp_path: Path) -> None:
    profiles = (
        f'<elevationProfile><elevation s="0"{factors(10.0, 0.05)}/>'
        f'<elevation s="40"{factors(12.0, 0.05, -1e-3, 1e-6)}/></elevationProfile>'
        f'<lateralProfile><superelevation s="10"{factors(0.0, 2e-3)}/></lateralProfile>'
    )
    text, ways = _ways(_curve_road("arc to the left", more=profiles), tmp_path)
    grades = {}
    for way, path in ways:
        _check(text, way, path, 30)
        grades[way.lane] = place(path, np.array([30.0 if way.lane < 0 else 90.0]))
    assert grades[-1].grade[0] == pytest.approx(0.05, abs=1e-7)
    assert grades[1].grade[0] == pytest.approx(-0.05, abs=1e-7)
    assert grades[-1].bank[0] == pytest.approx(0.04, abs=1e-12)
    assert grades[1].bank[0] == pytest.approx(-0.04, abs=1e-12)


def test_a_clothoid_keeps_its_curvature_between_pieces(tmp_path: Path) -> None:
    _, ways = _ways(_curve_road("spiral"), tmp_path)
    stations = np.linspace(0.0, 99.999, 500)
    by_lane = {way.lane: place(path, stations).curvature for way, path in ways}
    # Quintic pieces meet with the curve's own curvature; between, theirs is off by less than 1e-6 of it.
    assert np.allclose(by_lane[-1], 0.008 * stations / 100, atol=2e-6)
    assert np.allclose(by_lane[1], -0.008 * (100 - stations) / 100, atol=2e-6)


def test_left_hand_traffic_drives_on_the_left(tmp_path: Path) -> None:
    plan = geometry(0.0, 0.0, 0.0, 0.0, 50.0)
    text, ways = _ways(opendrive(road("1", plan, 50.0, rule="LHT")), tmp_path)
    for way, path in ways:
        _check(text, way, path, 3)
        heading = place(path, np.array([1.0])).heading[0]
        assert math.cos(heading) == pytest.approx(1.0 if way.lane == 1 else -1.0)


def test_a_point_beside_a_path_is_found_again(tmp_path: Path) -> None:
    _, ways = _ways(_curve_road("spiral from left to right"), tmp_path)
    for _, path in ways:
        for station, t in ((0.5, 2.0), (37.0, -5.0), (149.0, 1.0)):
            there = place(path, np.array([station]), t)
            assert project(path, there.x[0], there.y[0]) == pytest.approx((station, t), abs=1e-6)


def test_lanes_are_numbered_from_the_paths_own_to_the_left(tmp_path: Path) -> None:
    left = lane(2, 2.0, "sidewalk") + lane(1, 3.0)
    right = lane(-1, 3.1) + lane(-2, 0.5, "border") + lane(-3, 3.2)
    _, ways = _ways(opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 50.0), 50.0, section(0.0, left, right))), tmp_path)
    (path,) = [path for way, path in ways if way.lane == -3]
    here = np.array([10.0])
    assert [band.number for band in path.lanes] == [0, 1, 2]
    widths = {band.number: float(value(band.left, here)[0] - value(band.right, here)[0]) for band in path.lanes}
    assert widths == pytest.approx({0: 3.2, 1: 3.1, 2: 3.0})
    assert len(list(entries(read_network(tmp_path / "road.xodr", "road.xodr")))) == 3  # nobody drives on the pavement
