"""What a car of a shared world is told of others: road users of the traffic in the plane, and which are the nearest."""

from __future__ import annotations

import math

import numpy as np
import pytest

from dse.live.others import Car, State, Users, Ways, host_of, nearest

ARC = np.linspace(0.0, math.pi, 400)
RADII = np.array([[100.0], [96.0]])  # of the own lane and of the one to its left
HALF_CIRCLE = Ways(((100 * ARC, 0, RADII * np.sin(ARC), 100 - RADII * np.cos(ARC)),))


def test_users_on_a_bend_are_where_the_circle_is_and_those_on_no_path_stay() -> None:
    path, lane, station, offset = np.array(
        [(0, 0.0, 50.0 * math.pi, 3.0), (0, 0.0, 20.0, -3.5), (-1, 0.0, 7.0, 8.0), (0, 0.75, 50.0 * math.pi, 0.0)]
    ).T
    x, y = HALF_CIRCLE.plane(path, lane, station, offset)
    # A circle of 100 m to the left: an offset of 3 m is on a circle of 97 m.
    assert (x[0], y[0]) == (pytest.approx(97.0, abs=0.02), pytest.approx(100.0, abs=0.02))
    assert (x[1], y[1]) == (
        pytest.approx(103.5 * math.sin(0.2), abs=0.02),
        pytest.approx(100 - 103.5 * math.cos(0.2), abs=0.02),
    )
    assert (x[2], y[2]) == (7.0, 8.0)
    assert (x[3], y[3]) == (pytest.approx(97.0, abs=0.02), pytest.approx(100.0, abs=0.02))  # three quarters to the left


def test_a_user_is_told_a_step_ahead_along_its_way() -> None:
    columns = {"id": 4.0, "class": 1.0, "path": 0.0, "station": 30.0, "offset": 1.0, "turn": 0.1, "speed": 20.0}
    users = Users({name: np.array([value]) for name, value in columns.items()}, np.zeros(1), np.zeros(1))
    (number,) = users.numbers
    told = users.mover(number, 0.01)
    assert told["station"] == pytest.approx(30.0 + 0.2 * math.cos(0.1))
    assert told["offset"] == pytest.approx(1.0 + 0.2 * math.sin(0.1))
    assert users.mover(number + 1, 0.01) == {}
    assert (users.near(80.0, 60.0), users.near(91.0, 60.0)) == ({number}, set())


def test_those_behind_count_twice_and_those_seen_already_a_little_less() -> None:
    here = State(0.0, 0.0, math.pi / 2, 10.0)  # looks along y
    y = np.array([-50.0, 90.0, 110.0])
    assert nearest(here, [1, 2, 3], 0 * y, y, [], 2) == [2, 1]
    assert nearest(here, [1, 2, 3], 0 * y, y, [3], 2) == [3, 2]


def test_the_traffic_sees_a_car_by_its_middle_and_not_without_a_station() -> None:
    told = host_of(Car(place=0.5), State(0.0, 0.0, 0.0, 20.0, station=100.0, offset=0.3), 0.01)
    assert (told["station"], told["offset"], told["length"]) == (pytest.approx(100.7), 0.3, 4.5)
    assert host_of(Car(), State(0.0, 0.0, 0.0, 20.0), 0.01) == {}
