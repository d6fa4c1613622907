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
    - eye.detections -> tracker.first
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


@pytest.mark.thorough
def test_a_cruise_control_keeps_its_gap_in_a_curve_by_what_a_noisy_radar_tells(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, built_before: Callable[[Path], Path]
) -> None:
    monkeypatch.setenv("DSE_CACHE", str(built_before(tmp_path / "cache")))
    for name in ("components", "roads"):
        shutil.copytree(ROOT / name, tmp_path / name)
    wired = (ROOT / "designs" / "_road.yaml").read_text("utf-8").split("  connections:\n")[1]
    for file, text in (("designs/tracked_acc.yaml", DESIGN + wired), ("testbenches/tracked.yaml", BENCH)):
        (tmp_path / file).parent.mkdir()
        (tmp_path / file).write_text(text.lstrip(), encoding="utf-8")
    bench = dse.open(tmp_path).benches["tracked"]
    configuration, *_ = bench.design.list(1)
    found = bench.simulate(configuration)
    assert 39.5 < found.metrics["least_gap"] <= found.metrics["gap"] < 41
    assert 0 < abs(found.metrics["gap_error"]) < 0.3  # the radar's standard deviation is 0.1 m
    assert 0 < abs(found.metrics["speed_error"]) < 0.12  # and this that of its Doppler
    assert bench.simulate(configuration, fuse=True).metrics == found.metrics
