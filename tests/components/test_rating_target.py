"""The target of a rating meets the host where the cell says, in all tests, over more speeds than the cells have."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dse.loading.include import read_document
from dse.units import parse_quantity

NewPart = Callable[..., Any]
ROOT = Path(__file__).parents[2]
H, FRONT, LENGTH, WIDTH, TIME, START = 0.01, 2.3, 4.5, 1.8, 5.0, 100.0
KMH = 1 / 3.6
STRAIGHT = ("ncap_rear", "ncap_braking", "ncap_head_on", "ncap_crossing")
# Length, width and, ahead of the centre, the reference point of ISO 19206's targets (m).
SHAPES = {
    "car": (4.023, 1.712, 4.023 / 4), "motorcyclist": (2.08, 0.79, 0.0), "bicyclist": (1.89, 0.5, 0.62 - 0.605),
    "adult": (0.6, 0.5, 0.3 - 0.36), "child": (0.711, 0.298, 0.711 / 2 - 0.396),
}  # fmt: skip
Box = tuple[float, float, float, float, float]  # x, y, heading, length, width


def si(value: object) -> int | float | str:
    text = str(value)
    if isinstance(value, bool):
        return value
    if text.isdecimal():
        return int(text)
    return float(parse_quantity(text).si) if text[0] in "-0123456789" else text


def read(name: str) -> Any:
    return read_document(ROOT / "testbenches" / name, ROOT).data


def rated(benches: tuple[str, ...] = STRAIGHT) -> dict[str, dict[str, Any]]:
    """The target's parameters in each test of the rating on these *benches*: those of its bench, and its own."""
    found = {}
    for name, tests in read("euro_ncap.rating.yaml")["tests"].items():
        for number, test in enumerate(tests if isinstance(tests, list) else [tests]):
            if test["bench"] not in benches:
                continue
            given = {**read(f"{test['bench']}.yaml").get("parameters", {}), **test.get("parameters", {})}
            found[f"{name} {number}"] = {
                key.removeprefix("traffic."): si(value) for key, value in given.items() if key.startswith("traffic.")
            }
    return found


def begun(new_part: NewPart, host: float, **parameters: Any) -> Any:
    part = new_part("rating_target", **{"host_front": FRONT, "host_length": LENGTH, "host_width": WIDTH, **parameters})
    part["lane.station"], part["motion.speed"] = START, host
    part.init()
    return part


def place(part: Any, host: float, time: float) -> Box:
    """The target when the host has driven for *time*; its inputs are those of the step before."""
    part["lane.station"] = START + host * (time - H)
    part.step(H)
    return box(part)


def box(part: Any) -> Box:
    at = "movers[1]."
    x, y, turn, length, width = (part[at + name] for name in ("station", "offset", "turn", "length", "width"))
    return x, y, turn, length, width


def car(host: float, time: float) -> Box:
    return START + host * time + FRONT - LENGTH / 2, 0.0, 0.0, LENGTH, WIDTH


def apart(a: Box, b: Box) -> float:
    """The greatest distance between the projections of two boxes on the normals of their sides; < 0: they overlap."""
    widest = -math.inf
    for turn in (a[2], a[2] + math.pi / 2, b[2], b[2] + math.pi / 2):
        normal = np.array([math.cos(turn), math.sin(turn)])
        reach = 0.0
        for _, _, heading, length, width in (a, b):
            reach += abs(math.cos(heading - turn)) * length / 2 + abs(math.sin(heading - turn)) * width / 2
        widest = max(widest, abs(float(normal @ (np.array(b[:2]) - np.array(a[:2])))) - reach)
    return widest


def grid(many: bool) -> Iterator[tuple[str, dict[str, Any], float, float, float]]:
    hosts, targets = (range(10, 140, 10), (5, 8, 10, 15, 20, 45, 80, 100)) if many else ((10, 130), (5, 80))
    for name, given in rated().items():
        located = "contact" not in given
        places = (-0.25, 0.0, 0.1, 0.25, 0.5, 0.75, 0.9, 1.0, 1.25) if many and located else (0.25,)
        for host, speed, where in itertools.product(hosts, targets, places):
            if given.get("approach", "same") in ("nearside", "farside") and not 0.1 <= where <= 0.9:
                continue  # no cell has that
            if given["kind"] not in ("car", "motorcyclist") and speed > 20:
                continue
            yield name, {**given, "impact_location": where}, host * KMH, speed * KMH, where


def check_contact(new_part: NewPart, given: dict[str, Any], host: float, speed: float, where: float) -> bool:
    """Whether the case has a contact at all; if so, it is where the cell says, to 1 cm, and when, to a step."""
    length, width, reference = SHAPES[given["kind"]]
    approach = given.get("approach", "same")
    if approach == "same" and speed >= host:
        return False
    part = begun(new_part, host, speed=speed, **given)
    before, at, after = (place(part, host, TIME + d) for d in (-H, 0, H))
    assert at[3:] == (length, width)
    ahead, left = reference, 0.0  # of the target, where it is touched
    if approach in ("same", "opposite"):
        ahead = -length / 2 if approach == "same" else length / 2
    elif given.get("contact") == "side":
        ahead = length / 2
    else:
        left = width / 2 if approach == "nearside" else -width / 2
    c, s = math.cos(at[2]), math.sin(at[2])
    point = np.array([at[0] + c * ahead - s * left, at[1] + s * ahead + c * left])
    front = START + host * TIME + FRONT
    if given.get("contact") == "side":
        expected = [front - 0.1 * LENGTH, WIDTH / 2 if approach == "farside" else -WIDTH / 2]
    else:
        expected = [front, (where - 0.5) * WIDTH]
    assert point == pytest.approx(expected, abs=0.01)
    if abs(expected[1]) > WIDTH / 2 + width / 2 and approach in ("same", "opposite"):
        assert apart(car(host, TIME + H), after) > 0
        return False
    assert apart(car(host, TIME - H), before) > 0
    assert apart(car(host, TIME + H), after) < 0
    return True


def test_without_braking_the_contact_is_where_the_cell_says(new_part: NewPart) -> None:
    hits = [check_contact(new_part, *case[1:]) for case in grid(many=False) if "headway" not in case[1]]
    assert sum(hits) > 40


@pytest.mark.thorough
def test_without_braking_every_contact_is_where_the_cell_says(new_part: NewPart) -> None:
    hits = [check_contact(new_part, *case[1:]) for case in grid(many=True) if "headway" not in case[1]]
    assert sum(hits) > 8000


def test_a_target_that_brakes_is_hit_when_the_equations_of_motion_say(new_part: NewPart) -> None:
    for name, given, host, _, where in grid(many=True):
        if "headway" not in given or where not in (0.0, 0.5):
            continue
        part = begun(new_part, host, speed=host, **given)
        length = SHAPES[given["kind"]][0]
        assert box(part)[:2] == pytest.approx((START + FRONT + host + length / 2, (where - 0.5) * WIDTH), abs=1e-9), (
            name
        )
        # The gap of 1 s closes by 2 t^2 after 2 s at 4 m/s2 until the target drives at 2 km/h.
        slow, rate = 2 * KMH, 4.0
        least, gap = (host - slow) / rate, host - (host - slow) ** 2 / (2 * rate)
        hit = 2 + (math.sqrt(2 * host / rate) if gap < 0 else least + gap / (host - slow))
        steps = math.floor(hit / H - 1e-6)
        for _ in range(steps):
            part.step(H)
        assert apart(car(host, H * steps), box(part)) >= -1e-6
        part.step(H)
        part.step(H)
        assert apart(car(host, H * (steps + 2)), box(part)) < 0


def test_it_follows_the_host_until_the_host_brakes_and_then_ignores_it(new_part: NewPart) -> None:
    part = begun(
        new_part, 10.0, kind="adult", approach="nearside", speed=2.0, acceleration_distance=1.0, steady_distance=3.0
    )
    place(part, 10.0, 4.0)
    part["motion.speed"] = 9.9  # it sags
    slow = place(part, 10.0, 4.01)
    assert part["movers[1].speed"] == pytest.approx(2 * 0.99)
    assert slow[1] == pytest.approx(2 * (4.01 - TIME) + 0.06, abs=1e-3)
    part["motion.acceleration"] = -2.0
    held = place(part, 10.0, 4.01)  # the host no longer counts
    assert held[1] - slow[1] == pytest.approx(2 * H)
    part["motion.acceleration"] = 0.0
    assert place(part, 10.0, 0.0)[1] - held[1] == pytest.approx(2 * H)


def test_a_pedestrian_stands_until_it_sets_out(new_part: NewPart) -> None:
    part = begun(
        new_part, 10.0, kind="adult", approach="nearside", speed=2.0, acceleration_distance=1.0, steady_distance=3.0
    )
    sets_out = TIME - 3 / 2 - 2 * 1 / 2  # v t = 2 G while it accelerates
    stands = place(part, 10.0, sets_out - 0.1)
    assert (part["movers[1].speed"], stands[1]) == (0, pytest.approx(-4 + 0.06))
    at = [place(part, 10.0, sets_out + t)[1] - stands[1] for t in (0.5, 1.0)]
    assert at == pytest.approx([0.5 * 2 * 0.5**2, 1.0])
    assert part["movers[1].speed"] == pytest.approx(2)


def test_an_oncoming_car_changes_lane_before_the_contact(new_part: NewPart) -> None:
    part = begun(new_part, 20.0, approach="opposite", speed=20.0, lane_change_time=3.1)
    ways = np.array([place(part, 20.0, t) for t in np.arange(0.3, 3.55, 0.05)])
    assert ways[0, 1] == pytest.approx(3.5)  # the middle of the lane to the left of the host
    assert ways[-1, 1] == pytest.approx(0, abs=1e-6)  # 1.5 s before
    slope = np.diff(ways[:, 1]) / np.diff(ways[:, 0])
    assert np.tan(ways[:, 2])[1:-1] == pytest.approx((slope[1:] + slope[:-1]) / 2, abs=2e-3)


def test_cars_are_parked_only_up_to_their_speed(new_part: NewPart) -> None:
    given = {
        "approach": "farside",
        "parked": 2,
        "parked_ahead[1]": -20.0,
        "parked_offset[1]": 6.0,
        "unobstructed_speed": 60 * KMH,
    }
    assert begun(new_part, 80 * KMH, speed=20 * KMH, **given)["movers[2].class"] == 0
    assert begun(new_part, 20 * KMH, speed=80 * KMH, **given)["movers[3].class"] == 0
    part = begun(new_part, 60 * KMH, speed=60 * KMH, **given)
    assert part["movers[2].station"] == pytest.approx(START + FRONT + 60 * KMH * TIME - 20)
    assert (part["movers[2].offset"], part["movers[3].class"], part["movers[4].class"]) == (6, 1, 0)


@cache
def turning(speed: int, side: int) -> np.ndarray:
    """Rows x, y, heading of the rear axle each millimetre from the start; *speed* in km/h, 4 s straight on."""
    radius, alpha, beta = (
        (8, 22.85, 44.3)
        if side < 0
        else {10: (9, 20.62, 48.76), 15: (11.75, 20.93, 48.14)}.get(speed, (14.75, 21.79, 46.42))
    )
    h, wide, tight = 1e-3, 1 / 1500, 1 / radius
    clothoid = 2 * math.radians(alpha) / (wide + tight)
    corners = np.cumsum([0, speed / 3.6 * 4, 0, clothoid, math.radians(beta) * radius, clothoid, 0, 90])
    along = np.arange(0, corners[-1], h) + h / 2
    curvature = np.interp(along, corners + np.arange(8) * 1e-12, [0, 0, wide, tight, tight, wide, 0, 0])
    heading = side * (np.cumsum(curvature) - curvature / 2) * h
    return np.column_stack([np.cumsum(np.cos(heading)) * h, np.cumsum(np.sin(heading)) * h, heading])


def test_a_host_that_turns_meets_the_target_where_the_cell_says(new_part: NewPart) -> None:
    rear, met = 1.485, 0
    for name, given in rated(("ncap_turning",)).items():
        is_vehicle = given["kind"] in ("car", "motorcyclist")
        length, width, reference = SHAPES[given["kind"]]
        directions = ("opposite",) if is_vehicle else ("same", "opposite")
        sides = (1,) if is_vehicle else (1, -1)
        wheres = (0.5,) if is_vehicle else (0.0, 0.5, 1.0)
        for direction, side, where, host in itertools.product(directions, sides, wheres, (10, 15, 20, 25)):
            across, speed = (where - 0.5) * WIDTH, (40 if is_vehicle else 5) * KMH
            line = 3.5 if is_vehicle else side * 9.5 + 1.75
            path = turning(host, side)
            ahead = np.column_stack([np.cos(path[:, 2]), np.sin(path[:, 2])])
            front = path[:, :2] + (rear + FRONT) * ahead + across * np.column_stack([-ahead[:, 1], ahead[:, 0]])
            index = int(np.argmax(side * front[:, 1] >= side * line - width / 2))
            time = (index + 1) * 1e-3 / (host * KMH)
            turn = "farside" if side > 0 else "nearside"
            part = begun(
                new_part,
                host * KMH,
                speed=speed,
                **{**given, "approach": direction, "turn": turn, "impact_location": where},
            )
            steps = math.floor(time / H)
            for _ in range(steps):
                part.step(H)
            before = box(part)
            part.step(H)
            x, y = (a + (time / H - steps) * (b - a) for a, b in zip(before[:2], box(part)[:2], strict=True))
            way = 1 if direction == "same" else -1
            touched = x + way * (length / 2 if is_vehicle else reference), y - side * width / 2
            assert touched == pytest.approx((START - rear + front[index, 0], front[index, 1]), abs=0.01), name
            met += 1
    assert met == 2 * 4 + 4 * 2 * 2 * 3 * 4


def since_start(way: float, rate: float, speed: float = 10 * KMH) -> float:
    """The time at the end of a way from standstill, at constant acceleration up to a speed, 3 s after the start."""
    begin = speed**2 / (2 * rate)
    return 3 + (math.sqrt(2 * way / rate) if way < begin else speed / rate + (way - begin) / speed)


def until(part: Any, time: float) -> Box:
    """The target at *time*, linear between two steps."""
    for _ in range(math.floor(time / H)):
        part.step(H)
    before = box(part)
    part.step(H)
    x, y = (a + (time / H - math.floor(time / H)) * (b - a) for a, b in zip(before[:2], box(part)[:2], strict=True))
    return x, y, *before[2:]


def test_a_host_that_starts_from_standstill_meets_the_target_where_the_cell_says(new_part: NewPart) -> None:
    met = 0
    for name, given in rated(("ncap_low_speed",)).items():
        if given["turn"] != "none":
            continue
        length, width, reference = SHAPES[given["kind"]]
        way = 1 if given["approach"] == "nearside" else -1
        for speed, where in itertools.product((8, 60), (0.25, 0.75)):
            values = {"pull_away_distance": 1.5, "speed": speed * KMH, **given, "impact_location": where}
            part = begun(new_part, 0.0, **values)
            distance = values["pull_away_distance"]
            time = since_start(distance, given["pull_away"])
            x, y, turn, *_ = until(part, time)
            assert turn == pytest.approx(way * math.pi / 2)
            sense, bumper = (-1, LENGTH - FRONT) if given.get("reverses") else (1, FRONT)
            if given.get("contact") == "side":
                touched = x, y + way * length / 2
                expected = START + bumper + distance - 0.1 * LENGTH, -way * WIDTH / 2
            else:
                touched = x - sense * width / 2, y + way * reference
                expected = START + sense * (bumper + distance), (where - 0.5) * WIDTH
            assert touched == pytest.approx(expected, abs=0.01), name
            met += 1
    assert met == 4 * 7


def test_a_host_that_starts_and_turns_meets_the_target_where_the_cell_says(new_part: NewPart) -> None:
    rear, straight = 1.485, 40 * KMH
    first = round(straight * 1e3)
    path = turning(10, 1)[first : first + 20_000] - [straight, 0, 0]
    alongs = (first + 1 + np.arange(len(path))) * 1e-3 - straight
    front = path[:, :2] + (rear + FRONT) * np.column_stack([np.cos(path[:, 2]), np.sin(path[:, 2])])
    for name, given in rated(("ncap_low_speed",)).items():
        if given["turn"] == "none":
            continue
        length, width, _ = SHAPES[given["kind"]]
        along, touched = (np.interp(3.5 - width / 2, front[:, 1], values) for values in (alongs, front[:, 0]))
        for speed in (30, 80):
            x, y, *_ = until(begun(new_part, 0.0, **given, speed=speed * KMH), since_start(along, 1.5))
            assert (x - length / 2, y - width / 2) == pytest.approx(
                (START - rear + touched, 3.5 - width / 2), abs=0.01
            ), name


def test_a_bicyclist_that_overtakes_is_at_the_door_when_the_cell_says(new_part: NewPart) -> None:
    (given,) = rated(("ncap_dooring",)).values()
    for speed, gap in itertools.product((10, 15, 20), (0.5, 1.0, 1.5, 2.0)):
        part = begun(new_part, 0.0, **{**given, "speed": speed * KMH, "passing_gap": gap})
        x, y, turn, length, width = until(part, given["approach_time"])
        assert (x + length / 2, y - width / 2, turn) == pytest.approx((START - 0.2, WIDTH / 2 + gap, 0), abs=1e-9)


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize(("mass", "push"), [(1400, -0.1), (1600, 0.0), (1900, 0.1), (1600, -2.0), (1600, 2.0)])
def test_the_drive_robot_keeps_its_motion_until_an_emergency_brake_acts(
    new_part: NewPart, sense: int, mass: int, push: float
) -> None:
    """A mass that differs from the assumed one, and a force of the powertrain or the brakes, per mass."""
    part = new_part("drive_robot", reverses=sense < 0)
    part.init()
    speed = way = latest = 0.0
    for k in range(1, 701):
        part["motion.speed"] = speed
        part.step()
        torque = sum(part[f"wheel_torque[{wheel}]"] for wheel in range(1, 5))
        rate = torque / 0.31 / mass + push if torque else 0.0
        way += (speed + rate * H / 2) * H
        speed += rate * H
        if sense * way > 0.05:
            latest = max(latest, abs(since_start(sense * way, 1.5) - k * H))
        assert part["set_speed"] == pytest.approx(speed, abs=abs(rate) * H + 1e-12)
    assert speed == pytest.approx(sense * 10 * KMH, rel=0.01)
    assert latest < 3.1 * H  # its inputs are a step old, and 2 m/s2 move it by 1 cm
    part["yielding_torque"] = 11.0
    part.step()
    part["yielding_torque"] = 0.0
    part.step()
    assert [part[f"wheel_torque[{wheel}]"] for wheel in range(1, 5)] == [0, 0, 0, 0]


def test_the_steering_robot_keeps_its_path(new_part: NewPart) -> None:
    """With the kinematics of a car: the rear axle follows its front wheels."""
    for host, side in ((10, 1), (15, 1), (25, 1), (10, -1)):
        part = new_part("steering_robot", turn="farside" if side > 0 else "nearside")
        x, y, heading, speed, rear = 0.0, 0.0, 0.3, host * KMH, 1.485
        path = turning(host, side)
        c, s = math.cos(0.3), math.sin(0.3)
        path = np.column_stack([path[:, 0] * c - path[:, 1] * s, path[:, 0] * s + path[:, 1] * c])
        part["motion.speed"] = speed
        widest = 0.0
        for k in range(int(12 / 0.02)):
            part["motion.x"], part["motion.y"] = x + rear * math.cos(heading), y + rear * math.sin(heading)
            part["motion.heading"] = heading
            (part.step if k else part.init)()
            turn = speed * 0.02 * math.tan(part["steering"]) / 2.7
            x += speed * 0.02 * math.cos(heading + turn / 2)
            y += speed * 0.02 * math.sin(heading + turn / 2)
            heading += turn
            if k % 10 == 0:
                widest = max(widest, float(np.min(np.hypot(path[:, 0] - x, path[:, 1] - y))))
        assert widest < 0.03
        assert heading - 0.3 == pytest.approx(side * math.pi / 2, abs=0.01)


def test_a_host_that_drifts_overlaps_the_target_by_a_tenth_of_its_width(new_part: NewPart) -> None:
    for kind, direction, host, drift in itertools.product(
        ("car", "motorcyclist"), ("same", "opposite"), (15.0, 30.0), (0.2, 0.8)
    ):
        length, width, _ = SHAPES[kind]
        part = begun(new_part, host, kind=kind, approach=direction, speed=host + 3, drift=drift)
        # An arc of 400 m after 4 s; then the front's left corner moves aside on a straight line.
        turned, rear = math.asin(drift / host), 1.485
        x, y = 4 * host + 400 * math.sin(turned), 400 * (1 - math.cos(turned))
        corner = y + (rear + FRONT) * math.sin(turned) + 0.9 * math.cos(turned)
        way = (3.5 - width / 2 + 0.1 * WIDTH - corner) / math.sin(turned)
        time = (4 * host + 400 * turned + way) / host
        front = START - rear + x + way * math.cos(turned) + (rear + FRONT) * math.cos(turned) - 0.9 * math.sin(turned)
        for _ in range(math.floor(time / H)):
            part.step(H)
        before = box(part)
        part.step(H)
        at = [a + (time / H - math.floor(time / H)) * (b - a) for a, b in zip(before, box(part), strict=True)]
        ahead = at[0] - length / 2 if direction == "opposite" else at[0] + length / 2
        assert ahead == pytest.approx(front if direction == "opposite" else front - LENGTH / 2, abs=0.01)
        assert at[1] == 3.5


def test_lane_keeping_steers_back_at_the_distance_and_time_of_its_parameters(new_part: NewPart) -> None:
    """The kinematics of a car, and what it sees without errors."""
    for speed, drift in ((15.0, 0.3), (28.0, 0.7)):
        part = new_part("emergency_lane_keeping")
        part["lane.width"], part["motion.speed"] = 3.5, speed
        y, heading, steers_at, least, lateral = -0.2, -math.asin(drift / speed), math.nan, math.inf, 0.0
        for k in range(400):
            part["lane.offset"], part["lane.heading"] = y, heading
            distance = 1.75 - 0.9 + y + 1.215 * math.sin(heading)
            least = min(least, distance)
            (part.step if k else part.init)()
            if part["active"] and math.isnan(steers_at):
                steers_at = distance
            curvature = math.tan(part["steering"]) / 2.7
            lateral = max(lateral, abs(curvature) * speed * speed)
            y += speed * math.sin(heading) * 0.02
            heading += speed * curvature * 0.02
        assert steers_at == pytest.approx(0.1 + 0.5 * drift, abs=0.02 * drift)
        # Its jerk of 5 m/s3 alone would need u^1.5 (2/3) sqrt(2/5) m to stop the drift.
        assert steers_at - least < drift**1.5 * 2 / 3 * math.sqrt(2 / 5) * 2
        assert least > 0
        assert lateral < 3.01
        assert 1.75 - 0.9 + y == pytest.approx(0.3, abs=0.02)


def test_lane_keeping_leaves_the_lane_to_the_left_free_without_another_vehicle(new_part: NewPart) -> None:
    def acts(**track: float) -> bool:
        part = new_part("emergency_lane_keeping")
        part["lane.width"], part["motion.speed"], part["lane.offset"], part["lane.heading"] = 3.5, 20.0, 0.8, 0.02
        if track:
            part["tracks[1].id"] = 1
        for name, value in track.items():
            part[f"tracks[1].{name}"] = value
        part.init()
        part.step()
        return bool(part["active"])

    assert not acts()
    assert acts(x=60.0, y=2.7, vx=-20.0)  # oncoming, in 1.5 s
    assert not acts(x=160.0, y=2.7, vx=-20.0)
    assert acts(x=-15.0, y=2.7, vx=26.0)  # it overtakes in 2.5 s
    assert not acts(x=-15.0, y=2.7, vx=18.0)  # it falls behind
    assert not acts(x=60.0, y=-0.8, vx=-20.0)  # on the own lane: that is for the emergency brake
    assert acts(x=1.0, y=2.7, vx=20.0)
