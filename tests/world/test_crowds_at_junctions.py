"""Many on the paths of roads that cross and join, by what the road itself tells of lights and conflicts."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from components.conftest import WORKSPACE, Shelf
from components.test_stream_traffic import everyone
from world.test_road_conflicts import FROM_THE_LEFT, FROM_THE_RIGHT, HOST, ONCOMING_LEFT, network
from world.test_road_core import put

from dse.world import Conflict, RoadPath, Route, road_tables

H = 0.1
RED = 2
ROUNDABOUT = ("1 18 10 19 11 23 2", "3 15 9 16 10 20 4", "4 21 11 22 12 14 3")


@pytest.fixture(scope="module")
def new_part(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Any]:
    return Shelf(tmp_path_factory.mktemp("parts"), WORKSPACE).part


def together(path: RoadPath, other: RoadPath, conflict: Conflict) -> float:
    """How far they are on the same roads behind it."""
    shared = {leg.road for leg in path.legs} & {leg.road for leg in other.legs}
    ends = [*(leg.start for leg in path.legs[1:]), path.length]
    last = max((end for leg, end in zip(path.legs, ends, strict=True) if leg.road in shared), default=0.0)
    return max(last - conflict.exit, 0.0)


class Junction:
    """A road and the traffic on it; host and traffic do not mind each other."""

    def __init__(
        self, new_road: Callable[..., Any], new_part: Callable[..., Any], count: int, name: str, *routes: str
    ) -> None:
        tables = road_tables(network(name), [Route(tuple(route.split())) for route in routes])
        self.road = new_road(*tables.paths, conflicts=tables.conflicts)
        put(self.road, 20.0, 0.0)
        self.road.init()
        self.conflicts = [
            {name: self.road[f"conflicts[{i}].{name}"] for name in ("path", "other_path", "entry", "exit")}
            for i in range(1, len(tables.conflicts) + 1)
        ]
        speeds = {"desired_speed": 13.0, "truck_speed": 12.0}
        self.traffic = new_part("stream_traffic", minds_host=False, count=count, change_threshold=5.0, **speeds)
        for i in range(len(routes)):
            self.traffic[f"path_share[{i + 1}]"] = 1.0
        for i, conflict in enumerate(tables.conflicts, 1):
            path, other = tables.paths[conflict.path], tables.paths[conflict.other_path]
            self.traffic[f"together[{i}]"] = together(path, other, conflict)
        self.told = [name for name in self.traffic.slots if name.startswith(("paths[", "light_heads[", "conflicts["))]
        self.copy()
        self.traffic.init()

    def copy(self) -> None:
        for name in self.told:
            self.traffic[name] = self.road[name]

    def run(self, steps: int) -> Any:
        states, red = [], []
        for _ in range(steps):
            self.road.step(H)
            for name in self.told:
                if name.endswith(("colour", "remaining")):
                    self.traffic[name] = self.road[name]
            self.traffic.step(H)
            states.append(everyone(self.traffic))
            red.append([self.road[f"light_heads[{i}].colour"] == RED for i in range(1, 17)])
        return np.array(states), np.array(red)


def touching(junction: Junction, states: Any) -> int:
    """How often two on their paths' own lanes were in a conflict at once, or on one lane one in the other."""
    found = 0
    for number, conflict in enumerate(junction.conflicts, 1):
        together_ = junction.traffic[f"together[{number}]"]
        back = next(
            c for c in junction.conflicts
            if c["path"] == conflict["other_path"] and c["other_path"] == conflict["path"]
        )  # fmt: skip
        for state in states[::2]:
            own = state[(state["class"] > 0) & (np.abs(state["offset"]) < 0.5)]
            here, there = (own[own["path"] == int(c["path"])] for c in (conflict, back))
            if together_ == 0:
                sides = ((here, conflict), (there, back))
                inside = [
                    ((x["station"] + x["length"] / 2 > c["entry"]) & (x["station"] - x["length"] / 2 < c["exit"])).any()
                    for x, c in sides
                ]
                found += all(inside)
            else:
                ways, lengths = [], []
                for x, c in ((here, conflict), (there, back)):
                    rear, front = (x["station"] - c["exit"] + side * x["length"] / 2 for side in (-1, 1))
                    joined = (rear > 0) & (front < together_)
                    ways.append((x["station"] - c["exit"])[joined])
                    lengths.append(x["length"][joined])
                gaps = np.abs(ways[0][:, None] - ways[1]) - (lengths[0][:, None] + lengths[1]) / 2
                found += int((gaps <= 0).any())
    return found


def passed(junction: Junction, states: Any) -> list[int]:
    """How many came through on each path."""
    counts = []
    for path in range(8):
        length = junction.road[f"paths[{path + 1}].length"]
        there = (states["path"] == path) & (states["class"] > 0) & (states["station"] > length - 30)
        counts.append(len(np.unique(states["id"][there])) if length else 0)
    return counts


@pytest.mark.thorough
def test_at_an_intersection_lights_and_rights_of_way_are_obeyed(
    new_road: Callable[..., Any], new_part: Callable[..., Any]
) -> None:
    junction = Junction(new_road, new_part, 60, "intersection", HOST, FROM_THE_LEFT, FROM_THE_RIGHT, ONCOMING_LEFT)
    states, red = junction.run(2400)
    assert touching(junction, states) == 0
    assert min(passed(junction, states)[:4]) > 3
    runs = 0
    for i in range(16):
        path, line = junction.road[f"light_heads[{i + 1}].path"], junction.road[f"light_heads[{i + 1}].station"]
        if junction.road[f"light_heads[{i + 1}].colour"] == 0:
            continue
        front = states["station"] + states["length"] / 2
        same = (states["id"][1:] == states["id"][:-1]) & (states["class"][1:] > 0) & (states["path"][1:] == path)
        passing = same & (front[:-1] <= line) & (front[1:] > line) & red[1:, None, i] & red[:-1, None, i]
        since = np.array([np.argmin(red[: k + 1, i][::-1]) for k in range(len(red))]) * H
        possible = states["speed"][:-1] * since[:-1, None] > states["speed"][:-1] ** 2 / 18
        runs += int((passing & possible).sum())
    assert runs == 0


@pytest.mark.thorough
def test_in_a_roundabout_who_enters_waits(new_road: Callable[..., Any], new_part: Callable[..., Any]) -> None:
    junction = Junction(new_road, new_part, 24, "roundabout", *ROUNDABOUT)
    states, _ = junction.run(2400)
    assert min(passed(junction, states)[:3]) > 3
    assert touching(junction, states) == 0
