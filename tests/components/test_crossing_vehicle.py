"""A vehicle that comes to a crossing just when the host does."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import pytest

NewPart = Callable[..., Any]
H = 0.01
ENTRY, EXIT, HOST_ENTRY, HOST_EXIT = 120.0, 124.0, 210.0, 214.0
FRONT, REAR, LENGTH = 2.3, 2.3, 4.5


def new(new_part: NewPart, gives_way: bool = True, **parameters: Any) -> Any:
    part = new_part("crossing_vehicle", **parameters)
    row = {"path": 1, "entry": ENTRY, "exit": EXIT, "other_path": 0, "other_entry": HOST_ENTRY, "other_exit": HOST_EXIT,
           "gives_way": gives_way}  # fmt: skip
    for name, value in row.items():
        part[f"conflicts[2].{name}"] = value
    return part


def drive(part: Any, speed: float, seconds: float, start: float = 0.0) -> list[tuple[float, float, float]]:
    """The host's station, and station and speed of the other, by ticks."""
    part["motion.speed"], part["lane.station"] = speed, start
    part.init()
    seen = [(start, part["movers[1].station"], part["movers[1].speed"])]
    for k in range(1, round(seconds / H) + 1):
        part["lane.station"] = start + speed * k * H
        part.step(H)
        seen.append((part["lane.station"], part["movers[1].station"], part["movers[1].speed"]))
    return seen


@pytest.mark.parametrize(("speed", "host", "delay", "start"), [
    (11.0, 14.0, 0.0, 10.0), (11.0, 9.3, 1.37, 10.0), (20.0, 14.0, 0.0, 90.0), (5.0, 25.0, 0.0, 80.0),
])  # fmt: skip
def test_it_is_in_the_middle_of_the_conflict_when_the_hosts_front_is_to_a_tick(
    new_part: NewPart, speed: float, host: float, delay: float, start: float
) -> None:
    seen = drive(new(new_part, speed=speed, delay=delay, station=start), host, 30.0)
    arrives = next(k for k, (_, station, _) in enumerate(seen) if station + LENGTH / 2 >= (ENTRY + EXIT) / 2)
    wanted = ((HOST_ENTRY + HOST_EXIT) / 2 - FRONT) / host + delay
    assert abs(arrives * H - wanted) <= H
    steps = [b[1] - a[1] for a, b in pairwise(seen)]
    assert 0 <= min(steps) <= max(steps) <= speed * H + 1e-9


def test_who_is_late_from_the_start_is_under_way_then(new_part: NewPart) -> None:
    seen = drive(new(new_part, speed=11.0, station=10.0), 20.0, 12.0, start=150.0)
    arrives = next(k for k, (_, station, _) in enumerate(seen) if station + LENGTH / 2 >= (ENTRY + EXIT) / 2)
    assert abs(arrives * H - (212 - FRONT - 150) / 20) <= H
    assert seen[0][2] == 11.0


@pytest.mark.parametrize("gives_way", [True, False])
def test_one_who_obeys_stops_before_the_conflict_until_the_host_has_left_it(new_part: NewPart, gives_way: bool) -> None:
    seen = drive(new(new_part, gives_way, manners="obeys", speed=11.0, delay=-3.0), 10.0, 40.0)
    waits = [(host, station) for host, station, speed in seen if speed == 0 and station > 20]
    assert bool(waits) == gives_way
    if gives_way:
        assert {round(station + LENGTH / 2, 6) for _, station in waits} == {ENTRY - 1.0}
        assert waits[-1][0] == pytest.approx(HOST_EXIT + REAR, abs=0.2)
    assert seen[-1][1] > EXIT


def test_one_who_obeys_stops_at_a_red_light_of_its_own_path(new_part: NewPart) -> None:
    part = new(new_part, False, manners="obeys", speed=11.0)
    for head, path, station in ((1, 0, 50.0), (2, 1, 100.0)):
        part[f"light_heads[{head}].path"], part[f"light_heads[{head}].station"] = path, station
        part[f"light_heads[{head}].colour"] = "red"
    seen = drive(part, 10.0, 40.0)
    assert seen[-1][1:] == (pytest.approx(100.0 - 1.0 - LENGTH / 2), 0.0)
    part["light_heads[2].colour"] = "green"
    for _ in range(100):
        part.step(H)
    assert part["movers[1].speed"] == pytest.approx(3.0, abs=0.04)


def test_a_road_without_such_a_conflict_ends_the_run_by_name(new_part: NewPart) -> None:
    part = new_part("crossing_vehicle", path=1)
    assert drive(part, 10.0, 0.02)[-1][1] != drive(part, 10.0, 0.02)[-1][1]  # not a number
