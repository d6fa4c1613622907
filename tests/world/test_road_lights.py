"""What a road tells of the next traffic light ahead."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest
from world.test_road_core import LINE, RING, put

from dse.world import Light, RoadPath

NewRoad = Callable[..., Any]

NONE, OFF, RED, YELLOW, GREEN = 0, 1, 2, 4, 5
PHASES = (("green", 20.0), ("yellow", 3.0), ("red", 27.0))


def lit(path: RoadPath, *lights: Light) -> RoadPath:
    return replace(path, lights=lights)


def test_a_light_shows_its_phases_in_turn_to_the_tick(new_road: NewRoad) -> None:
    part = new_road(lit(LINE.path(), Light("1", 300.0, PHASES, 10.0)))
    put(part, 100.0, 0.0)
    part.init()
    seen = [(part["light.colour"], part["light.remaining"])]
    for _ in range(9000):
        part.step(0.01)
        seen.append((part["light.colour"], part["light.remaining"]))
    # Before it begins at 10 s it is where it would be if it had gone on for ever.
    changes = [k for k in range(1, 9001) if seen[k][0] != seen[k - 1][0]]
    assert [(k, seen[k][0]) for k in changes] == [
        (1000, GREEN), (3000, YELLOW), (3300, RED), (6000, GREEN), (8000, YELLOW), (8300, RED),
    ]  # fmt: skip
    assert seen[0] == (RED, pytest.approx(10.0))
    assert seen[1000][1] == pytest.approx(20.0)
    assert part["light.distance"] == pytest.approx(200.0)


def test_in_a_shared_world_lights_follow_its_time(new_road: NewRoad) -> None:
    part = new_road(lit(LINE.path(), Light("1", 300.0, PHASES, 10.0)))
    put(part, 100.0, 0.0)
    part["clock_offset"] = 31.5
    part.init()
    assert (part["light.colour"], part["light.remaining"]) == (YELLOW, pytest.approx(1.5))
    part["clock_offset"] = 33.5  # the run has fallen behind
    part.step(0.01)
    assert (part["light.colour"], part["light_heads[1].colour"]) == (RED, RED)


def test_the_light_told_is_the_nearest_one_ahead(new_road: NewRoad) -> None:
    part = new_road(lit(LINE.path(), Light("1", 300.0, PHASES, 0.0), Light("2", 200.0, (), 0.0)))
    told = []
    for x in (150.0, 200.5, 300.5):
        put(part, x, 0.0)
        part.init()
        told.append((part["light.colour"], part["light.distance"]))
    # The second one tells no phases: it is there, and dark.
    assert told == [(OFF, pytest.approx(50.0)), (GREEN, pytest.approx(99.5)), (NONE, 0.0)]


def test_on_a_ring_the_light_behind_comes_again(new_road: NewRoad) -> None:
    path = replace(RING.path(), closed=True)
    part = new_road(lit(path, Light("1", 10.0, PHASES, 0.0)))
    here = RING.at(RING.length - 30)
    put(part, here.x, here.y, here.heading)
    part.init()
    assert part["light.distance"] == pytest.approx(40.0)
