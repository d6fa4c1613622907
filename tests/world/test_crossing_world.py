"""The bench with somebody who crosses: the same bits however it is run, and they meet where the road says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from components.conftest import WORKSPACE
from fusion.conftest import Workshop, both_ways, system_of
from world.test_road_kind import wired

from dse.domain.method import Algorithm, Method

PARTS = {"road": "road_crossroads", "car": "longitudinal", "traffic": "crossing_vehicle",
         "assistant": "yield_assistant", "sensor": "object_perfect", "tracker": "kalman_tracker"}  # fmt: skip
WIRES = [
    "car.motion -> traffic.motion", "road.lane -> traffic.lane", "road.conflicts -> traffic.conflicts",
    "traffic.movers -> road.movers", "car.motion -> road.motion", "car.contacts -> road.contacts",
    "road.ground -> car.ground", "road.start -> car.start", "road.actors -> sensor.actors",
    "car.motion -> sensor.motion", "sensor.scan -> tracker.first", "car.motion -> tracker.motion",
    "tracker.tracks -> assistant.tracks", "car.motion -> assistant.motion", "road.lane -> assistant.lane",
    "road.preview -> assistant.preview", "road.light -> assistant.light", "road.conflicts -> assistant.conflicts",
]  # fmt: skip
RECORD = ["road.lane.station", "road.actors[1].station", "road.actors[1].speed", "assistant.deceleration",
          "road.conflicts[3].entry", "road.conflicts[3].exit", "road.conflicts[3].other_entry"]  # fmt: skip


@pytest.mark.thorough
def test_a_crossing_is_the_same_bits_fused_or_not_and_the_assistant_sees_who_comes(tmp_path: Path) -> None:
    workshop = Workshop(tmp_path, tmp_path / "cache", method=Method(Algorithm.GAUSS_SEIDEL))
    models = {part: workshop.built(WORKSPACE.component(name)) for part, name in PARTS.items()}
    system = system_of(models, list(wired(PARTS, WIRES)), RECORD)
    start = {"car.initial_speed": 14.0, "road.start_station": 80.0, "traffic.station": 90.0, "traffic.speed": 12.0,
             "car.drag_area": 0.0, "car.rolling_resistance": 0.0}  # fmt: skip
    first, _, again = both_ways(workshop, system, RECORD, [start, {**start, "traffic.delay": 3.0}, start], stop=11.0)
    assert first.tobytes() == again.tobytes()
    host, other, speed, demand, entry, exit_, other_entry = first.T
    # Nobody brakes the car, and nothing slows it: both fronts are in the middle of the conflict at one tick.
    ours = int(np.argmax(host + 2.3 >= (entry[0] + exit_[0]) / 2))
    theirs = int(np.argmax(other + 2.25 >= other_entry[0] + 1.0))
    assert abs(ours - theirs) <= 1
    assert speed[theirs] == pytest.approx(12.0)
    assert demand.max() > 2.5
