"""The reference drivers of UN R157 against closed forms of cutting in, cutting out and braking, tick by tick."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from dse.metrics.functions import driver_gap

NewPart = Callable[..., Any]
T, FRONT, WIDTH, MASS, RADIUS, LANE = 0.01, 2.1, 1.8, 1600.0, 0.31, 3.5  # start values
COAST, JERK, FULL, REACTION = 0.4, 12.65, 7.593, 0.75
DRIVERS = ["reference_driver_cc", "reference_driver_fsm", "reference_driver_rss"]
SEEN = LANE - 0.375 - 0.72  # from the middle of the lane, where a cut-in has been evaluated


def see(part: Any, gap: float, aside: float = 0.0, along: float = 0.0, across: float = 0.0, number: int = 1) -> None:
    name = f"tracks[{number}]"
    part[f"{name}.id"], part[f"{name}.class"], part[f"{name}.width"], part[f"{name}.age"] = number, "car", WIDTH, 1.0
    part[f"{name}.x"], part[f"{name}.y"] = gap + FRONT, aside
    part[f"{name}.vx"], part[f"{name}.vy"] = along, across


class Host:
    """A car that brakes as it is told, at once; its gap to somebody is worked out exactly between two ticks."""

    def __init__(self, part: Any, speed: float) -> None:
        self.part, self.speed, self.way, self.tick, self.began = part, speed, 0.0, 0, -1
        part["motion.speed"] = speed
        part.init()

    def step(self) -> None:
        self.part["motion.speed"] = self.speed
        self.part.step(T)
        braking = self.part["deceleration"]
        if braking > COAST and self.began < 0:
            self.began = self.tick
        time = min(T, self.speed / braking) if braking else T
        self.way += self.speed * time - braking * time**2 / 2
        self.speed = max(self.speed - braking * T, 0.0)
        self.part["motion.acceleration"] = -braking if self.speed else 0.0
        self.tick += 1


def needed(closing: float, reaction: float = REACTION, coast: float = COAST) -> float:
    """The gap that is used up, against one that keeps its speed: coasting, built up, held."""
    built = (FULL - coast) / JERK
    slower = closing - coast * reaction
    slowest = slower - coast * built - JERK * built**2 / 2
    way = closing * reaction - coast * reaction**2 / 2
    if slowest <= 0:  # it ends while the brake is built up
        built = (-coast + math.sqrt(coast**2 + 2 * JERK * slower)) / JERK
        return way + slower * built - coast * built**2 / 2 - JERK * built**3 / 6
    return way + slower * built - coast * built**2 / 2 - JERK * built**3 / 6 + slowest**2 / (2 * FULL)


def cut_in(part: Any, speed: float, other: float, gap: float, sideways: float, at: float = SEEN) -> tuple[float, int]:
    """The least gap to one that changes lanes with that lateral speed, *gap* ahead when *at* from the middle; its tick.

    (None braked for: the tick is -1.)
    """
    host, least = Host(part, speed), math.inf
    first = (LANE - at) / sideways
    for k in range(1500):
        place = gap + (speed - other) * first + other * T * k
        aside = max(LANE - sideways * T * k, 0.0)
        least = min(least, place - host.way) if aside < WIDTH else least
        if least < 0:
            break
        see(part, place - host.way, aside, other, -sideways if aside else 0.0)
        host.step()
    return least, host.began


@pytest.mark.parametrize(("speed", "other"), [(16.0, 8.0), (25.0, 12.0), (31.0, 17.0)])
@pytest.mark.parametrize("sideways", [0.5, 1.2, 1.8])
def test_the_competent_driver_avoids_a_cut_in_if_and_only_if_the_closed_form_does(
    new_part: NewPart, speed: float, other: float, sideways: float
) -> None:
    closing = speed - other
    wanted = needed(closing)
    assert wanted < 2 * closing  # critical
    for more, avoided in [(2.0 * closing * T, True), (-2.0 * closing * T, False)]:
        least, began = cut_in(new_part("reference_driver_cc"), speed, other, wanted + more, sideways)
        assert (least >= 0) == avoided
        # The first sample in which he brakes: what he saw, and 75 samples on.
        assert abs(began - (math.ceil((LANE - SEEN) / sideways / T) + 75)) <= 1
        if avoided:
            assert least == pytest.approx(more, abs=2.0 * closing * T)


@pytest.mark.parametrize(("speed", "other"), [(25.0, 12.0), (31.0, 17.0)])
def test_the_component_keeps_the_gap_of_the_metric_function(new_part: NewPart, speed: float, other: float) -> None:
    gap, sideways = needed(speed - other, coast=0.0) + 1.0, 1.8
    part = new_part("reference_driver_cc", release_deceleration=0.0)
    least, began = cut_in(part, speed, other, gap, sideways)
    time = np.arange(0.0, 12.0, T)
    ahead = gap + (speed - other) * ((LANE - SEEN) / sideways - time)
    risk = (LANE - sideways * time <= SEEN) & (ahead < 2.0 * (speed - other))  # evaluated, and critical
    expected = driver_gap(time, ahead, np.full_like(time, speed), risk, REACTION, FULL, JERK)
    # A sample more or less until the braking, as above.
    assert least == pytest.approx(expected, abs=2.0 * (speed - other) * T)
    assert began > 0


def test_a_cut_in_may_be_evaluated_by_time_as_well(new_part: NewPart) -> None:
    part = new_part("reference_driver_cc", cut_in_evaluation="time")
    _, began = cut_in(part, 25.0, 12.0, 10.0, 0.5)
    assert abs(began - (math.ceil(0.375 / 0.5 / T) + 40 + 75)) <= 1


def test_wandering_in_the_next_lane_and_moving_away_are_no_risk(new_part: NewPart) -> None:
    part = new_part("reference_driver_cc")
    host = Host(part, 25.0)
    for k in range(400):
        see(part, 10.0, LANE - 0.37 * math.sin(0.02 * k), 15.0, -0.37 * 2 * math.cos(0.02 * k))
        host.step()
        assert part["stage"] == part["deceleration"] == 0
    for k in range(100):  # from the lane to the next one
        see(part, 10.0, 1.9 + 0.01 * k, 15.0, 1.0)
        host.step()
        assert part["deceleration"] == 0


def test_a_cut_in_that_is_not_critical_is_braked_for_when_it_becomes_so(new_part: NewPart) -> None:
    least, began = cut_in(new_part("reference_driver_cc"), 25.0, 15.0, 30.0, 1.8)
    assert least > 0
    # 30 m ahead at 2.405 m; critical 20 m ahead.
    assert abs(began - (math.ceil((LANE - SEEN) / 1.8 / T) + math.ceil(10 / 10.0 / T) + 75)) <= 1


def test_the_foot_coasts_builds_up_and_holds(new_part: NewPart) -> None:
    part = new_part("reference_driver_cc")
    host, found = Host(part, 30.0), []
    for k in range(300):
        see(part, 40.0, max(LANE - 1.8 * T * k, 0.0), 5.0, -1.8)
        host.step()
        host.speed = 30.0
        found.append((part["stage"], part["deceleration"], part["brake_torque"]))
    first = next(k for k, row in enumerate(found) if row[0])
    assert abs(first - (LANE - SEEN) / 1.8 / T) <= 1
    for k, (stage, deceleration, torque) in enumerate(found[first:]):
        expected = COAST if k < 75 else min(COAST + JERK * T * (k - 74), FULL)
        if 3 < k < 75:
            assert (stage, deceleration) == (1, COAST)
        if k >= 75:
            assert stage == 3
            assert deceleration == pytest.approx(expected, rel=1e-12)
        assert torque == pytest.approx(MASS * deceleration * RADIUS, rel=1e-12)


@pytest.mark.parametrize("sideways", [0.6, 1.5])
def test_behind_a_cut_out_who_stands_is_seen_when_the_leader_has_wandered_off(
    new_part: NewPart, sideways: float
) -> None:
    """Headway 2 s behind the leader; he uncovers one who stands."""
    speed, part = 16.0, new_part("reference_driver_cc")
    host, leaves = Host(part, speed), 100
    for k in range(700):
        aside = min(max(sideways * T * (k - leaves), 0.0), LANE)
        see(part, 10.0 + speed * T * k - host.way, aside, speed, sideways if 0 < aside < LANE else 0.0)
        see(part, 30.0 + speed * T * leaves - host.way, number=2)
        host.step()
    seen = leaves + math.ceil(0.375 / sideways / T)
    assert abs(host.began - (seen + 40 + 75)) <= 2


@pytest.mark.parametrize("braking", [5.5, 8.0])
def test_a_leader_who_brakes_hard_at_a_headway_of_two_seconds_is_braked_for(new_part: NewPart, braking: float) -> None:
    speed, part = 25.0, new_part("reference_driver_cc", acceleration_lag=0.0)
    host, gap = Host(part, speed), 2 * speed - 0.5
    way, least = gap, gap
    for k in range(1500):
        other = max(speed - braking * T * max(k - 50, 0), 0.0)
        see(part, way - host.way, along=other)
        host.step()
        way += other * T
        least = min(least, way - host.way)
    assert host.began == 51 + 40 + 75
    # Both stop: v^2/(2 b) of the leader, and what the driver needs from v after 0.01 + 0.4 s.
    left = gap + speed**2 / (2 * braking) - speed * (0.4 + T) - needed(speed)
    assert least == pytest.approx(max(left, 0), abs=0.5) if left > 0 else least < 0.5


def test_a_leader_who_brakes_gently_is_left_until_the_collision_is_two_seconds_off(new_part: NewPart) -> None:
    speed, part = 25.0, new_part("reference_driver_cc", acceleration_lag=0.0)
    host = Host(part, speed)
    way, critical = 49.5, -1
    for k in range(600):
        other = max(speed - 4.0 * T * max(k - 50, 0), 0.0)
        see(part, way - host.way, along=other)
        closing = host.speed - other
        if critical < 0 and way - host.way < 2 * closing:
            critical = k
        host.step()
        way += other * T
    assert host.began == critical + 75


@pytest.mark.parametrize("name", DRIVERS)
def test_every_driver_stops_in_time_and_holds_and_lets_go(new_part: NewPart, name: str) -> None:
    part = new_part(name)
    host = Host(part, 15.0)
    for _ in range(1000):
        see(part, 80.0 - host.way)
        host.step()
        if not host.speed:
            break
    assert host.way < 80.0
    if name == "reference_driver_rss":  # which finds low speeds safe and creeps on
        return
    assert host.speed == 0
    assert part["deceleration"] > 0
    part["tracks[1].id"] = 0
    for _ in range(199):
        host.step()
        assert part["stage"] > 1
    host.step()
    assert part["stage"] == part["deceleration"] == 0


@pytest.mark.parametrize("name", DRIVERS)
def test_who_changes_his_place_among_the_tracks_is_the_same(new_part: NewPart, name: str) -> None:
    rows = []
    for swapped in (False, True):
        part = new_part(name)
        host, row = Host(part, 25.0), []
        for k in range(300):
            number = 1 + (k // 7) % 8 if swapped else 1
            for n in range(1, 9):
                part[f"tracks[{n}].id"] = 0
            see(part, 30.0 + 12.0 * T * k - host.way, max(LANE - 1.0 * T * k, 0.0), 12.0, -1.0, number)
            part[f"tracks[{number}].id"] = 5
            host.step()
            row.append((part["stage"], part["deceleration"]))
        rows.append(row)
    assert rows[0] == rows[1]


def test_two_tracks_of_one_car_do_not_hide_each_other(new_part: NewPart) -> None:
    began = []
    for two in (False, True):
        part = new_part("reference_driver_cc")
        host = Host(part, 13.0)
        for k in range(600):
            see(part, 90.0 - host.way)
            if two:
                see(part, 90.0 - host.way + 0.3 * (-1) ** k, number=2)
            host.step()
        began.append(host.began)
    assert abs(began[0] - began[1]) <= 2
    assert host.way < 90.0


def fuzzy(gap: float, u: float, w: float, a: float) -> float:
    """The deceleration that the fuzzy metrics ask for, from the formulas of Mattas et al. (2020)."""
    r, low, high, lead = 0.75, 4.0, 6.0, 7.0
    felt = max(a, -low)

    def share(x: float, safe: float, unsafe: float) -> float:
        return min(max((safe - x) / (safe - unsafe), 0.0), 1.0) if safe > unsafe else float(x < unsafe)

    cfs = 0.0
    if u > w:
        if u + r * felt < w:
            cfs = float(gap < (u - w) ** 2 / abs(2 * a))
        else:
            meanwhile, later = (u + felt * r / 2 - w) * r, (u + felt * r - w) ** 2
            cfs = share(gap, meanwhile + later / (2 * low), meanwhile + later / (2 * high))
    stop = w**2 / (2 * lead)
    pfs = share(gap - 2, u * r + u**2 / (2 * low) - stop + 2, u * r + u**2 / (2 * high) - stop)
    return low + cfs * (high - low) if cfs > 0 else pfs * low


@pytest.mark.parametrize("u", [8.0, 20.0, 33.0])
@pytest.mark.parametrize("w", [0.0, 6.0, 19.0])
@pytest.mark.parametrize("a", [-5.0, -1.0, 0.0, 1.5])
def test_the_fuzzy_driver_brakes_as_the_metrics_of_the_paper_ask(
    new_part: NewPart, u: float, w: float, a: float
) -> None:
    part = new_part("reference_driver_fsm", jerk=200.0, reaction_time=0.75)
    part["motion.speed"], part["motion.acceleration"] = u, a
    met = set()
    for gap in (1.0, 3.0, 6.0, 9.0, 14.0, 20.0, 27.0, 35.0, 50.0, 70.0, 100.0, 130.0, 300.0):
        part.init()
        for _ in range(150):
            see(part, gap, along=w)
            part.step(T)
        expected = fuzzy(gap, u, w, a)
        assert part["deceleration"] == pytest.approx(expected, abs=1e-9)
        assert part["stage"] == (0 if not expected else 2 if expected <= 4 else 3) or expected == 4
        met.add(expected)
    assert len(met) > 2 or u < w


def test_the_fuzzy_driver_heeds_who_comes_over_in_time_only(new_part: NewPart) -> None:
    """At 1 m from the car's side with 0.5 m/s, he touches it in 2 s; it is past him by then or not."""
    for more, heeded in [(0.01, True), (-0.01, False)]:
        part = new_part("reference_driver_fsm", passing_length=12.0)
        part["motion.speed"] = 30.0
        part.init()
        see(part, (2.0 - 0.1) * 20.0 - 12.0 + more, WIDTH + 1.0, 10.0, -0.5)
        part.step(T)
        assert part["stage"] == heeded


@pytest.mark.parametrize("across", [0.0, -1.0, 1.0])
def test_the_responsible_driver_answers_below_both_safe_gaps(new_part: NewPart, across: float) -> None:
    u, w, r = 25.0, 15.0, 0.75
    ahead = u * r + 3 * r**2 / 2 + (u + 3 * r) ** 2 / 12 - w**2 / 12
    later = abs(across) + r
    beside = 0.3 + (abs(across) + later) * r / 2 + later**2 / 2
    for more, further, expected in [(-0.01, -0.01, 1), (0.01, -0.01, 0), (-0.01, 0.01, 0)]:
        part = new_part("reference_driver_rss")
        part["motion.speed"] = u
        part.init()
        see(part, ahead + more, WIDTH + beside + further, w, across)
        part.step(T)
        assert part["stage"] == expected


def test_a_pedestrian_who_will_be_in_the_way_is_evaluated_and_braked_for(new_part: NewPart) -> None:
    part = new_part("reference_driver_cc")
    host = Host(part, 12.0)
    for k in range(250):
        see(part, 20.0 - host.way, -1.8 + 1.0 * T * k, 0.0, 1.0)
        part["tracks[1].class"] = "pedestrian"
        host.step()
    assert abs(host.began - (40 + 75)) <= 1
