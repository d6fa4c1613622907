"""Traffic at lights and where paths meet, told by hand: who can stop does, and nobody drives into another one."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest
from components.test_stream_traffic import everyone
from hypothesis import given, settings, strategies as st

NewPart = Callable[..., Any]
H = 0.05
LINE = 300.0
RED, YELLOW, GREEN = "red", "yellow", "green"
FRONT = 2.25


def traffic(new_part: NewPart, vehicles: Sequence[Mapping[str, float]], **parameters: Any) -> Any:
    part = new_part("idm_traffic", **{"minds_host": False, **parameters})
    for i, vehicle in enumerate(vehicles, 1):
        part[f"class[{i}]"] = 1
        for name, value in vehicle.items():
            part[f"{name}[{i}]"] = value
    return part


def set_light(part: Any, colour: str, path: int = 0, line: float = LINE, number: int = 1) -> None:
    part[f"light_heads[{number}].path"] = path
    part[f"light_heads[{number}].station"] = line
    part[f"light_heads[{number}].colour"] = colour


def set_conflicts(part: Any, entry: float = 200.0, way: float = 6.0, gives_way: int | None = 0) -> None:
    """Paths 0 and 1 cross; both see it."""
    for path in (0, 1):
        for name, value in {
            "path": path, "other_path": 1 - path, "gives_way": path == gives_way,
            "entry": entry, "exit": entry + way, "other_entry": entry, "other_exit": entry + way,
        }.items():  # fmt: skip
            part[f"conflicts[{path + 1}].{name}"] = value


def places(part: Any, count: int) -> Any:
    """Rows are vehicles; stations of their fronts, speeds."""
    return np.array([
        [part[f"movers[{i + 1}].station"] + part[f"length[{i + 1}]"] / 2, part[f"movers[{i + 1}].speed"]]
        for i in range(count)
    ])  # fmt: skip


PLATOON = st.lists(
    st.fixed_dictionaries({
        "speed": st.floats(3, 25), "desired_speed": st.floats(8, 30), "max_acceleration": st.floats(0.8, 2.5),
        "comfortable_deceleration": st.floats(1, 4), "time_gap": st.floats(0.8, 2),
    }),
    min_size=1, max_size=6,
)  # fmt: skip


@pytest.mark.thorough
def test_nobody_runs_a_light_who_could_have_stopped(new_part: NewPart) -> None:
    seen = {"stops": 0, "passes": 0, "runs red": 0}

    @settings(max_examples=40, deadline=None, derandomize=True)
    @given(vehicles=PLATOON, green=st.floats(0.5, 12), yellow=st.floats(0.5, 6))
    def check(vehicles: list[dict[str, float]], green: float, yellow: float) -> None:
        cars = [{**car, "station": 200 - 70.0 * i} for i, car in enumerate(vehicles)]
        part = traffic(new_part, cars)
        yellow_at, red_at, again_at = int(green / H), int((green + yellow) / H), int((green + yellow) / H) + 500
        braking = np.array([car["comfortable_deceleration"] for car in cars])
        set_light(part, GREEN)
        part.init()
        states = [places(part, len(cars))]
        for k in range(1, again_at):
            set_light(part, RED if k > red_at else YELLOW if k > yellow_at else GREEN)
            part.step(H)
            states.append(places(part, len(cars)))
        rows = np.array(states)
        way, speed = LINE - rows[:, :, 0], rows[:, :, 1]
        stops = (way[yellow_at] >= 0) & (way[yellow_at] >= speed[yellow_at] + speed[yellow_at] ** 2 / (2 * braking))
        possible = (way[red_at] >= 0) & (way[red_at] >= speed[red_at] ** 2 / 18 + 1e-9)
        passed_on_red = (way[red_at] >= 0) & (way[-1] < 0)
        assert not (passed_on_red & (stops | possible)).any()
        assert not (stops & (way[red_at] < 0)).any()
        late = way[red_at + 1 :] < 0  # who passes on red could not have stopped a step before, either
        seen["stops"] += int((way[-1] >= 0).sum())
        seen["passes"] += int((way[red_at] < 0).sum())
        seen["runs red"] += int(passed_on_red.sum())
        assert late[-1].sum() == (way[-1] < 0).sum()
        first = np.flatnonzero(way[-1] >= 0)[:1]
        assert (speed[-1][first] < 0.5).all()
        assert (way[-1][first] < 60).all()  # it has driven up to the line
        set_light(part, GREEN)
        for _ in range(900):
            part.step(H)
        assert (places(part, len(cars))[:, 0] > LINE).all()

    check()
    assert min(seen["stops"], seen["passes"]) > 5, seen


def test_who_brakes_for_yellow_does_so_by_its_comfortable_deceleration(new_part: NewPart) -> None:
    way = 15 + 15**2 / 4
    for further, stops in ((0.5, True), (-0.5, False)):
        part = traffic(new_part, [{"station": LINE - way - further - FRONT, "speed": 15.0, "desired_speed": 15.0}])
        set_light(part, YELLOW)
        part.init()
        accelerations = []
        for _ in range(400):
            part.step(H)
            accelerations.append(part["movers[1].acceleration"])
        assert (places(part, 1)[0, 0] < LINE) == stops
        assert min(accelerations) > -3.2
        if stops:
            assert LINE - places(part, 1)[0, 0] == pytest.approx(2, abs=0.2)  # the standstill gap


def passing(new_part: NewPart, headway: float, minors: int = 3) -> tuple[list[float], list[float]]:
    """When the minor and the major ones come to the place, in s."""
    majors = 8 - minors
    cars = [
        *({"station": 190 - 8.0 * i, "speed": 0.0, "desired_speed": 12.0} for i in range(minors)),
        *({"path": 1, "station": 200 - 15 * headway * (i + 0.3), "speed": 15.0, "desired_speed": 15.0}
          for i in range(majors)),
    ]  # fmt: skip
    part = traffic(new_part, cars)
    set_conflicts(part)
    part.init()
    fronts = []
    for _ in range(int((headway * majors + 40) / H)):
        part.step(H)
        fronts.append(places(part, 8)[:, 0])
    times = (np.array(fronts) < 200).sum(axis=0) * H
    return sorted(times[:minors]), sorted(times[minors:])


def test_who_gives_way_takes_gaps_from_the_critical_one_on(new_part: NewPart) -> None:
    minor, major = passing(new_part, 6.0)
    assert minor[0] > major[-1]  # 6 s are too short for all of them
    minor, major = passing(new_part, 9.0)
    assert major[0] < minor[0] < major[1]
    rests = [min(t - m for t in [*major, np.inf] if t > m) for m in minor]
    assert min(rests) > 6.5 - 2.0  # it takes up to 2 s from the line to the border
    minor, major = passing(new_part, 14.0)
    inside = [m for m in minor if major[0] < m < major[1]]
    assert len(inside) >= 2
    assert 1.5 < inside[1] - inside[0] < 4.5  # the follow-up time, 2.2 to 4 s in the manual
    assert all(np.diff(major) < 14.5)  # who has the right of way is not held up


def test_who_has_the_right_of_way_but_stops_at_a_light_is_not_waited_for(new_part: NewPart) -> None:
    def passes(colour: str) -> float:
        cars = [
            {"station": 190.0, "speed": 0.0, "desired_speed": 12.0},
            {"path": 1, "station": 140.0, "speed": 10.0, "desired_speed": 12.0},
        ]
        part = traffic(new_part, cars)
        set_conflicts(part)
        set_light(part, colour, path=1, line=195.0)
        part.init()
        for k in range(1200):
            part.step(H)
            if places(part, 2)[0, 0] > 200:
                return k * H
        return np.inf

    assert passes(RED) < 4
    assert passes(GREEN) > 5


def test_the_host_is_waited_for_and_it_is_not_driven_into(new_part: NewPart) -> None:
    for standing in (False, True):
        part = traffic(new_part, [{"path": 1, "station": 150.0, "speed": 12.0, "desired_speed": 12.0}], minds_host=True)
        set_conflicts(part, gives_way=1)
        station = 202.0 if standing else 130.0
        part["lane.station"], part["motion.speed"] = station, 0.0 if standing else 12.0
        part.init()
        for _ in range(1200):
            station += 0 if standing else 12 * H
            part["lane.station"] = station
            part.step(H)
            front = places(part, 1)[0, 0]
            host_inside = station + 2.3 > 200 and station - 2.3 < 206
            assert not (host_inside and front > 200 and front - 4.5 < 206)
        assert (front < 200) == standing


def test_nobody_drives_into_another_one_where_paths_cross(new_part: NewPart) -> None:
    passed = []

    @settings(max_examples=10, deadline=None, derandomize=True)
    @given(
        seed=st.integers(0, 10**6), count=st.integers(10, 40), critical=st.floats(3, 8), way=st.floats(2, 12),
        gives_way=st.sampled_from([0, 1]), speed=st.floats(8, 20),
    )  # fmt: skip
    def check(seed: int, count: int, critical: float, gives_way: int, way: float, speed: float) -> None:
        part = new_part(
            "stream_traffic", minds_host=False, count=count, path_length=600.0, seed=seed, critical_gap=critical,
            desired_speed=speed, truck_speed=speed,
        )  # fmt: skip
        part["path_share[2]"] = 1.0
        set_conflicts(part, 300.0, way, gives_way)
        part.init()
        ids = set()
        for _ in range(600):
            part.step(0.1)
            now = everyone(part)
            front, rear = now["station"] + now["length"] / 2, now["station"] - now["length"] / 2
            inside = (now["class"] > 0) & (front > 300) & (rear < 300 + way)
            assert len(set(now["path"][inside])) < 2
            ids |= set(now["id"][inside & (now["path"] == gives_way)])
        passed.append(len(ids))

    check()
    assert sum(passed) > 10


def test_what_the_road_tells_of_its_paths_takes_the_place_of_parameters(new_part: NewPart) -> None:
    cars = [{"station": 20.0 * i, "speed": 10.0, "desired_speed": 12.0 + i} for i in range(5)]
    said = traffic(new_part, cars, lap_length=130.0, lane_width=3.0, left_lane=1)
    found = traffic(new_part, cars)
    for name, value in {"length": 130.0, "closed": True, "leftmost": 1, "rightmost": 0, "lane_width": 3.0}.items():
        found[f"paths[1].{name}"] = value
    said.init()
    found.init()
    for _ in range(600):
        said.step(H)
        found.step(H)
    ports = [f"movers[{i}].{name}" for i in range(1, 6) for name in ("station", "offset", "speed")]
    assert [said[name] for name in ports] == [found[name] for name in ports]
    assert max(said[f"movers[{i}].offset"] for i in range(1, 6)) == pytest.approx(3, abs=0.01)


def test_who_joins_follows_those_on_the_other_path_and_nobody_touches(new_part: NewPart) -> None:
    joined = []

    @settings(max_examples=8, deadline=None, derandomize=True)
    @given(
        seed=st.integers(0, 10**6), count=st.integers(10, 40), gives_way=st.sampled_from([0, 1]), way=st.floats(4, 12),
        speed=st.floats(8, 20),
    )  # fmt: skip
    def check(seed: int, count: int, gives_way: int, way: float, speed: float) -> None:
        part = new_part(
            "stream_traffic", minds_host=False, count=count, path_length=600.0, seed=seed, desired_speed=speed,
            truck_speed=0.8 * speed,
        )  # fmt: skip
        part["path_share[2]"] = 1.0
        part["together[1]"] = part["together[2]"] = 500.0
        set_conflicts(part, 300.0, way, gives_way)
        part.init()
        mixed = 0
        for _ in range(600):
            part.step(0.1)
            now = everyone(part)
            behind = now[(now["class"] > 0) & (now["station"] - now["length"] / 2 > 300 + way)]
            behind = behind[np.argsort(behind["station"])]
            gaps = np.diff(behind["station"]) - (behind["length"][1:] + behind["length"][:-1]) / 2
            assert (gaps > 0).all()
            mixed += int((np.diff(behind["path"]) != 0).sum())
        joined.append(mixed)

    check()
    assert sum(joined) > 100
