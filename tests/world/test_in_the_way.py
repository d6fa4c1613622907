"""What is in the way: levels of roads that pass over each other, and lanes that are for some."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from opendrive_texts import network
from world.small_roads import CROSSING, CROSSINGS, LANES, LENGTH, Crossing
from world.traced_roads import Traced, constant, cubics

from dse.world import CLASSES, HEIGHTS, LEVEL, STEEPEST, Route, on_one_level, road_tables, user_bits, users_of

NewRoad = Callable[..., Any]
LETTERS = {"c": "car", "t": "truck", "m": "motorcycle", "b": "bicycle"}


def put(part: Any, x: float, y: float, heading: float = 0.0) -> None:
    part["motion.x"], part["motion.y"], part["motion.heading"], part["motion.speed"] = x, y, heading, 20.0


def level_of(part: Any, **mover: Any) -> float:
    for name, value in {"class": "car", "length": 4.5, "width": 1.8, **mover}.items():
        part[f"movers[1].{name}"] = value
    part.step()
    return float(part["actors[1].above"])


@pytest.mark.parametrize("crossing", CROSSINGS.values(), ids=CROSSINGS)
def test_roads_meet_where_they_are_on_one_level(new_road: NewRoad, tmp_path: Path, crossing: Crossing) -> None:
    tables = road_tables(network(tmp_path, *crossing.parts), [Route(("1",)), Route(("2",))])
    assert len(tables.conflicts) == (2 if crossing.meet else 0)
    part = new_road(*tables.paths, conflicts=tables.conflicts)
    part.init()
    for host in (-180.0, -60.0, -5.0, 0.0):
        put(part, CROSSING + host, -1.75)
        assert level_of(part, path=1, station=CROSSING) == pytest.approx(crossing.above, abs=0.15)
    put(part, CROSSING, -1.75)
    # Far beside the host's road the ground may be as high as the road there.
    assert level_of(part, path=1, station=LENGTH) == pytest.approx(0, abs=1e-9)


def test_a_road_that_passes_over_itself_has_two_levels(new_road: NewRoad) -> None:
    """A ramp: straight on, round a loop of 40 m to the left by 270 degrees, and over the beginning, 7 m above it."""
    loop = Traced([(200.0, 0.0, 0.0), (60 * math.pi, 1 / 40, 1 / 40), (200.0, 0.0, 0.0)])
    rise = cubics([(0.0, [0.0]), (200.0, [0.0, 7 / (60 * math.pi)]), (200 + 60 * math.pi, [7.0])])
    part = new_road(loop.path(height=rise))
    part.init()
    put(part, 160.0, 0.0)
    over = 200 + 60 * math.pi + 40
    assert level_of(part, station=over) == pytest.approx(7)
    assert (part["actors[1].x"], part["actors[1].y"]) == (pytest.approx(160), pytest.approx(0, abs=1e-6))
    # What is ahead on the ramp is on the way.
    assert [level_of(part, station=200 + 30 * math.pi * k) for k in (0.2, 1.0, 1.6)] == [0, 0, 0]


def test_a_road_is_on_one_level_with_itself_however_steep(new_road: NewRoad) -> None:
    part = new_road(Traced([(1000.0, 0.0, 0.0)]).path(height=cubics([(0.0, [0.0, 0.3])])))
    part.init()
    put(part, 500.0, 0.0)
    assert {level_of(part, station=station) for station in range(0, 1001, 5)} == {0.0}


def test_who_has_no_height_has_that_of_its_class(new_road: NewRoad) -> None:
    part = new_road(Traced([(100.0, 0.0, 0.0)]).path())
    part.init()
    told = []
    for class_ in CLASSES[1:]:
        level_of(part, **{"class": class_, "height": 0.0})
        told.append(part["actors[1].height"])
    assert told == list(HEIGHTS[1:])
    level_of(part, **{"class": "truck", "height": 4.1})
    assert part["actors[1].height"] == 4.1


@pytest.mark.parametrize("names", [list(LANES)[:5], list(LANES)[5:]], ids=["one beside", "several"])
def test_a_road_tells_whose_its_lanes_are_and_where(new_road: NewRoad, tmp_path: Path, names: list[str]) -> None:
    part = new_road(*(road_tables(network(tmp_path, *LANES[name].parts)).paths[0] for name in names))
    part.init()
    for number, name in enumerate(names, 1):
        lanes = LANES[name]
        for k, (users, middle) in enumerate(zip(lanes.users, lanes.middles, strict=True), 1):
            lane = f"paths[{number}].lanes[{k}]"
            told = part[f"{lane}.users"] & user_bits(LETTERS.values())
            assert (name, k, told) == (name, k, user_bits(LETTERS[letter] for letter in users))
            assert part[f"{lane}.middle"] == pytest.approx(middle, abs=1e-12)
            assert part[f"{lane}.width"] > 0
        assert part[f"paths[{number}].lanes[{len(lanes.users) + 1}].width"] == 0


def test_lanes_of_one_width_are_whole_multiples_of_it_apart_to_the_last_bit(new_road: NewRoad) -> None:
    bands = tuple(replace(each, number=k) for k, each in enumerate(_bands(3.6, 4)))
    part = new_road(replace(Traced([(100.0, 0.0, 0.0)]).path(lanes=bands), leftmost=3))
    part.init()
    # The road measures the width at its own lane, by its borders.
    width = part["paths[1].lane_width"]
    assert [part[f"paths[1].lanes[{k + 1}].middle"] for k in range(4)] == [k * width for k in range(4)]


def _bands(width: float, count: int) -> list[Any]:
    path = Traced([(100.0, 0.0, 0.0)]).path()
    own = path.lanes[0]
    return [replace(own, right=constant(k * width), left=constant((k + 1) * width)) for k in range(count)]


def test_a_type_of_lane_and_its_rules_say_who_may_drive_there() -> None:
    assert users_of("driving") == {"car", "truck", "motorcycle", "bicycle"}
    assert users_of("driving", [("deny", "truck"), ("deny", "bicycle")]) == {"car", "motorcycle"}
    assert users_of("driving", [("allow", "bus"), ("allow", "bicycle")]) == {"bicycle"}
    assert users_of("biking", [("allow", "passengerCar")]) == frozenset()
    assert [users_of(type_) for type_ in ("stop", "shoulder", "bus", "tram", "rail", "special1", "none")] == [
        frozenset()
    ] * 7


def test_the_level_of_a_road_allows_for_the_ground_beside_it() -> None:
    assert on_one_level(0.99 * LEVEL)
    assert not on_one_level(-LEVEL)
    assert on_one_level(LEVEL + 0.99 * STEEPEST * 50, 50.0)
    assert not on_one_level(LEVEL + 1.01 * STEEPEST * 50, 50.0)


def test_two_levels_are_two_metres_apart(new_road: NewRoad) -> None:
    line = Traced([(400.0, 0.0, 0.0)])
    rising = line.path(height=cubics([(0.0, [-2.5, 0.0125])]))  # over a flat one
    part = new_road(line.path(), rising)
    part.init()
    put(part, 100.0, 0.0)
    told = [level_of(part, path=1, station=(height + 2.5) / 0.0125) for height in (-2.4, -1.9, 0.0, 1.9, 2.4)]
    assert told == pytest.approx([-2.4, 0.0, 0.0, 0.0, 2.4], abs=1e-9)
