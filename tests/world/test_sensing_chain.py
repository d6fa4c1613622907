"""Radar, tracker and choice of the target in front of a cruise control, on a road."""

from __future__ import annotations

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

import dse

ROOT = Path(__file__).parents[2]
DESIGN = """
design: tracked_acc
title: Cruise control behind a sensor that sees several objects
root:
  compound:
    eye: object_radar_long
    tracker: kalman_tracker
    sensor: lane_target
    controller: pi_time_gap_acc
    lateral: pure_pursuit
    brake: hydraulic_booster
    powertrain: combustion_ideal
    chassis: single_track
    road: road_curve
  connections:
    - chassis.motion -> eye.motion
    - road.actors -> eye.actors
    - chassis.motion -> tracker.motion
    - eye.scan -> tracker.first
    - tracker.tracks -> sensor.tracks
    - chassis.motion -> sensor.motion
    - road.lane -> sensor.lane
    - road.preview -> sensor.preview
"""
BENCH = """
testbench: tracked
title: Behind a slower car into a curve
design: tracked_acc
test_components:
  traffic: {component: lead_vehicle, parameters: {initial_gap: 150 m, lead_speed: 50 km/h}}
  scene: {component: ray_scanner}
  weather: {component: clear}
connections:
  - chassis.motion -> traffic.motion
  - road.lane -> traffic.lane
  - traffic.movers -> road.movers
  - chassis.motion -> scene.motion
  - road.lane -> scene.lane
  - road.actors -> scene.actors
  - weather.air -> chassis.air
  - weather.surface -> road.surface
  - weather.visibility -> eye.visibility
parameters: {controller.set_speed: 70 km/h, controller.set_gap: 40 m}
simulation: {stop: 60 s, step: 10 ms, algorithm: gauss_seidel}
metrics:
  least_gap: {title: Least gap, expression: minimum(scene.gap), unit: m}
  gap: {title: Gap at the end, expression: final(scene.gap), unit: m}
  gap_error: {title: Of the gap told, expression: final(sensor.target.gap) - final(scene.gap), unit: m}
  speed_error: {title: Told, expression: final(sensor.target.closing_speed) - final(scene.closing_speed), unit: m/s}
"""


STUDY = """
study: {name}
title: Which eyes
testbench: tracked
configurations: {{where: "{where}"}}
conditions: {{controller.set_speed: {{values: [70 km/h, 80 km/h]}}}}
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, built_before: Callable[[Path], Path]) -> Path:
    monkeypatch.setenv("DSE_CACHE", str(built_before(tmp_path / "cache")))
    for name in ("components", "roads"):
        shutil.copytree(ROOT / name, tmp_path / name)
    wired = (ROOT / "designs" / "_road.yaml").read_text("utf-8").split("  connections:\n")[1]
    write(tmp_path, "designs/tracked_acc.yaml", DESIGN + wired)
    write(tmp_path, "testbenches/tracked.yaml", BENCH)
    return tmp_path


def write(folder: Path, file: str, text: str) -> None:
    (folder / file).parent.mkdir(exist_ok=True)
    (folder / file).write_text(text.lstrip(), encoding="utf-8")


@pytest.mark.thorough
def test_a_cruise_control_keeps_its_gap_in_a_curve_by_what_a_noisy_radar_tells(folder: Path) -> None:
    bench = dse.open(folder).benches["tracked"]
    configuration, *_ = bench.design.list(1)
    found = bench.simulate(configuration)
    assert 39.5 < found.metrics["least_gap"] <= found.metrics["gap"] < 41
    assert 0 < abs(found.metrics["gap_error"]) < 0.3  # the radar's standard deviation is 0.1 m
    assert 0 < abs(found.metrics["speed_error"]) < 0.12  # and this that of its Doppler
    assert bench.simulate(configuration, fuse=True).metrics == found.metrics


@pytest.mark.thorough
def test_sensors_of_a_design_are_exchanged_without_another_word_and_workers_change_no_bit(folder: Path) -> None:
    """A radar alone by one worker and FMI calls; it and others, with a second sensor or none, by two workers, fused."""
    design = (folder / "designs" / "tracked_acc.yaml").read_text("utf-8")
    design = design.replace(
        "    eye: object_radar_long\n",
        "    eye: {alternatives: [object_radar_long, object_stereo]}\n"
        "    second: {optional: object_camera}\n    lanes: lane_camera\n",
    )
    for port in ("lane", "preview"):
        design = design.replace(f"road.{port} -> lateral.{port}", f"lanes.seen.{port} -> lateral.{port}")
        design += f"    - road.{port} -> lanes.{port}\n"
    for seer in ("second", "lanes"):
        design += f"    - chassis.motion -> {seer}.motion\n"
    design += "    - road.actors -> second.actors\n    - second.scan -> tracker.second\n"
    write(folder, "designs/tracked_acc.yaml", design)
    alone = "eye is object_radar_long and second is absent"
    tables = {}
    for name, workers, fuse, where in (("alone", 1, False, alone), ("all", 2, True, "eye is present")):
        write(folder, f"testbenches/{name}.pet.yaml", STUDY.format(name=name, where=where))
        results = dse.open(folder).studies[name].explore(folder / name, workers=workers, fuse=fuse, fresh=True)
        table = results.to_pandas()
        tables[name] = table
    assert len(tables["all"]) == 8
    assert (tables["all"]["least_gap"] > 20).all()
    assert (tables["all"]["gap_error"].abs() < 4).all()  # two eyes see 80 m ahead, and 40 m to within 2 m
    same = tables["all"][(tables["all"]["eye"] == "object_radar_long") & tables["all"]["second"].isna()]
    for column in ("least_gap", "gap", "gap_error", "speed_error"):
        assert set(same[column]) == set(tables["alone"][column])
