"""Vehicles that follow each other and the host, and change lanes, against numpy and against what never may be."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from components.idm_reference import HOST, Traffic
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]
H = 0.05
ARRAYS = ("desired_speed", "time_gap", "standstill_gap", "max_acceleration", "comfortable_deceleration")


def traffic(new_part: NewPart, vehicles: list[Mapping[str, float]], **parameters: Any) -> Any:
    part = new_part("idm_traffic", **parameters)
    for i, vehicle in enumerate(vehicles, 1):
        part[f"class[{i}]"] = 1
        for name, value in vehicle.items():
            part[f"{name}[{i}]"] = value
    return part


def state(part: Any) -> Any:
    """Rows are vehicles; station, offset, turn, speed along the lane, acceleration."""
    rows = []
    for i in range(1, 9):
        station, offset, turn, speed, a = (
            part[f"movers[{i}].{name}"] for name in ("station", "offset", "turn", "speed", "acceleration")
        )
        rows.append((station, offset, turn, speed * math.cos(turn), a))
    return np.array(rows)


def run(part: Any, steps: int, h: float = H) -> Any:
    part.init()
    states = [state(part)]
    for _ in range(steps):
        part.step(h)
        states.append(state(part))
    return np.array(states)


def test_a_platoon_comes_to_the_gap_of_equilibrium_and_stands_behind_who_stands(new_part: NewPart) -> None:
    cars = [{"station": 400 - 40.0 * i, "speed": 15.0, "desired_speed": 20.0 if i == 0 else 30.0} for i in range(8)]
    states = run(traffic(new_part, cars, minds_host=False), 12_000)
    gaps = -np.diff(states[-1, :, 0]) - 4.5
    assert np.allclose(states[-1, :, 3], 20, atol=1e-3)
    assert np.allclose(gaps, (2 + 20 * 1.5) / math.sqrt(1 - (20 / 30) ** 4), atol=0.01)
    part = traffic(new_part, cars)
    part["lane.station"] = 900.0  # the host stands across their way
    states = run(part, 4000)
    assert (states[-1, :, 3] == 0).all()
    assert (states[-1] == states[-2]).all()
    gaps = -np.diff(np.concatenate([[900 - 2.3 + 2.25], states[-1, :, 0]])) - 4.5
    assert (gaps > 1.5).all()
    assert (gaps < 4).all()
    assert states[:, :, 4].min() > -9


VEHICLE = st.fixed_dictionaries({
    "speed": st.floats(5, 30), "desired_speed": st.floats(8, 40), "time_gap": st.floats(0.8, 2.5),
    "standstill_gap": st.floats(1, 4), "max_acceleration": st.floats(0.5, 2.5),
    "comfortable_deceleration": st.floats(1, 3), "lane_number": st.integers(0, 2), "length": st.floats(2, 14),
})  # fmt: skip
SCENES = {
    "vehicles": st.lists(VEHICLE, min_size=5, max_size=8), "spacing": st.floats(14, 40),
    "plus": st.booleans(), "closed": st.booleans(), "host": st.booleans(), "politeness": st.floats(0, 1),
    "keep_right": st.sampled_from([0.0, 0.3]), "duration": st.floats(2, 6),
}  # fmt: skip


def host_at(k: int) -> tuple[float, float]:
    """Speed and offset: it drives unevenly, stands for a while, and changes lanes."""
    time = H * k
    speed = max(0.0, 14 + 16 * math.cos(time / 9))
    offset = 3.5 * min(max((time - 30) / 4, 0), 1)
    return speed, offset


def scene(new_part: NewPart, given_: Mapping[str, Any]) -> tuple[Any, Traffic]:
    vehicles = [dict(vehicle) for vehicle in given_["vehicles"]]
    for i, vehicle in enumerate(vehicles):
        vehicle["station"] = given_["spacing"] * i + 30.0
    lap = 30 + given_["spacing"] * len(vehicles) + 20 if given_["closed"] else 0.0
    part = traffic(
        new_part, vehicles, model="idm_plus" if given_["plus"] else "idm", lap_length=lap, left_lane=2,
        politeness=given_["politeness"], keep_right=given_["keep_right"], change_duration=given_["duration"],
        minds_host=given_["host"], host_front=2.0, host_rear=2.8, host_lane=0,
    )  # fmt: skip
    count = len(vehicles)

    def column(name: str, other: float) -> Any:
        return np.array([v.get(name, other) for v in vehicles] + [other] * (9 - count), float)

    driver = np.array([[v[name] for name in ARRAYS] for v in vehicles] + [[30, 1.5, 2, 1.5, 2]] * (8 - count))
    there = np.array([i < count for i in range(8)] + [given_["host"]])
    lane = column("lane_number", 0).astype(int)
    length = column("length", 4.8)
    reference = Traffic(
        there, column("station", 0), column("speed", 0), lane, length, driver, given_["plus"], lap, (0, 2),
        given_["duration"], given_["politeness"], 0.1, given_["keep_right"], old=lane.copy(),
    )  # fmt: skip
    return part, reference


def drive(part: Any, reference: Traffic | None, steps: int, lap: float) -> Any:
    station, states = 10.0, []
    for k in range(steps):
        speed, offset = host_at(k)
        part["lane.station"], part["motion.speed"], part["lane.offset"] = station, speed, offset
        if k:
            part.step(H)
        else:
            part.init()
        if reference is not None and k:
            # A vehicle of the host's length about the middle between its bumpers.
            reference.x[HOST], reference.v[HOST] = station - 0.4, speed
            reference.host_lanes = tuple(n for n in range(-1, 4) if abs(offset - 3.5 * n) < 1.8)
            reference.step(H)
            there = reference.there[:8]
            mine = state(part)[there]
            assert np.allclose(mine[:, 0], reference.x[:8][there], rtol=0, atol=1e-6), k
            assert np.allclose(mine[:, 3], reference.v[:8][there], rtol=0, atol=1e-6), k
            assert np.allclose(mine[:, 1], reference.offsets()[:8][there], rtol=0, atol=1e-6), k
        states.append(state(part))
        station += speed * H
        station = station % lap if lap else station
    return np.array(states)


def changes(states: Any) -> int:
    """How often a vehicle was in the middle of a lane and then in that of another."""
    found = 0
    for offsets in states[:, :, 1].T:
        lanes = [lane for lane, _ in itertools.groupby(o for o in offsets if (o / 3.5).is_integer())]
        found += len(lanes) - 1
    return found


@pytest.mark.thorough
def test_it_drives_as_an_independent_implementation_does(new_part: NewPart) -> None:
    seen = []

    @settings(max_examples=4, deadline=None, derandomize=True)
    @given(**SCENES)
    def check(**given_: Any) -> None:
        part, reference = scene(new_part, given_)
        seen.append(changes(drive(part, reference, 800, reference.lap)))

    check()
    assert sum(seen) > 5


@pytest.mark.thorough
def test_nobody_ever_jumps(new_part: NewPart) -> None:
    seen = []

    @settings(max_examples=25, deadline=None, derandomize=True)
    @given(**SCENES)
    def check(**given_: Any) -> None:
        part, reference = scene(new_part, given_)
        states = drive(part, None, 1600, reference.lap)
        seen.append(changes(states))
        before, after = states[:-1], states[1:]
        way = after[:, :, 0] - before[:, :, 0]
        assert (way >= 0).all()
        assert (way <= H * np.maximum(before[:, :, 3], after[:, :, 3]) + 1e-9).all()
        assert (np.abs(after[:, :, 3] - before[:, :, 3]) <= 9 * H + 1e-9).all()
        aside = np.abs(after[:, :, 1] - before[:, :, 1])
        assert (aside <= 1.875 * 3.5 / given_["duration"] * H + 1e-12).all()
        assert (aside <= 0.3 * way + 1e-9).all()  # nobody slides sideways
        assert np.abs(states[:, :, 2]).max() <= math.atan(0.3) + 1e-12

    check()
    assert sum(seen) > 30


def test_who_is_slower_is_overtaken_or_makes_way_and_safety_comes_first(new_part: NewPart) -> None:
    slow = {"station": 100.0, "speed": 15.0, "desired_speed": 15.0}
    fast = {"station": 30.0, "speed": 25.0, "desired_speed": 30.0}

    def overtakes(other: Mapping[str, float] | None = None, **parameters: float) -> bool:
        cars = [slow, fast, *([other] if other else [])]
        settings_ = {"minds_host": False, "left_lane": 1, "politeness": 0.0} | parameters
        states = run(traffic(new_part, cars, **settings_), 400)
        return bool(states[:, 1, 1].max() == 3.5 and states[-1, 1, 0] > states[-1, 0, 0])

    assert overtakes()
    polite = run(traffic(new_part, [slow, fast], minds_host=False, left_lane=1, politeness=0.5), 400)
    assert polite[-1, :, 1].tolist()[:2] == [3.5, 0]  # the slow one makes way
    right = run(traffic(new_part, [slow, fast], minds_host=False, left_lane=1, politeness=0.5, keep_right=5.0), 400)
    assert right[:, 0, 1].max() == 0
    assert not overtakes(left_lane=0)
    assert not overtakes(change_threshold=5.0)
    beside = {"station": 31.0, "speed": 15.0, "desired_speed": 15.0, "lane_number": 1}
    states = run(traffic(new_part, [slow, fast, beside], minds_host=False, left_lane=1, politeness=0.0), 400)
    begins = int(np.argmax(states[:, 1, 1] > 0))
    assert states[begins, 1, 0] - states[begins, 2, 0] > 4.5  # it is past who was beside it
    coming = {"station": -30.0, "speed": 45.0, "desired_speed": 45.0, "lane_number": 1}
    part = traffic(new_part, [slow, fast, coming], minds_host=False, left_lane=1, politeness=0.0)
    states = run(part, 400)
    begins = int(np.argmax(states[:, 1, 1] > 0))
    assert begins > 0
    assert states[begins, 2, 0] > states[begins, 1, 0]  # it lets the faster one pass first
    # With the host for the slow one.
    part = traffic(new_part, [fast], left_lane=1)
    part["lane.station"], part["motion.speed"] = 200.0, 0.0
    states = run(part, 400)
    assert states[-1, 0, 1] == 3.5
    assert states[-1, 0, 0] > 210
    part = traffic(new_part, [fast], left_lane=1, minds_host=False)
    part["lane.station"], part["motion.speed"] = 200.0, 0.0
    assert run(part, 400)[:, 0, 1].max() == 0


@pytest.mark.thorough
def test_on_a_ring_the_platoon_goes_round_and_never_touches(new_part: NewPart) -> None:
    cars = [{"station": 25.0 * i, "speed": 0.0, "max_acceleration": 1.0 + 0.1 * i} for i in range(8)]
    states = run(traffic(new_part, cars, minds_host=False, lap_length=200.0), 20_000)
    ahead = np.roll(states[:, :, 0], -1, axis=1)
    ahead[:, -1] += 200
    assert (ahead - states[:, :, 0] - 4.5).min() > 1
    assert states[-1, :, 0].min() > 10 * 200


@pytest.mark.parametrize(("width", "follows"), [(3.0, False), (4.0, True)])
def test_the_host_is_in_another_lane_where_lanes_have_become_wider(
    new_part: NewPart, width: float, follows: bool
) -> None:
    """8 m to the left is the middle of the third lane if lanes are 4 m wide, and beside it if they are 3 m wide."""
    part = traffic(new_part, [{"station": 0.0, "speed": 20.0, "desired_speed": 20.0, "lane_number": 2}], lane_width=3.0)
    part["lane.station"], part["lane.offset"], part["lane.width"] = 60.0, 8.0, width
    assert (run(part, 20)[-1, 0, 3] < 19.0) == follows
