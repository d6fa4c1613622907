"""Small inputs that once went wrong (../shared/cases/world): what is right about each."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from opendrive_texts import factors, geometry, lane, opendrive, road, section
from world.small_roads import CROSSINGS, LANES

import dse
from dse.world import Route, lane_graph, list_ways, read_network, road_tables, way_end, way_of

ROOT = Path(__file__).parents[2]
CASES = ROOT.parent / "shared/cases/world"
there = pytest.mark.skipif(not CASES.is_dir(), reason="the small inputs are not there (../shared/cases/world)")


@there
def test_signs_of_two_countries_are_read() -> None:
    (path,) = road_tables(read_network(CASES / "signs.xodr", "signs.xodr")).paths
    assert path.speed_limit.starts.tolist() == [0, 20, 80, 140]
    assert path.speed_limit.coefficients[1:, 0] == pytest.approx([60 / 3.6, 35 * 0.44704, 30 * 0.44704])


@there
def test_a_repeated_patch_is_read() -> None:
    (path,) = road_tables(read_network(CASES / "repeat.xodr", "repeat.xodr")).paths
    assert [(patch.start, patch.friction) for patch in path.patches] == [(s, 0.1) for s in range(19, 120, 20)]


@there
def test_a_way_into_a_junction_without_links_says_why_it_ends() -> None:
    graph = lane_graph(read_network(CASES / "j_links_only_in_junction.xodr", "j.xodr"))
    problem = way_end(graph, way_of(graph, Route(("1", "3"))))
    assert problem is not None
    assert "ends in junction '100': lane -1 of road '3' names no <successor> in road '2'" in problem.what


@there
@pytest.mark.parametrize("name", ["f_shoulder", "f_biking", "outer_stop", "outer_bus", "outer_parking"])
def test_cars_have_the_driving_lane_only(name: str) -> None:
    read = read_network(CASES / f"{name}.xodr", name)
    assert [way.lane for way in list_ways(lane_graph(read))] == [-1]
    (path,) = road_tables(read).paths
    assert {lane.number: bool(lane.users & 0b1110) for lane in path.lanes} == {0: True, -1: False}


COMPONENT = """component: NAME
title: a road
implements: road
source: {kind: road, file: NAME.xodr, route: [1]PATHS}
parameters: {start_station: {start: 0 m, tunable: false}, preview_spacing: {start: 2 m, tunable: false}}
"""
DESIGN = """design: NAME
title: A car without a powertrain
root:
  compound: {car: single_track, lateral: pure_pursuit, road: ROADPARTS}
  connections:
    - road.ground -> car.ground
    - road.start -> car.start
    - road.lane -> lateral.lane
    - road.preview -> lateral.preview
    - car.motion -> lateral.motion
    - lateral.steering -> car.steering
    - car.motion -> road.motion
    - car.contacts -> road.contacts
"""
BENCH = """testbench: NAME
title: A car rolls
design: NAME
PARTS
parameters: {car.initial_speed: 72 km/h, car.wheels.front: 0 N.m, car.wheels.rear: 0 N.m, car.brake.front: 0 N.m,
  car.brake.rear: 0 N.m}
simulation: {stop: 12 s, step: 10 ms, algorithm: gauss_seidel, record: [RECORD]RATE}
metrics:
  v: {title: speed, expression: final(car.speed), unit: m/s}
"""
OVER = """test_components:
  traffic: {component: vehicles, parameters: {"class[1]": 1, "path[1]": 1, "station[1]": 198.25 m}}
  scene: {component: ray_scanner, parameters: {ray_count: 41, ray_angle: 20 deg}}
connections:
  - traffic.movers -> road.movers
  - road.lane -> traffic.lane
  - road.actors -> scene.actors
  - road.lane -> scene.lane
  - car.motion -> scene.motion"""
CROWD = """test_components:
  traffic:
    component: stream_traffic
    parameters: {count: 16, start_from: 10 m, desired_speed: 60 km/h, truck_speed: 50 km/h, cyclists: 3}
connections:
  - road.paths -> traffic.paths
  - traffic.movers -> road.movers
  - road.lane -> traffic.lane
  - car.motion -> traffic.motion"""
WIDENING = """test_components:
  traffic:
    component: idm_traffic
    parameters:
      class: [1, 1, 2, 0, 0, 0, 0, 0]
      lane_number: [1, 0, 0, 0, 0, 0, 0, 0]
      station: [100 m, 50 m, 85 m, 0 m, 0 m, 0 m, 0 m, 0 m]
      speed: [26 m/s, 25 m/s, 15 m/s, 0 m/s, 0 m/s, 0 m/s, 0 m/s, 0 m/s]
      "desired_speed[1]": 26 m/s
      "desired_speed[3]": 15 m/s
      "length[3]": 12 m
      politeness: 0
connections:
  - road.paths -> traffic.paths
  - traffic.movers -> road.movers"""
EYE = """    - car.motion -> eye.motion
    - road.actors -> eye.actors
    - eye.scan -> tracker.first
    - car.motion -> tracker.motion
"""


def simulated(folder: Path, name: str, xodr: str, bench: str, *, paths: str = "", sensed: bool = False) -> Any:
    """Waveforms of *bench* on the road *xodr*."""
    shutil.copytree(ROOT / "components", folder / "components")
    home = folder / "components" / name
    for each in (home, folder / "designs", folder / "testbenches"):
        each.mkdir()
    (home / f"{name}.xodr").write_text(xodr, "utf-8")
    (home / "component.yaml").write_text(COMPONENT.replace("NAME", name).replace("PATHS", paths), "utf-8")
    parts = ", eye: object_radar_long, tracker: kalman_tracker" if sensed else ""
    design = DESIGN.replace("NAME", name).replace("ROADPARTS", name + parts) + (EYE if sensed else "")
    (folder / "designs" / f"{name}.yaml").write_text(design, "utf-8")
    (folder / "testbenches" / f"{name}.yaml").write_text(bench.replace("NAME", name), "utf-8")
    opened = dse.open(folder).benches[name]
    (configuration,) = opened.design.list(2)
    return opened.simulate(configuration).waveforms.to_pandas()


@pytest.mark.thorough
@pytest.mark.usefixtures("kept_cache")
@pytest.mark.parametrize(("name", "met"), [("a bridge 8 m above", False), ("a level crossing", True)])
def test_a_car_on_a_bridge_is_neither_hit_nor_seen_nor_tracked(name: str, met: bool, tmp_path: Path) -> None:
    record = "scene.collision, scene.gap, road.actors[1].z, eye.scan.returns[1].valid, tracker.tracks[1].id"
    quoted = ", ".join(f'"{each.strip()}"' for each in record.split(","))
    bench = BENCH.replace("PARTS", OVER).replace("RECORD", quoted).replace("RATE", "")
    rows = simulated(
        tmp_path, "under", opendrive(*CROSSINGS[name].parts), bench, paths=", paths: {over: {route: [2]}}", sensed=True
    )
    assert rows["road.actors[1].z"].iloc[-1] == CROSSINGS[name].above
    assert bool(rows["scene.collision"].any()) == met
    assert bool(rows["eye.scan.returns[1].valid"].any()) == met
    assert bool((rows["tracker.tracks[1].id"] > 0).any()) == met
    assert (rows["scene.gap"].min() < 300) == met


@pytest.mark.thorough
@pytest.mark.usefixtures("kept_cache")
def test_a_crowd_keeps_to_the_lanes_of_its_classes(tmp_path: Path) -> None:
    lanes = LANES["bus and bicycle beside two lanes"]
    bench = (
        BENCH.replace("PARTS", CROWD).replace("RECORD", "traffic.everyone").replace("RATE", ", record_every: 100 ms")
    )
    rows = simulated(tmp_path, "shared", opendrive(*lanes.parts), bench)
    columns = {name: rows[[c for c in rows if c.startswith("traffic.everyone") and c.endswith(f".{name}")]] for name in
               ("class", "lane", "turn")}  # fmt: skip
    class_, lane_, turn = (columns[name].to_numpy() for name in ("class", "lane", "turn"))
    found = {k: set(lane_[(class_ == k) & (turn == 0)].tolist()) for k in (1, 2, 4)}
    assert found[1] == {0, 1}
    assert found[2] <= {0, 1}
    assert found[4] == {-2}


def ramp(x: Any, start: float, rise: float) -> Any:
    """From 0 to *rise* within 100 m, by a cubic."""
    u = np.clip((x - start) / 100, 0, 1)
    return rise * u * u * (3 - 2 * u)


@pytest.mark.thorough
@pytest.mark.usefixtures("kept_cache")
def test_who_keeps_a_lane_follows_its_middle_and_who_changes_is_between_both(tmp_path: Path) -> None:
    rise = (0.0, 0.0, 3e-4, -2e-6)
    left = "".join(
        f'<width sOffset="{s}"{factors(a, *rise[1:] if s == 50 else ())}/>' for s, a in ((0, 3), (50, 3), (150, 4))
    )
    right = f'<width sOffset="0"{factors(3.5, 0.0, 6e-4, -4e-6)}/>'
    first = "".join(lane(n, width, after=n) for n, width in ((-1, left), (-2, 3.5)))
    second = "".join(lane(n, width, before=n) for n, width in ((-1, 4.0), (-2, right)))
    shifts = "".join(f'<laneOffset s="{s}"{factors(*a)}/>' for s, a in ((0, (0.0,)), (100, rise), (200, (1.0,))))
    sections = section(0.0, "", first) + section(200.0, "", second)
    xodr = opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 300.0), 300.0, sections, offset=shifts))
    record = ", ".join(f'"road.actors[{n}].{name}"' for n in (1, 2, 3) for name in ("x", "y", "lane", "speed"))
    bench = BENCH.replace("PARTS", WIDENING).replace("RECORD", record).replace("RATE", "")
    rows = simulated(tmp_path, "widening", xodr, bench)
    rows = rows[rows["road.actors[1].x"] < 300]
    for n, kept in ((1, {1}), (2, {0, 1}), (3, {0})):
        x, y, number, speed = (rows[f"road.actors[{n}].{name}"].to_numpy() for name in ("x", "y", "lane", "speed"))
        inner, outer = 3 + ramp(x, 50, 1), 3.5 + ramp(x, 200, 2)
        share = (y - ramp(x, 100, 1) + inner + outer / 2) / ((inner + outer) / 2)  # 0 and 1: in the middle of a lane
        in_the_middle = abs(share - np.rint(share)) < 1e-9
        assert set(np.rint(share[in_the_middle])) == kept
        assert in_the_middle.all() or n == 2
        assert np.array_equal(number, np.rint(share))
        way = np.hypot(np.diff(x), np.diff(y))
        assert (way <= 0.01 * np.maximum(speed[1:], speed[:-1]) * 1.001 + 1e-6).all()
