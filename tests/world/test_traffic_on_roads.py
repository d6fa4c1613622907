"""Traffic on roads: it meets the host where it shall, nobody jumps in the plane, and files say where others are."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import dse

pytestmark = pytest.mark.usefixtures("kept_cache")
ROOT = Path(__file__).parents[2]
FRONT = 2.3

DESIGN = """
design: coasting
title: A car without a powertrain
root:
  compound:
    car: single_track
    lateral: pure_pursuit
    road: {alternatives: [road_straight, road_curve]}
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
BENCH = """
testbench: traffic
title: A car coasts among others
design: coasting
PARTS
parameters:
  car.initial_speed: 40 km/h
  car.wheels.front: 0 N.m
  car.wheels.rear: 0 N.m
  car.brake.front: 0 N.m
  car.brake.rear: 0 N.m
  car.drag_area: 0 m2
  car.rolling_resistance: 0
  road.start_station: 20 m
simulation: {stop: STOP, step: 10 ms, algorithm: gauss_seidel, record: [ACTORS]}
metrics:
  end: {title: Its place at the end, expression: "final(road.actors[1].aside)", unit: m}
"""
WIRED = """
test_components:
  traffic: {component: NAME, parameters: {WITH}}
connections:
  - road.lane -> traffic.lane
  - car.motion -> traffic.motion
  - traffic.movers -> road.movers
"""


def driven(
    folder: Path, parts: str, stop: str, road: str = "road_straight", fuse: bool = True, more: str = "", **files: str
) -> Any:
    """Waveforms of the actors of a car that coasts at 40 km/h."""
    if not folder.joinpath("components").exists():
        for name in ("components", "roads"):
            shutil.copytree(ROOT / name, folder / name)
        for name in ("designs", "testbenches"):
            (folder / name).mkdir()
    names = [
        f'"road.actors[{i}].{name}"' for i in (1, 2, 3) for name in ("ahead", "aside", "station", "x", "y", "speed")
    ]
    text = BENCH.replace("PARTS", parts).replace("STOP", stop).replace("ACTORS", ", ".join(names))
    text = text.replace("parameters:\n  car.", f"parameters:\n{more}  car.")
    (folder / "designs" / "coasting.yaml").write_text(DESIGN, encoding="utf-8")
    (folder / "testbenches" / "traffic.yaml").write_text(text, encoding="utf-8")
    for name, content in files.items():
        (folder / "testbenches" / f"{name}.csv").write_text(content, encoding="utf-8")
    bench = dse.open(folder).benches["traffic"]
    configuration, *_ = bench.design.list(1, where=f"road is {road}")
    return bench.simulate(configuration, fuse=fuse).waveforms.to_pandas()


@pytest.mark.thorough
def test_who_crosses_meets_the_host_to_one_tick(tmp_path: Path) -> None:
    parts = WIRED.replace("NAME", "crossing").replace("WITH", "station: 150 m, conflict_offset: 0.3 m")
    rows = driven(tmp_path, parts, "12 s")
    ahead, aside = rows["road.actors[1].ahead"].to_numpy(), rows["road.actors[1].aside"].to_numpy()
    host_there, it_there = int((ahead > FRONT).sum()), int((aside < 0.3).sum())
    assert abs(host_there - it_there) <= 1
    assert 1000 < host_there < 1200


@pytest.mark.thorough
def test_a_cut_in_begins_at_its_gap_from_a_host_on_the_road(tmp_path: Path) -> None:
    parts = WIRED.replace("NAME", "cut_in").replace("WITH", "speed: -5 m/s, speed_over: host, initial_gap: 50 m")
    rows = driven(tmp_path, parts, "14 s")
    gap = rows["road.actors[1].ahead"].to_numpy() - FRONT - 2.25
    aside = rows["road.actors[1].aside"].to_numpy()
    assert gap[0] == pytest.approx(50, abs=1e-6)
    begins = int(np.argmax(aside < aside[0] - 1e-9))
    assert gap[begins] == pytest.approx(20, abs=0.2)  # four ticks at 5 m/s
    assert aside[-1] == pytest.approx(0, abs=1e-6)


@pytest.mark.thorough
def test_nobody_jumps_in_the_plane_and_a_fused_run_has_the_bits_of_fmi_calls(tmp_path: Path) -> None:
    cars = """class: [1, 1, 1, 0, 0, 0, 0, 0], station: [0 m, 200 m, 260 m, 0 m, 0 m, 0 m, 0 m, 0 m],
      speed: [25 m/s, 8 m/s, 8 m/s, 0 m/s, 0 m/s, 0 m/s, 0 m/s, 0 m/s],
      "desired_speed[2]": 8 m/s, "desired_speed[3]": 9 m/s, left_lane: 1, politeness: 0"""
    parts = WIRED.replace("NAME", "idm_traffic").replace("WITH", cars)
    first = driven(tmp_path, parts, "30 s", "road_curve")
    second = driven(tmp_path, parts, "30 s", "road_curve", fuse=False)
    assert first.to_numpy().tobytes() == second.to_numpy().tobytes()
    for i in (1, 2, 3):
        x, y, speed = (first[f"road.actors[{i}].{name}"].to_numpy() for name in ("x", "y", "speed"))
        way = np.hypot(np.diff(x), np.diff(y))
        assert (way <= 0.01 * np.maximum(speed[1:], speed[:-1]) * 1.001 + 1e-6).all()
    # The one behind comes up, and passes the host and who is slower on the left.
    assert first["road.actors[1].ahead"].iloc[0] < 0 < first["road.actors[1].ahead"].iloc[-1]
    assert first["road.actors[1].aside"].max() == pytest.approx(3.5, abs=0.3)


RECORDED = """time [s], station [m], offset [m], speed [km/h]
0, 80, 3.5, 54
3, 125, 3.5, 54
6, 170, 0, 54
12, 251, 0, 43.2
"""


@pytest.mark.thorough
def test_a_road_user_is_where_a_file_says(tmp_path: Path) -> None:
    fed = "inputs:\n" + "".join(
        f"  road.movers[2].{name}: {{file: lorry.csv, column: {name}}}\n" for name in ("station", "offset", "speed")
    )
    rows = driven(tmp_path, fed, "14 s", more="  road.movers[2].class: truck\n", lorry=RECORDED)
    time = 0.01 * np.arange(len(rows))
    for name, values in (("station", [80, 125, 170, 251]), ("aside", [3.5, 3.5, 0, 0]), ("speed", [15, 15, 15, 12])):
        found = rows[f"road.actors[2].{name}"].to_numpy()
        assert np.allclose(found, np.interp(time, [0, 3, 6, 12], values), atol=1e-6), name
