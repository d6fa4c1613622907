"""The emergency brakes against closed forms of stopping, crossing and passing, and their own rules tick by tick."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

NewPart = Callable[..., Any]
T, FRONT, WIDTH, MASS, RADIUS = 0.01, 2.1, 1.8, 1600.0, 0.31  # start values
NONE, WARNING, PARTIAL, FULL = range(4)
KMH = 1 / 3.6
LATE = {"partial_ttc": 0.0, "partial_required": 20.0, "partial_deceleration": 0.0}  # the first stage never comes first


def see(
    part: Any, gap: float, aside: float = 0.0, along: float = 0.0, across: float = 0.0, number: int = 1, **more: Any
) -> None:
    """One object as track *number*: *gap* ahead of the bumper, *aside* to the left, its velocities over ground."""
    name = f"tracks[{number}]"
    part[f"{name}.id"], part[f"{name}.age"], part[f"{name}.existence"] = number, more.get("age", 1.0), 1.0
    part[f"{name}.class"], part[f"{name}.width"] = more.get("kind", "car"), more.get("width", 1.8)
    part[f"{name}.x"], part[f"{name}.y"] = gap + FRONT, aside
    part[f"{name}.vx"], part[f"{name}.vy"] = along, across


def begin(part: Any, speed: float, yaw_rate: float = 0.0) -> Any:
    part["motion.speed"], part["motion.yaw_rate"] = speed, yaw_rate
    part.init()
    return part


def stage(part: Any, ticks: int = 1) -> int:
    for _ in range(ticks):
        part.step(T)
    return int(part["stage"])


def beginning(closing: float, ttc: float, required: float, lost: float = 0.2, left: float = 0.5) -> float:
    """The gap at which a stage begins, as the header has it."""
    return max(ttc * closing, closing * lost + closing**2 / (2 * required) + left)


def stop(speed: float, deceleration: float, jerk: float, gap: float) -> tuple[bool, float]:
    """A deceleration that is built up with *jerk*: whether the gap is too short; what is left, or the impact speed."""
    built = deceleration / jerk
    slower = speed - jerk * built**2 / 2
    assert slower > 0
    left = gap - (speed * built - jerk * built**3 / 6)
    assert left > 0
    room = left - slower**2 / (2 * deceleration)
    return room < 0, room if room >= 0 else math.sqrt(slower**2 - 2 * deceleration * left)


def approach(part: Any, speed: float, gap: float, grip: float) -> tuple[bool, float, float]:
    """Drives at a standing car with what torque and grip give: (hit, gap left or speed, gap where braking began)."""
    begin(part, speed)
    began = math.nan
    while speed > 0:
        part["motion.speed"] = speed
        see(part, gap)
        part.step(T)
        deceleration = min(part["brake_torque"] / (MASS * RADIUS), grip)
        if deceleration and math.isnan(began):
            began = gap
        time = min(T, speed / deceleration) if deceleration else T
        if gap < speed * time - deceleration * time**2 / 2:
            return True, math.sqrt(speed**2 - 2 * deceleration * gap), began
        gap -= speed * time - deceleration * time**2 / 2
        speed = speed - deceleration * time if time == T else 0.0
    return False, gap, began


@pytest.mark.parametrize("kmh", [20, 25, 30, 35, 40, 45, 50, 55, 60])
def test_a_standing_car_is_hit_or_not_as_the_closed_form_of_stopping_says(new_part: NewPart, kmh: int) -> None:
    speed, jerk = kmh * KMH, 30.0
    verdicts = set()
    for required in (6.0, 9.0):
        for grip in (9.0, 7.0, 3.0):
            part = new_part("two_stage_aeb", full_required=required, build_up_jerk=jerk, full_ttc=0.3, **LATE)
            start = 80.0
            hit, found, began = approach(part, speed, start, grip)
            onset = beginning(speed, 0.3, required)
            assert began == pytest.approx(start - math.ceil((start - onset) / (speed * T)) * speed * T, abs=1e-9)
            # The demand rises at the beginning of a tick and is held: half a tick of the ramp earlier.
            expected_hit, expected = stop(speed, grip, jerk, began + speed * T / 2)
            verdicts.add(hit)
            assert hit == expected_hit
            if hit:
                assert found**2 == pytest.approx(expected**2, abs=0.05 * 2 * grip)
            else:
                assert found == pytest.approx(expected, abs=0.05)
    assert verdicts == {True, False}


@pytest.mark.parametrize("kmh", [20, 40, 60, 80])
def test_a_standing_car_is_not_hit_on_dry_asphalt_whichever_stages_it_takes(new_part: NewPart, kmh: int) -> None:
    hit, left, began = approach(new_part("two_stage_aeb"), kmh * KMH, 100.0, 9.0)
    assert not hit
    assert 0.3 < left < 5
    assert began <= beginning(kmh * KMH, 1.2, 4.0)


@pytest.mark.parametrize("kmh", [15, 30, 60])
@pytest.mark.parametrize("lead", [0.0, 10.0])
def test_each_stage_begins_at_the_tick_of_its_gap(new_part: NewPart, kmh: int, lead: float) -> None:
    """Nobody brakes, so that the closing speed stays; with and without a car ahead that drives."""
    closing = kmh * KMH
    part = begin(new_part("two_stage_aeb"), closing + lead)
    partial, full = beginning(closing, 1.2, 4.0), beginning(closing, 0.7, 6.0)
    gaps = {WARNING: partial + 0.9 * closing, PARTIAL: partial, FULL: full}
    first: dict[int, int] = {}
    for tick in range(3000):
        gap = 80.0 - tick * closing * T
        if gap < 0:
            break
        see(part, gap, along=lead)
        first.setdefault(stage(part), tick)
    expected = {each: math.ceil((80.0 - gap) / (closing * T)) for each, gap in gaps.items()}
    assert first == {NONE: 0} | expected
    assert (expected[PARTIAL] - expected[WARNING]) * T >= 0.8  # UN R152


def test_the_demand_rises_and_falls_by_its_jerks_and_the_torque_is_that_of_the_nominal_car(new_part: NewPart) -> None:
    part = begin(new_part("two_stage_aeb", build_up_jerk=20.0, release_jerk=50.0, release_time=0.05), 15.0)
    see(part, 5.0)
    for tick in range(1, 60):
        assert stage(part) == FULL
        assert part["deceleration"] == pytest.approx(min(20.0 * T * tick, 9.0), rel=1e-9)
        assert part["brake_torque"] == pytest.approx(MASS * RADIUS * part["deceleration"], rel=1e-12)
    see(part, 5.0, along=15.0)  # no longer approached
    assert [stage(part) for _ in range(5)] == [FULL] * 4 + [NONE]
    for tick in range(2, 30):
        part.step(T)
        assert part["deceleration"] == pytest.approx(max(9.0 - 50.0 * T * tick, 0.0), abs=1e-9)
    assert part["brake_torque"] == 0


def test_the_first_stage_demands_its_own_deceleration(new_part: NewPart) -> None:
    part = begin(new_part("two_stage_aeb"), 15.0)
    see(part, 0.5 * (beginning(15.0, 1.2, 4.0) + beginning(15.0, 0.7, 6.0)))
    assert stage(part, 100) == PARTIAL
    assert part["deceleration"] == pytest.approx(4.0)


def test_nothing_begins_below_the_least_speed_but_braking_goes_on_to_standstill_and_holds(new_part: NewPart) -> None:
    part = begin(new_part("two_stage_aeb", holding_time=1.0), 9.9 * KMH)
    see(part, 0.5)
    assert stage(part, 50) == NONE
    part["motion.speed"] = 10.1 * KMH
    assert stage(part) == FULL
    part["motion.speed"] = 1.0
    assert stage(part, 100) == FULL
    part["motion.speed"] = 0.0
    assert stage(part, 99) == FULL
    assert stage(part) == NONE
    part["motion.speed"] = 161 * KMH
    see(part, 20.0)
    assert stage(part, 50) == NONE


def test_a_warning_ends_beyond_its_hysteresis_and_does_not_flicker_within(new_part: NewPart) -> None:
    part = begin(new_part("two_stage_aeb"), 15.0)
    gap = beginning(15.0, 1.2, 4.0) + 0.9 * 15.0
    see(part, gap - 0.01)
    assert stage(part) == WARNING
    see(part, 1.15 * gap - 0.01)
    assert stage(part, 200) == WARNING
    see(part, 1.15 * gap + 0.01)
    assert stage(part, 29) == WARNING
    assert stage(part) == NONE
    see(part, gap + 0.01)
    assert stage(part, 50) == NONE


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(("kind", "width", "margin"), [("car", 1.8, 0.1), ("pedestrian", 0.5, 0.3)])
def test_what_stands_beside_the_way_is_braked_for_only_within_its_margin(
    new_part: NewPart, side: int, kind: str, width: float, margin: float
) -> None:
    edge = (WIDTH + width) / 2 + margin
    for aside, expected in [(edge + 0.01, NONE), (edge - 0.01, FULL)]:
        part = begin(new_part("two_stage_aeb"), 15.0)
        stages = set()
        for tick in range(200):
            see(part, 31.0 - 15.0 * T * tick, side * aside, width=width, kind=kind)
            stages.add(stage(part))
        assert max(stages) == expected
    see(part, 1.0, side * (edge + 0.19), width=width, kind=kind)
    assert stage(part, 100) == FULL  # once braked for, a little further out
    see(part, 1.0, side * (edge + 0.21), width=width, kind=kind)
    assert stage(part, 100) == NONE


@pytest.mark.parametrize("radius", [60.0, -60.0, 250.0])
def test_on_a_curve_the_way_bends(new_part: NewPart, radius: float) -> None:
    """A row of parked cars one lane to the outside, where a straight way would run into them; and one on the way."""
    speed = 14.0
    for aside, expected in [(3.5, {NONE}), (-3.5, {NONE}), (0.0, {NONE, WARNING, PARTIAL, FULL})]:
        part = begin(new_part("two_stage_aeb"), speed, speed / radius)
        found: set[int] = set()
        begun: dict[int, int] = {}
        for tick in range(300):
            turned, from_centre = (60.0 - speed * T * tick + FRONT) / radius, radius - aside
            x, y = from_centre * math.sin(turned), radius - from_centre * math.cos(turned)
            see(part, x - FRONT, y)
            found.add(stage(part))
            begun.setdefault(stage(part, 0), tick)
        assert found == expected
        if FULL in expected:
            assert begun[FULL] == math.ceil((60.0 - beginning(speed, 0.7, 6.0)) / (speed * T))
    # Exactly ahead of the bumper stands a car of the outer lane.
    outer = radius + math.copysign(3.5, radius)
    for yaw_rate, seen in [(speed / radius, NONE), (0.0, WARNING)]:
        part = begin(new_part("two_stage_aeb"), speed, yaw_rate)
        see(part, math.sqrt(outer**2 - radius**2) - FRONT)
        assert min(stage(part), WARNING) == seen


@pytest.mark.parametrize("aside", [0.0, 0.8, -0.8])
def test_a_car_that_drives_ahead_in_the_same_curve_counts_with_its_speed_along_it(
    new_part: NewPart, aside: float
) -> None:
    """On a circle beside the host's it covers stations of the host's circle the faster, the further inside it is."""
    radius, speed, lead = 40.0, 12.0, 6.0
    closing = speed - lead * radius / (radius - aside)
    gap = beginning(closing, 1.2, 4.0) + 0.9 * closing
    for along, expected in [(gap + 0.01, NONE), (gap - 0.01, WARNING)]:
        turned = (along + FRONT) / radius
        x, y = (radius - aside) * math.sin(turned), radius - (radius - aside) * math.cos(turned)
        part = begin(new_part("two_stage_aeb"), speed, speed / radius)
        see(part, x - FRONT, y, along=lead * math.cos(turned), across=lead * math.sin(turned))
        assert stage(part, 10) == expected


@pytest.mark.parametrize("radius", [40.0, -40.0])
@pytest.mark.parametrize("side", [1, -1])
def test_the_edge_of_the_way_bends_as_well(new_part: NewPart, radius: float, side: int) -> None:
    turned = (12.0 + FRONT) / radius
    for out, expected in [(0.01, NONE), (-0.01, FULL)]:
        from_centre = radius - side * (WIDTH + 0.1 + out)
        part = begin(new_part("two_stage_aeb"), 14.0, 14.0 / radius)
        see(part, from_centre * math.sin(turned) - FRONT, radius - from_centre * math.cos(turned))
        assert stage(part) == expected


def test_the_warning_comes_before_full_braking_that_comes_first(new_part: NewPart) -> None:
    gap = beginning(15.0, 0.7, 6.0) + 0.9 * 15.0
    for more, expected in [(0.01, NONE), (-0.01, WARNING)]:
        part = begin(new_part("two_stage_aeb", **LATE), 15.0)
        see(part, gap + more)
        assert stage(part) == expected


@pytest.mark.parametrize("kmh", [20, 40, 60])
@pytest.mark.parametrize("walk", [5 * KMH, -8 * KMH])
def test_a_crossing_pedestrian_counts_if_he_will_be_there_when_the_car_arrives(
    new_part: NewPart, kmh: int, walk: float
) -> None:
    """Both keep their speeds: he meets the bumper at *meets* from its middle, and starts far beside the way."""
    speed, edge = kmh * KMH, (WIDTH + 0.5) / 2 + 0.3
    for meets, expected in [(0.0, FULL), (edge - 0.01, FULL), (edge + 0.01, NONE), (-edge - 0.01, NONE)]:
        part, stages = begin(new_part("two_stage_aeb"), speed), []
        for tick in range(3000):
            gap = 60.0 - speed * T * tick
            if gap <= 0:
                break
            see(part, gap, meets - walk * gap / speed, across=walk, width=0.5, kind="pedestrian")
            stages.append(stage(part))
        assert max(stages) == expected
        if expected == FULL:
            tick = math.ceil((60.0 - beginning(speed, 0.7, 6.0)) / (speed * T))
            assert stages.index(FULL) == tick


def test_a_pedestrian_who_has_crossed_lets_the_car_go_on(new_part: NewPart) -> None:
    part = begin(new_part("two_stage_aeb"), 10.0)
    see(part, 8.0, -1.0, across=1.4, width=0.5, kind="pedestrian")
    assert stage(part) == FULL
    see(part, 7.0, 2.0, across=1.4, width=0.5, kind="pedestrian")
    assert stage(part, 29) == FULL
    assert stage(part) == NONE


def test_the_highest_stage_of_all_tracks_counts(new_part: NewPart) -> None:
    part = begin(new_part("two_stage_aeb"), 15.0)
    see(part, beginning(15.0, 1.2, 4.0) + 5.0, number=2)
    assert stage(part) == WARNING
    see(part, 4.0, number=8)
    assert stage(part) == FULL


def test_young_tracks_empty_places_and_what_is_behind_are_no_danger(new_part: NewPart) -> None:
    for gap, age in [(3.0, 0.09), (-FRONT - 0.1, 1.0), (-30.0, 1.0)]:
        part = begin(new_part("two_stage_aeb"), 15.0)
        see(part, gap, age=age)
        assert stage(part, 20) == NONE
    see(part, 3.0)
    part["tracks[1].id"] = 0
    assert stage(part, 20) == NONE


@pytest.mark.parametrize(("highest", "expected"), [("none", NONE), ("warning", WARNING), ("partial", PARTIAL)])
def test_what_has_no_class_gets_no_more_than_is_set(new_part: NewPart, highest: str, expected: int) -> None:
    part = begin(new_part("two_stage_aeb", unknown_class=highest), 15.0)
    see(part, 3.0, kind="none")
    assert stage(part, 20) == expected
    see(part, 3.0, kind="obstacle")
    assert stage(part, 20) == FULL


def test_a_width_that_is_not_known_is_that_of_the_class(new_part: NewPart) -> None:
    for kind, width, margin in [("pedestrian", 0.5, 0.3), ("truck", 2.5, 0.1), ("car", 1.8, 0.1), ("none", 1.0, 0.1)]:
        for out, expected in [(0.01, NONE), (-0.01, FULL)]:
            part = begin(new_part("two_stage_aeb"), 15.0)
            see(part, 3.0, (WIDTH + width) / 2 + margin + out, width=0.0, kind=kind)
            assert stage(part) == expected, kind


def test_the_width_that_a_crossing_brake_assumes_is_a_parameter(new_part: NewPart) -> None:
    """A radar reports no class: a car that a quarter of the host overlaps counts, with the width of a car."""
    for out, expected in [(0.01, NONE), (-0.01, FULL)]:
        part = begin(new_part("crossing_aeb", unknown_width=1.6), 15.0)
        see(part, 3.0, (WIDTH + 1.6) / 2 + 0.1 + out, width=0.0, kind="none")
        assert stage(part) == expected


def least_gap(speed: float, lead: float, braking: float, lost: float, required: float) -> float:
    """The gap that is lost until the car is no faster than an object that brakes to standstill; both step by step."""
    h, gap, time = 5e-4, 0.0, 0.0
    while speed > lead:
        gap += (speed - lead) * h
        time += h
        lead = max(lead - braking * h, 0.0)
        speed -= required * h if time > lost else 0.0
    return gap


@pytest.mark.parametrize(
    ("lead", "braking"), [(20.0, 2.0), (20.0, 4.0), (8.0, 4.0), (3.0, 9.0), (20.0, 0.0), (20.0, -2.0)]
)
@pytest.mark.parametrize("doubts", [0.0, 0.5])
def test_a_stage_begins_sooner_for_an_object_that_brakes(
    new_part: NewPart, lead: float, braking: float, doubts: float
) -> None:
    """By the required deceleration, whose gap is integrated here, and by the time to collision; less its deviations."""
    speed, sure = 22.0, max(braking - 2 * doubts, 0.0)
    for name, values, due in (
        ("required", {"partial_required": 5.0, "partial_ttc": 0.0}, least_gap(speed, lead, sure, 0.2, 5.0) + 0.5),
        ("time", {"partial_required": 20.0, "partial_ttc": 3.0}, least_gap(speed, lead, sure, 3.0, 1e9)),
    ):
        for out, expected in ((0.02, WARNING), (-0.02, PARTIAL)):
            part = new_part("crossing_aeb", full_required=1e9, full_ttc=0.0, **values)
            see(begin(part, speed), due + out, along=lead)
            part["tracks[1].ax"], part["tracks[1].ax_deviation"] = -braking, doubts
            assert stage(part) == expected, name
    part = new_part("two_stage_aeb", partial_ttc=3.0, partial_required=20.0, full_required=20.0)
    see(begin(part, speed), 3.0 * (speed - lead) + 0.02, along=lead)
    part["tracks[1].ax"] = -braking
    assert stage(part) == WARNING  # it counts with its speed


def doubt(part: Any, covariance: Any) -> None:
    names = ("x", "y", "vx", "vy")
    for i, one in enumerate(names):
        for j, other in enumerate(names[i:], i):
            part[f"tracks[1].covariance.{one}_{other}"] = covariance[i, j]


@pytest.mark.parametrize("radius", [1e12, 80.0, -80.0])
@pytest.mark.parametrize("uncertain", ["gap", "miss"])
@pytest.mark.parametrize("seed", range(3))
def test_a_stage_begins_when_it_is_due_by_so_many_deviations(
    new_part: NewPart, uncertain: str, seed: int, radius: float
) -> None:
    """By derivatives, in numbers, along and across the path; from there to the car's axes by the circle's geometry."""
    root = np.random.default_rng(seed).normal(size=(4, 4)) * 0.5
    root[[1, 3] if uncertain == "gap" else [0, 2]] *= 1e-3
    covariance, speed = root @ root.T, 15.0
    state = np.array([24.0, 0.3, 3.0, 0.4])  # gap, aside, speed along, speed across

    def late(state: Any) -> float:
        return float(state[0] - beginning(speed - state[2], 1.2, 4.0))

    def room(state: Any) -> float:
        return float((WIDTH + 1.8) / 2 + 0.1 - abs(state[1] + state[3] * state[0] / (speed - state[2])))

    if uncertain == "gap":
        state[0] += -1 - late(state)  # due by a metre
    else:
        state[0] *= 0.3
    function = (lambda state: -late(state)) if uncertain == "gap" else room
    slopes = np.array([(function(state + step) - function(state - step)) / 2e-5 for step in 1e-5 * np.eye(4)])
    limit = function(state) / math.sqrt(slopes @ covariance @ slopes)
    turned, share = (state[0] + FRONT) / radius, (radius - state[1]) / radius
    c, s = math.cos(turned), math.sin(turned)
    out = np.kron(np.eye(2), np.array([[c, -s], [s, c]])) @ np.diag([share, 1, share, 1])
    vx, vy = (out @ state)[2:]
    for factor, expected in ((0.999, True), (1.001, False)):
        limits = {"deviations": factor * limit, "warning_deviations": 0.0, "full_required": 20.0, "full_ttc": 0.0}
        part = new_part("two_stage_aeb", **limits)
        begin(part, speed, 0.0 if radius > 1e9 else speed / radius)
        x, y = (state[0] + FRONT, state[1]) if radius > 1e9 else (
            (radius - state[1]) * s, radius - (radius - state[1]) * c
        )  # fmt: skip
        see(part, x - FRONT, y, vx, vy)
        doubt(part, out @ covariance @ out.T)
        assert stage(part) == (PARTIAL if expected else WARNING)
        doubt(part, 0 * covariance)
        assert stage(part) >= PARTIAL
        doubt(part, 100 * out @ covariance @ out.T)
        part["tracks[1].existence"] = 0.0
        assert stage(part, 100) >= PARTIAL  # what has begun continues


def test_what_may_not_exist_is_not_braked_for(new_part: NewPart) -> None:
    for existence, expected in ((0.89, NONE), (0.91, FULL)):
        part = begin(new_part("two_stage_aeb"), 15.0)
        see(part, 3.0)
        part["tracks[1].existence"] = existence
        assert stage(part, 20) == expected


def test_the_warning_has_its_own_number_of_deviations(new_part: NewPart) -> None:
    """By the place beside the path alone: 0.4 m of room there, and a deviation of 0.2 m."""
    covariance = np.diag([0, 0.04, 0, 0])
    for number, expected in ((1.9, WARNING), (2.1, NONE)):
        part = begin(new_part("two_stage_aeb", warning_deviations=number, deviations=5.0), 15.0)
        see(part, 3.0, 1.5)
        doubt(part, covariance)
        assert stage(part, 20) == expected


def meets(lead: float, host: float, speed: float, ahead: float = 0.0, behind: float = 4.5, more: float = 0.0) -> bool:
    """Whether the boxes of a car (1.8 m by 4.5 m) and of a vehicle of that size that crosses its path overlap: step by
    step from the arrival of the car's front. The vehicle's front is at the middle of the path *lead* seconds later;
    *ahead* and *behind* its front are its ends, *more* the way of the car before and after."""
    times = np.arange(-more / host, (1.8 + 4.5 + more) / host, 1e-3)
    front = (times - lead) * speed
    return bool(np.any((front + ahead > -0.9) & (front - behind < 0.9)))


def test_a_crossing_vehicle_counts_if_the_boxes_would_meet(new_part: NewPart) -> None:
    """The tracked point is the middle of its front, or of its flank: each counts as if it were both."""
    host, speed, length = 12.0, 10.0, 4.5
    counted = 0
    for sense in (1, -1):
        for lead in np.arange(-1.5, 1.5, 0.05):
            for behind, near in ((0.0, 0.9), (length / 2, 0.0)):
                part = begin(new_part("crossing_aeb", deviations=0.0, warning_deviations=0.0), host)
                see(part, 12.0 + near, sense * (-(1.0 + lead) * speed - behind), 0.0, sense * speed)
                counts = stage(part) > NONE
                counted += counts
                assert counts or not meets(lead, host, speed), (lead, behind)
                # It may count half its length too early and too late, with a margin of 0.1 m beside the car.
                assert not counts or meets(lead, host, speed, length / 2 + 0.1, 1.5 * length + 0.1, 0.9), (lead, behind)
    assert 100 < counted < 200


def test_without_its_length_only_the_front_counts(new_part: NewPart) -> None:
    for name, expected in (("two_stage_aeb", NONE), ("crossing_aeb", FULL)):
        part = begin(new_part(name, deviations=0.0, warning_deviations=0.0), 12.0)
        see(part, 7.0, 10.0, 0.0, -10.0)  # it is beside the path when the front arrives, and hits the side
        assert stage(part) == expected
