"""Traffic of up to 256 road users: against numpy, and against what never may be."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from components.idm_reference import HOST, Traffic
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]
H = 0.1
MOVER = np.dtype(
    [("id", "i4"), ("class", "i4"), *((name, "f8") for name in ("length", "width", "height", "clearance")),
     ("path", "i4"),
     *((name, "f8") for name in ("lane", "station", "offset", "turn", "speed", "lateral_speed", "acceleration"))],
    align=True,
)  # fmt: skip
ALONE = {"minds_host": False}


def told(part: Any, port: str, count: int) -> Any:
    """All movers of an output at once, by their layout in C."""
    at = ctypes.addressof(part.slots[f"{port}[1].id"][1]) - ctypes.addressof(part.memory)
    return np.frombuffer(bytes(part.memory), MOVER, count, at)


def everyone(part: Any) -> Any:
    return told(part, "everyone", 256)


def run(part: Any, steps: int, h: float = H) -> tuple[Any, Any]:
    """Everyone, and the eight who are told; rows are steps."""
    part.init()
    states = [(everyone(part), told(part, "movers", 8))]
    for _ in range(steps):
        part.step(h)
        states.append((everyone(part), told(part, "movers", 8)))
    return np.array([one for one, _ in states]), np.array([eight for _, eight in states])


def compared(new_part: NewPart, count: int, lanes: int, steps: int, **parameters: Any) -> int:
    """Lane changes that both made."""
    lap = 40.0 * count / lanes
    given_ = {"count": count, "closed": True, "path_length": lap, "left_lane": lanes - 1, "truck_share": 0.2}
    part = new_part("stream_traffic", **ALONE, **given_, speed_spread=0.0, decision_period=0.0, **parameters)
    part.init()
    start = everyone(part)[:count]

    def column(values: Any, host: float) -> Any:
        return np.append(values, host).astype(float)

    trucks = start["class"] == 2
    driver = np.array([[23 if truck else 30, 1.5, 2, 0.75 if truck else 1.5, 2] for truck in trucks])
    lane = column(np.rint(start["offset"] / 3.5), 0).astype(int)
    reference = Traffic(
        column(np.ones(count), 0) > 0, column(start["station"], 0), column(start["speed"], 0), lane,
        column(start["length"], 4.6), driver, lap=lap, lanes=(0, lanes - 1), old=lane.copy(),
    )  # fmt: skip
    changes = 0
    for _ in range(steps):
        part.step(H)
        before = reference.lane.copy()
        reference.step(H)
        changes += int((before != reference.lane).sum())
        now = everyone(part)[:count]
        assert np.allclose(now["station"], reference.x[:HOST], rtol=0, atol=1e-7)
        assert np.allclose(now["speed"] * np.cos(now["turn"]), reference.v[:HOST], rtol=0, atol=1e-7)
        assert np.allclose(now["offset"], reference.offsets()[:HOST], rtol=0, atol=1e-7)
    return changes


def test_200_vehicles_drive_as_an_independent_implementation_does(new_part: NewPart) -> None:
    assert compared(new_part, 200, 1, 60) == 0
    assert compared(new_part, 60, 3, 25) > 0


def test_a_car_of_a_shared_world_is_to_the_traffic_what_the_host_is(new_part: NewPart) -> None:
    road = {
        "count": 40,
        "closed": True,
        "path_length": 1500.0,
        "left_lane": 1,
        "decision_period": 0.0,
        "start_to": 1200,
    }
    alone, shared = new_part("stream_traffic", **road), new_part("stream_traffic", **road, **ALONE)
    station, behind, lanes = 1350.0, [], []
    for k in range(300):
        speed = max(25.0 - 0.2 * k, 4.0)
        alone["lane.station"], alone["motion.speed"] = station, speed
        for name, value in (("length", 4.6), ("width", 1.8), ("station", station), ("speed", speed)):
            shared[f"hosts[3].{name}"] = value
        for part in (alone, shared):
            part.step(H) if k else part.init()
        station = (station + speed * H) % 1500.0
        one, other = everyone(alone)[:40], everyone(shared)[:40]
        assert np.allclose(one["station"], other["station"], rtol=0, atol=1e-6)
        assert np.array_equal(np.rint(one["offset"]), np.rint(other["offset"]))
        behind.append(np.min(np.where(one["offset"] < 1, (station - one["station"]) % 1500.0, np.inf)))
        lanes.append(np.rint(one["offset"] / 3.5))
    assert min(behind) < 40  # somebody had to follow it
    assert np.any(np.diff(lanes, axis=0))


def test_each_car_of_a_shared_world_gets_room_where_it_joins_and_is_never_hit(new_part: NewPart) -> None:
    part = new_part("stream_traffic", **ALONE, count=60, closed=True, path_length=1600.0, left_lane=1)
    part.init()
    hosts = {1: (400.0, 0.0, 0.0), 2: (1000.0, 3.5, 6.0), 16: (1040.0, 0.0, 12.0)}  # station, offset, speed
    for k in range(1, 500):
        if k == 20:
            near = [h[0] for h in hosts.values()]
            assert min(abs(s - near[0]) for s in everyone(part)["station"][:60]) < 30
        for number, (station, offset, speed) in hosts.items():
            if k >= 20:
                values = {"length": 4.6, "width": 1.8, "station": station, "offset": offset, "speed": speed}
                for name, value in values.items():
                    part[f"hosts[{number}].{name}"] = value
        part.step(H)
        now = everyone(part)
        now = now[now["class"] > 0]
        for number, (station, offset, speed) in hosts.items():
            if k >= 20:
                apart = np.abs((now["station"] - station + 800) % 1600 - 800)
                assert k > 20 or apart.min() > 59
                is_beside = np.abs(now["offset"] - offset) < (now["width"] + 1.8) / 2
                assert not np.any(is_beside & (apart < (now["length"] + 4.6) / 2)), (k, number)
                hosts[number] = ((station + speed * H) % 1600, offset, speed)
    assert np.sum(now["speed"] < 0.5) > 3  # behind the one that stands


@pytest.mark.thorough
def test_200_vehicles_change_lanes_as_an_independent_implementation_does(new_part: NewPart) -> None:
    assert compared(new_part, 200, 3, 250) > 40


POPULATION = {
    "seed": st.integers(0, 10**9), "count": st.integers(0, 120), "left_lane": st.integers(0, 2),
    "closed": st.booleans(), "path_length": st.floats(900, 3000), "truck_share": st.floats(0, 0.5),
    "speed_spread": st.floats(0, 0.3), "cyclists": st.integers(0, 4), "pedestrians": st.integers(0, 6),
    "crossing_share": st.floats(0, 1), "minds_host": st.booleans(), "time_gap": st.floats(0.8, 2.5),
}  # fmt: skip


def driven(new_part: NewPart, given_: Mapping[str, Any], steps: int) -> tuple[Any, Any]:
    """Among them the host, who drives unevenly and stands for a while."""
    lanes, length = given_["left_lane"] + 1, given_["path_length"]
    most = lanes * int(length / (14.1 + 12))
    part = new_part("stream_traffic", **{**given_, "count": min(given_["count"], most)})
    station, states = 200.0, []
    for k in range(steps):
        speed = max(0.0, 14 + 16 * math.cos(k * H / 9))
        part["lane.station"], part["motion.speed"] = station, speed
        part.step(H) if k else part.init()
        states.append((everyone(part), told(part, "movers", 8)))
        station += speed * H
        station = station % length if given_["closed"] else station
    return np.array([one for one, _ in states]), np.array([eight for _, eight in states])


def never_jumps(states: Any) -> None:
    """By place and id: who has the same id in the same place as a step before went no farther than its speed says."""
    before, after = states[:-1], states[1:]
    same = (before["id"] == after["id"]) & (before["class"] > 0) & (after["class"] > 0)
    assert not ((before["class"] > 0) & (after["class"] > 0) & ~same & (before["station"] < after["station"])).any()
    speed = np.maximum(before["speed"], after["speed"])
    along, aside = after["station"] - before["station"], after["offset"] - before["offset"]
    assert (np.hypot(along, aside)[same] <= H * speed[same] * 1.0001 + 1e-9).all()
    vehicles = same & (after["class"] < 4)
    assert (along[vehicles] >= 0).all()
    assert (np.abs(aside)[vehicles] <= 0.3 * along[vehicles] + 1e-9).all()
    for name in ("class", "length", "width", "height", "path"):
        assert (before[name] == after[name])[same].all()


@pytest.mark.thorough
def test_nobody_ever_jumps_and_a_place_is_empty_before_another_one_takes_it(new_part: NewPart) -> None:
    came = []

    @settings(max_examples=12, deadline=None, derandomize=True)
    @given(**POPULATION)
    def check(**given_: Any) -> None:
        everyone_, eight = driven(new_part, given_, 300)
        never_jumps(everyone_)
        never_jumps(eight)
        changed = (eight["id"][:-1] != eight["id"][1:]) & (eight["id"][:-1] > 0)
        assert (eight["id"][1:][changed] == 0).all()
        came.append(int(changed.sum()))
        for all_, few in zip(everyone_[::20], eight[::20], strict=True):
            present = few[few["class"] > 0]
            assert len(np.unique(present["id"])) == len(present)
            assert set(present.tolist()) <= set(all_.tolist())  # who is told is told the same in both
        ids = everyone_["id"][everyone_["class"] > 0]
        for id_ in np.unique(ids)[:20]:  # an id has one place, without holes
            rows, places = np.nonzero((everyone_["id"] == id_) & (everyone_["class"] > 0))
            assert len(set(places)) == 1
            assert (np.diff(rows) == 1).all()

    check()
    assert sum(came) > 20


@pytest.mark.thorough
def test_nobody_touches_another_one_where_no_lanes_are_changed(new_part: NewPart) -> None:
    @settings(max_examples=10, deadline=None, derandomize=True)
    @given(**POPULATION)
    def check(**given_: Any) -> None:
        states, _ = driven(new_part, {**given_, "left_lane": 0, "change_threshold": 5.0}, 500)
        lap = given_["path_length"]
        for state in states[::5]:
            cars = state[(state["class"] > 0) & (state["class"] < 4)]
            key = cars["station"] % lap if given_["closed"] else cars["station"]
            cars, key = cars[np.argsort(key)], np.sort(key)
            ahead = np.append(key[1:], key[:1] + (lap if given_["closed"] else math.inf))
            reach = (cars["length"] + np.roll(cars["length"], -1)) / 2
            assert (ahead - key > reach).all()

    check()


def test_the_eight_are_those_around_the_host(new_part: NewPart) -> None:
    part = new_part("stream_traffic", count=90, closed=True, path_length=3000.0, left_lane=2, seed=3)
    part["lane.station"], part["motion.speed"] = 1500.0, 20.0
    part.init()
    for k in range(300):
        part["lane.station"] = 1500.0 + 20 * H * k
        part.step(H)
    all_, eight = everyone(part), told(part, "movers", 8)
    way = (all_["station"] - part["lane.station"] + 1500) % 3000 - 1500
    for lane in range(3):
        here = (np.rint(all_["offset"] / 3.5) == lane) & (all_["class"] > 0)
        assert all_["id"][here & (way > 0)][np.argmin(way[here & (way > 0)])] in eight["id"]
    assert (eight["class"] > 0).sum() >= 7


def test_a_population_is_what_its_numbers_say(new_part: NewPart) -> None:
    part = new_part(
        "stream_traffic", **ALONE, count=200, path_length=4000.0, left_lane=1, truck_share=0.25, motorcycle_share=0.1,
        cyclists=5, pedestrians=12, crossing_share=0.5, start_from=500.0, start_to=3500.0,
    )  # fmt: skip
    part["path_share[2]"] = 1.0  # two paths, half on each
    states, _ = run(part, 1)
    first = states[0][states[0]["class"] > 0]
    assert len(first) == 217
    assert np.bincount(first["class"], minlength=6)[4:].tolist() == [5, 12]
    assert np.bincount(first["class"])[2] == pytest.approx(50, abs=18)  # three standard deviations
    assert np.bincount(first["path"]).tolist() == [117, 100]
    assert first["station"].min() >= 500
    assert first["station"].max() <= 3500
    density = new_part("stream_traffic", **ALONE, density=0.02, path_length=3000.0, left_lane=1)
    density.init()
    assert (everyone(density)["class"] > 0).sum() == 120
    part = new_part("stream_traffic", **ALONE, count=40, path_length=3000.0, desired_speed=20.0, truck_share=0.0)
    states, _ = run(part, 1500)
    speeds = states[-1]["speed"][states[-1]["class"] > 0]
    assert 13 < speeds.mean() < 20  # who is fast follows who is slow


def test_another_seed_is_another_traffic_and_the_same_one_the_same(new_part: NewPart) -> None:
    one, two, other = (
        run(new_part("stream_traffic", **ALONE, seed=seed, left_lane=1), 60)[0] for seed in (5, 5, 6)
    )  # fmt: skip
    assert all((one[name] == two[name]).all() for name in one.dtype.names)
    assert (one["station"] != other["station"]).any()


def test_who_reaches_the_end_leaves_and_somebody_new_comes_in_at_the_start(new_part: NewPart) -> None:
    part = new_part("stream_traffic", **ALONE, count=30, path_length=900.0, truck_share=0.0, speed_spread=0.05)
    states, _ = run(part, 1200)
    present = states["class"] > 0
    assert states["id"].max() > 60
    assert present.sum(axis=1)[600:].min() > 15
    assert (states["station"] + states["length"] / 2)[present].max() < 900 + 40 * H
    new = present[1:] & (states["id"][1:] != states["id"][:-1])
    assert (states["station"][1:][new] < 2.25 + 40 * H).all()


def test_what_does_not_fit_on_the_road_is_no_number(new_part: NewPart) -> None:
    for hostile in (
        {"count": 200, "path_length": 300.0}, {"count": 256, "cyclists": 1}, {"density": 0.2}, {"start_to": 3e3},
        {"start_from": 1000.0, "start_to": 900.0}, {"path_length": math.nan},
    ):  # fmt: skip
        part = new_part("stream_traffic", **ALONE, **hostile)
        part.init()
        part.step()
        assert math.isnan(part["movers[1].station"]), hostile


def test_who_crosses_waits_for_a_gap_and_is_braked_for(new_part: NewPart) -> None:
    part = new_part(
        "stream_traffic", **ALONE, count=25, path_length=1500.0, closed=True, left_lane=1, pedestrians=20,
        crossing_share=1.0, desired_speed=12.0, truck_speed=11.0,
    )  # fmt: skip
    states, _ = run(part, 1500)
    people = states["class"] == 5
    walking = people & (states["speed"] > 0)
    assert walking.sum() > 500
    cars = (states["class"] > 0) & (states["class"] < 4)
    for state, who, car in zip(states[::3], walking[::3], cars[::3], strict=True):
        way = np.abs((state["station"][car][:, None] - state["station"][who] + 750) % 1500 - 750)
        aside = np.abs(state["offset"][car][:, None] - state["offset"][who])
        touch = (way < state["length"][car][:, None] / 2 + 0.25) & (aside < state["width"][car][:, None] / 2 + 0.25)
        assert not touch.any()
