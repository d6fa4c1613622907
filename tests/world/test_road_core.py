"""The C core of roads against closed forms of what lies along a line, an arc, a clothoid, a hill and a bank."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from components.conftest import WORKSPACE, Shelf
from hypothesis import given, settings, strategies as st
from scipy.integrate import quad
from scipy.optimize import brentq
from world.conftest import road_component
from world.traced_roads import ONE_LANE, TWO_LANES, Frame, Traced, constant, cubics, lane

from dse.world import LaneBand, Patch, RoadTables

NewRoad = Callable[..., Any]

LINE = Traced([(1000.0, 0.0, 0.0)])
RING = Traced([(2 * math.pi * 120, 1 / 120, 1 / 120)])
# Line, clothoid, arc, clothoid that turns over to the other side, arc, line: no two parts within 40 m of each other.
WINDING = Traced([
    (80.0, 0.0, 0.0), (60.0, 0.0, 1 / 120), (90.0, 1 / 120, 1 / 120), (110.0, 1 / 120, -1 / 100),
    (70.0, -1 / 100, -1 / 100), (100.0, 0.0, 0.0),
], Frame(3.0, -7.0, 0.4, 0.0))  # fmt: skip


def put(part: Any, x: float, y: float, heading: float = 0.0, speed: float = 0.0) -> None:
    part["motion.x"], part["motion.y"], part["motion.heading"], part["motion.speed"] = x, y, heading, speed
    for wheel in range(1, 5):
        part[f"contacts[{wheel}].x"], part[f"contacts[{wheel}].y"] = x, y


def angle(value: float) -> float:
    return math.remainder(value, 2 * math.pi)


def test_a_place_on_a_path_is_that_of_the_closed_form(new_road: NewRoad) -> None:
    part = new_road(WINDING.path())
    part.init()
    for s in np.linspace(0, WINDING.length, 301):
        here = WINDING.at(s)
        put(part, here.x, here.y, here.heading)
        part.step()
        # The pieces in the tables are within 1e-9 m of the line; where an arc meets a line the curvature jumps.
        assert part["lane.station"] == pytest.approx(s, abs=1e-9)
        assert part["lane.offset"] == pytest.approx(0, abs=1e-9)
        assert part["lane.heading"] == pytest.approx(0, abs=1e-9)
        if abs(s - 410) > 1e-6:
            assert part["lane.curvature"] == pytest.approx(here.curvature, abs=1e-8)


def test_a_road_compiles_without_a_warning(tmp_path: Path) -> None:
    Shelf(tmp_path, WORKSPACE).instance(road_component(RoadTables((WINDING.path(), RING.path())), tmp_path / "road"))


@pytest.mark.parametrize("hint", [True, False], ids=["followed", "put there"])
def test_any_point_within_20_m_of_a_path_finds_its_station(new_road: NewRoad, hint: bool) -> None:
    part = new_road(WINDING.path())

    @settings(max_examples=300, deadline=None, derandomize=True)
    @given(s=st.floats(0, WINDING.length), t=st.floats(-20, 20), moved=st.floats(-5, 5))
    def check(s: float, t: float, moved: float) -> None:
        part["start_station"] = s + moved if hint else math.fmod(s + 200, WINDING.length)
        put(part, *WINDING.at(s).beside(t))
        part.init()
        # Within 1e-9 m of the line, 1e-10 of its direction (2e-9 m at 20 m); in a bend a foot moves 1/(1 - 20/100).
        assert part["lane.station"] == pytest.approx(s, abs=3.75e-9)
        assert part["lane.offset"] == pytest.approx(t, abs=1e-9)

    check()


def test_beside_a_corner_that_the_line_bends_at_the_corner_is_the_foot(new_road: NewRoad) -> None:
    bent = Traced([(50.0, 0.0, 0.0)]).path()
    corner = cubics([(0.0, [0, 1]), (50.0, [50, math.cos(0.3)])]), cubics([(0.0, [0.0]), (50.0, [0, math.sin(0.3)])])
    part = new_road(replace(bent, length=100.0, x=corner[0], y=corner[1]))
    part["start_station"] = 40.0
    for aside in (0.05, 0.2):  # outside of the bend, in the wedge that no normal reaches
        put(part, 50 + 3 * math.sin(aside), -3 * math.cos(aside))
        part.init()
        assert part["lane.station"] == pytest.approx(50, abs=1e-9)


def test_where_a_path_crosses_itself_the_host_stays_on_its_own_way(new_road: NewRoad) -> None:
    loop = Traced([(100.0, 0.0, 0.0), (1.5 * math.pi * 40, 1 / 40, 1 / 40), (120.0, 0.0, 0.0)])
    part = new_road(loop.path())
    part.init()
    for s in np.arange(0, loop.length, 0.5):
        here = loop.at(s)
        put(part, *here.beside(1.0), here.heading)
        part.step()
        assert part["lane.station"] == pytest.approx(s, abs=1e-9)
        assert part["lane.offset"] == pytest.approx(1, abs=1e-9)


def test_who_is_put_somewhere_else_is_found_there(new_road: NewRoad) -> None:
    part = new_road(WINDING.path())
    part.init()
    for s in (10.0, 480.0, 200.0, 333.0, 0.0, 509.0):
        here = WINDING.at(s)
        put(part, *here.beside(-2.0), here.heading)
        part.step()
        assert part["lane.station"] == pytest.approx(s, abs=1e-9)
        assert part["lane.offset"] == pytest.approx(-2, abs=1e-9)


def test_where_the_line_jumps_to_its_side_lanes_go_on(new_road: NewRoad) -> None:
    # Two roads meet whose reference lines lie on the two sides of the lane.
    straight = Traced([(100.0, 0.0, 0.0)]).path()
    borders = [cubics([(0.0, [a]), (50.0, [a - 3.5])]) for a in (0.0, -3.5)]
    x = cubics([(0.0, [0, 1]), (50.0, [50, 1])])
    path = replace(
        straight, x=x, y=cubics([(0.0, [0.0]), (50.0, [3.5])]), lanes=(LaneBand(0, *borders, constant(1.0)),)
    )
    part = new_road(path, preview_spacing=4.0)
    part.init()
    for s in np.arange(1.0, 99.0, 0.7):
        put(part, s, -1.5, 0.0, 10.0)
        part.step()
        assert part["lane.station"] == pytest.approx(s, abs=1e-9)
        assert part["lane.offset"] == pytest.approx(0.25, abs=1e-9)
        for i in (1, 12, 24):
            assert part[f"preview[{i}].x"] == pytest.approx(4.0 * i, abs=1e-9)
            assert part[f"preview[{i}].y"] == pytest.approx(-0.25, abs=1e-9)


def test_beyond_its_ends_a_path_goes_straight_on_and_is_no_road(new_road: NewRoad) -> None:
    part = new_road(WINDING.path(height=cubics([(0.0, [5, 0.02])])))
    end, begin = WINDING.at(WINDING.length), WINDING.start
    for here, s, beyond in ((end, WINDING.length, 12.0), (begin, 0.0, -8.0)):
        x, y = Frame(here.x + beyond * math.cos(here.heading), here.y + beyond * math.sin(here.heading),
                     here.heading, 0).beside(1.5)  # fmt: skip
        put(part, x, y, here.heading)
        part.init()
        assert part["lane.station"] == pytest.approx(s + beyond, abs=1e-9)
        assert part["lane.offset"] == pytest.approx(1.5, abs=1e-9)
        assert part["ground[1].height"] == pytest.approx(5 + 0.02 * (s + beyond), abs=1e-9)
        assert part["lane.curvature"] == 0
        assert not part["lane.on_road"]


def test_stations_of_a_closed_path_go_round(new_road: NewRoad) -> None:
    part = new_road(RING.path(closed=True))
    part.init()
    for k in range(700):
        s = 2.0 * k
        here = RING.at(s)
        put(part, *here.beside(-1.0), here.heading)
        part.step()
        assert part["lane.station"] == pytest.approx(math.fmod(s, RING.length), abs=1e-7)
        assert part["lane.offset"] == pytest.approx(-1, abs=1e-9)
        assert part["lane.on_road"]


def test_a_bank_and_a_hill_tilt_the_ground_as_their_closed_forms_say(new_road: NewRoad) -> None:
    # On a circle of radius R about (0, R) the surface is z(s, t) = H(s) + t tan B(s), s = R phi.
    radius, bank = 120.0, (0.02, 1e-4, 2e-7)
    height = (10.0, 0.03, -2e-5, 1e-7)
    part = new_road(RING.path(height=cubics([(0.0, height)]), bank=cubics([(0.0, bank)])))

    def surface(x: float, y: float) -> float:
        phi = math.atan2(x, radius - y)
        s, t = radius * phi, radius - math.hypot(x, radius - y)
        return float(np.polyval(height[::-1], s) + t * math.tan(np.polyval(bank[::-1], s)))

    for s, t in ((10.0, 0.0), (55.0, 3.0), (130.0, -6.0), (300.0, 15.0)):
        x, y = RING.at(s).beside(t)
        put(part, x, y, RING.at(s).heading)
        part.init()
        assert part["ground[2].height"] == pytest.approx(surface(x, y), abs=1e-8)
        h = 1e-4  # central differences: 1e-8 of curvature, 1e-10 of rounding
        assert part["ground[2].slope_x"] == pytest.approx((surface(x + h, y) - surface(x - h, y)) / 2 / h, abs=1e-8)
        assert part["ground[2].slope_y"] == pytest.approx((surface(x, y + h) - surface(x, y - h)) / 2 / h, abs=1e-8)
        assert part["lane.bank"] == pytest.approx(float(np.polyval(bank[::-1], s)), abs=1e-12)
        slope = float(np.polyval(np.polyder(height[::-1]), s))
        assert part["lane.grade"] == pytest.approx(slope, abs=1e-9)  # the lane's middle is the reference line


def test_a_lane_has_its_own_length_curvature_and_width(new_road: NewRoad) -> None:
    part = new_road(RING.path(lanes=(lane(0, -3.5, 0.0), lane(1, 0.0, 3.0), lane(-1, -6.5, -3.5))))
    for number, middle, width in ((0, -1.75, 3.5), (1, 1.5, 3.0), (-1, -5.0, 3.0)):
        part["start_lane"] = number
        here = RING.at(100.0)
        put(part, *here.beside(middle + 0.3), here.heading - 0.1)
        part.init()
        # Lengths along the road are those of the path's own lane, whichever lane the host drives in.
        assert part["lane.station"] == pytest.approx(100 * (120 + 1.75) / 120, abs=1e-8)
        assert part["lane.offset"] == pytest.approx(0.3, abs=1e-9)
        assert part["lane.heading"] == pytest.approx(-0.1, abs=1e-9)
        assert part["lane.curvature"] == pytest.approx(1 / (120 - middle), rel=1e-8)
        assert part["lane.width"] == pytest.approx(width, abs=1e-12)


def test_a_lane_that_swings_out_has_the_heading_and_curvature_of_its_middle(new_road: NewRoad) -> None:
    # A straight reference line: the middle is y = c(x) itself, with its textbook slope and curvature.
    c = (0.5, 0.02, 3e-3, -4e-5)
    border = [cubics([(0.0, (c[0] + side, *c[1:]))]) for side in (1.5, -1.5)]
    part = new_road(LINE.path(lanes=(LaneBand(0, *border, constant(1.0)),)))
    middle = np.polynomial.Polynomial(c)
    for x in (3.0, 20.0, 44.0):
        slope, bend = middle.deriv()(x), middle.deriv(2)(x)
        put(part, x, middle(x), 0.0)
        part.init()
        assert part["lane.heading"] == pytest.approx(-math.atan(slope), abs=1e-12)
        assert part["lane.curvature"] == pytest.approx(bend / (1 + slope**2) ** 1.5, rel=1e-9)
        length, _ = quad(lambda u: math.hypot(1, middle.deriv()(u)), 0, x, epsabs=1e-12)
        assert part["lane.station"] == pytest.approx(length, abs=1e-8)


def test_the_host_starts_on_its_lane_where_its_parameters_say(new_road: NewRoad) -> None:
    part = new_road(WINDING.path(lanes=TWO_LANES), start_station=0.0, start_lane=1, start_offset=-0.2)
    part.init()
    assert (part["start.x"], part["start.y"]) == pytest.approx(WINDING.at(0).beside(1.55), abs=1e-9)
    assert part["start.heading"] == pytest.approx(0.4, abs=1e-12)
    part["start_station"], part["start_lane"] = 200.0, 0
    part.init()
    put(part, part["start.x"], part["start.y"], part["start.heading"])
    part.step()
    assert part["lane.station"] == pytest.approx(200, abs=1e-9)
    assert part["lane.offset"] == pytest.approx(-0.2, abs=1e-9)
    assert part["lane.heading"] == pytest.approx(0, abs=1e-9)


def test_a_lane_that_is_not_there_is_no_number_so_that_the_run_ends_by_name(new_road: NewRoad) -> None:
    part = new_road(LINE.path(), start_lane=3)
    part.init()
    assert math.isnan(part["start.x"])
    assert math.isnan(part["lane.offset"])


def test_patches_lanes_and_weather_decide_about_friction(new_road: NewRoad) -> None:
    patches = (Patch(20.0, 60.0, -2.0, 0.0, 0.3), Patch(30.0, 35.0, -2.0, 2.0, 0.1))
    lanes = (lane(0, -3.5, 0.0), lane(1, 0.0, 3.5, friction=0.8))
    part = new_road(LINE.path(lanes=lanes, patches=patches))
    part.init()
    wheels = [(25.0, -1.0), (25.0, 1.0), (32.0, -1.0), (61.0, -1.0)]
    for loss in (0.0, 0.4):
        part["surface.friction_loss"] = loss
        for wheel, (x, y) in enumerate(wheels, 1):
            part[f"contacts[{wheel}].x"], part[f"contacts[{wheel}].y"] = x, y
        part.step()
        found = [part[f"ground[{wheel}].friction"] for wheel in range(1, 5)]
        assert found == pytest.approx([0.3 * (1 - loss), 0.8 * (1 - loss), 0.1 * (1 - loss), 1 - loss], abs=1e-15)


def test_speed_limits_hold_from_their_station_on_and_the_road_ends_beside_its_lanes(new_road: NewRoad) -> None:
    part = new_road(LINE.path(lanes=TWO_LANES, speed_limit=cubics([(0.0, [0.0]), (50.0, [22.0]), (80.0, [14.0])])))
    for x, y, limit, on_road in ((49.0, -3.4, 0, 1), (51.0, 3.4, 22, 1), (80.0, 3.6, 14, 0), (90.0, -3.6, 14, 0)):
        put(part, x, y)
        part.init()
        assert (part["lane.speed_limit"], part["lane.on_road"]) == (limit, on_road)


@pytest.mark.parametrize("number", [0, 1])
def test_preview_points_lie_on_the_lane_at_equal_distances(new_road: NewRoad, number: int) -> None:
    part = new_road(RING.path(lanes=TWO_LANES), start_lane=number, preview_spacing=3.0)
    middle = (-1.75, 1.75)[number]
    here = RING.at(50.0)
    x, y = here.beside(middle + 0.4)
    heading = here.heading + 0.07
    put(part, x, y, heading)
    part.init()
    for i in range(1, 25):
        phi = here.heading + 3.0 * i / (120 - middle)
        px, py = (120 - middle) * math.sin(phi) - x, 120 - (120 - middle) * math.cos(phi) - y
        assert part[f"preview[{i}].distance"] == 3.0 * i
        assert part[f"preview[{i}].x"] == pytest.approx(px * math.cos(heading) + py * math.sin(heading), abs=1e-8)
        assert part[f"preview[{i}].y"] == pytest.approx(py * math.cos(heading) - px * math.sin(heading), abs=1e-8)
        assert part[f"preview[{i}].heading"] == pytest.approx(angle(phi - heading), abs=1e-8)
        assert part[f"preview[{i}].curvature"] == pytest.approx(1 / (120 - middle), rel=1e-8)


def test_preview_keeps_its_distances_over_clothoids_and_where_the_curvature_jumps(new_road: NewRoad) -> None:
    middle = -1.75
    part = new_road(WINDING.path(lanes=TWO_LANES), preview_spacing=2.5)

    def length(a: float, b: float) -> float:
        return quad(lambda s: 1 - WINDING.at(s).curvature * middle, a, b, points=[410.0], epsabs=1e-10, limit=200)[0]

    for s in (60.0, 225.0, 380.0):
        here = WINDING.at(s)
        put(part, *here.beside(middle), here.heading)
        part.init()
        for i in (1, 8, 24):
            place = brentq(lambda b, i=i, s=s: length(s, b) - 2.5 * i, s, s + 80, xtol=1e-10)
            there = WINDING.at(place)
            px, py = np.array(there.beside(middle)) - here.beside(middle)
            assert part[f"preview[{i}].x"] == pytest.approx(
                px * math.cos(here.heading) + py * math.sin(here.heading), abs=1e-7
            )
            assert part[f"preview[{i}].heading"] == pytest.approx(angle(there.heading - here.heading), abs=1e-7)


def test_without_a_spacing_there_is_no_preview(new_road: NewRoad) -> None:
    part = new_road(RING.path())
    part.init()
    assert [part[f"preview[{i}].distance"] for i in range(1, 25)] == [0.0] * 24


def move(part: Any, number: int, **values: float) -> None:
    values = {"class": "car", "length": 4.5, "width": 1.8, "height": 1.5, "id": number} | values
    for name, value in values.items():
        part[f"movers[{number}].{name}"] = value


def test_movers_stand_in_the_world_where_their_lane_is(new_road: NewRoad) -> None:
    other = Traced([(100.0, 0.0, 0.0)], Frame(50.0, 40.0, -2.0, 0.0))
    height = cubics([(0.0, [7.0])])
    part = new_road(RING.path(lanes=TWO_LANES, height=height), other.path(name="side"))
    move(part, 2, lane=1, station=30.0, offset=0.4, turn=0.2, speed=10.0, lateral_speed=0.5, acceleration=-1.0)
    move(part, 3, path=1, station=20.0, speed=8.0, height=6.0, clearance=4.5)
    part.init()
    s = 30 * 120 / 121.75
    here = RING.at(s)
    assert part["actors[1].class"] == 0
    assert part["actors[1].x"] == 0
    assert (part["actors[2].x"], part["actors[2].y"]) == pytest.approx(here.beside(2.15), abs=1e-8)
    assert part["actors[2].z"] == pytest.approx(7, abs=1e-12)
    assert part["actors[2].heading"] == pytest.approx(here.heading + 0.2, abs=1e-9)
    # In stations of the own lane it is this fast along the lane; at its place the lane is shorter.
    along = (10 * math.cos(0.2) - 0.5 * math.sin(0.2)) * (120 - 2.15) / 121.75
    across = 10 * math.sin(0.2) + 0.5 * math.cos(0.2)
    assert part["actors[2].speed"] == pytest.approx(along * math.cos(0.2) + across * math.sin(0.2), abs=1e-8)
    assert part["actors[2].lateral_speed"] == pytest.approx(across * math.cos(0.2) - along * math.sin(0.2), abs=1e-8)
    assert part["actors[2].acceleration"] == -1
    there = other.at(20.0)
    assert (part["actors[3].x"], part["actors[3].y"]) == pytest.approx((there.x, there.y), abs=1e-9)
    assert (part["actors[3].heading"], part["actors[3].speed"]) == pytest.approx((-2.0, 8.0), abs=1e-9)
    assert (part["actors[3].height"], part["actors[3].clearance"]) == (6.0, 4.5)


def test_what_drives_ahead_is_told_along_the_own_lane_whatever_path_it_is_on(new_road: NewRoad) -> None:
    here = RING.at(40.0)
    beside = Traced([(400.0, 1 / 116, 1 / 116)], Frame(*here.beside(4.0), here.heading, 0.0))
    part = new_road(RING.path(lanes=TWO_LANES), beside.path(name="inside"))
    host = RING.at(20.0)
    put(part, *host.beside(-1.25), host.heading, speed=20.0)
    move(part, 1, station=70.0, speed=15.0, offset=0.5)
    move(part, 2, lane=1, station=5.0, speed=15.0)
    move(part, 3, path=1, station=58.0, speed=12.0)
    part.init()
    at, rate = 20 * 121.75 / 120, 20 * 121.75 / 121.25
    assert part["actors[1].ahead"] == pytest.approx(70 - at, abs=1e-8)
    assert part["actors[1].aside"] == pytest.approx(0.5, abs=1e-9)
    assert part["actors[1].approach"] == pytest.approx(rate - 15, abs=1e-8)
    assert part["actors[2].ahead"] == pytest.approx(5 - at, abs=1e-8)
    assert part["actors[2].aside"] == pytest.approx(3.5, abs=1e-9)
    assert part["actors[3].ahead"] == pytest.approx((40 + 58 * 120 / 116) * 121.75 / 120 - at, abs=1e-8)
    assert part["actors[3].aside"] == pytest.approx(5.75, abs=1e-8)
    assert part["actors[3].approach"] == pytest.approx(rate - 12 * 121.75 / 116, abs=1e-8)


def test_on_a_closed_path_the_one_ahead_is_not_a_lap_behind(new_road: NewRoad) -> None:
    part = new_road(RING.path(closed=True))
    here = RING.at(RING.length - 5)
    put(part, here.x, here.y, here.heading)
    move(part, 1, station=10.0)
    move(part, 2, station=RING.length - 30)
    part.init()
    assert part["actors[1].ahead"] == pytest.approx(15, abs=1e-8)
    assert part["actors[2].ahead"] == pytest.approx(-25, abs=1e-8)


def test_movers_on_a_path_or_lane_that_is_not_there_are_no_numbers(new_road: NewRoad) -> None:
    part = new_road(LINE.path(lanes=ONE_LANE))
    move(part, 1, lane=1)
    move(part, 2, path=1)
    part.init()
    assert math.isnan(part["actors[1].x"])
    assert math.isnan(part["actors[2].y"])


def test_actors_never_teleport(new_road: NewRoad) -> None:
    part = new_road(RING.path(closed=True, lanes=TWO_LANES), WINDING.path(name="winding"))
    h = 0.01

    @settings(max_examples=40, deadline=None, derandomize=True)
    @given(
        path=st.integers(0, 1), begin=st.floats(0, 400), speed=st.floats(-30, 60), offset=st.floats(-2, 2),
        drift=st.floats(-1, 1), turn=st.floats(-3, 3),
    )  # fmt: skip
    def check(path: int, begin: float, speed: float, offset: float, drift: float, turn: float) -> None:
        part.init()
        last = None
        for k in range(60):
            rate = speed * math.cos(turn) - drift * math.sin(turn)
            across = speed * math.sin(turn) + drift * math.cos(turn)
            move(part, 1, path=path, station=begin + rate * h * k, offset=offset + across * h * k, turn=turn,
                 speed=speed, lateral_speed=drift)  # fmt: skip
            part.step(h)
            now = [part[f"actors[1].{name}"] for name in ("x", "y", "heading", "speed", "lateral_speed")]
            if last is not None:
                # It goes as its velocity says, but for half a step of turning (R > 95 m).
                means = [(a + b) / 2 for a, b in zip(last[2:], now[2:], strict=True)]
                if abs(last[2] - now[2]) < 1:
                    vx = means[1] * math.cos(means[0]) - means[2] * math.sin(means[0])
                    vy = means[1] * math.sin(means[0]) + means[2] * math.cos(means[0])
                    assert now[0] - last[0] == pytest.approx(vx * h, abs=2e-4)
                    assert now[1] - last[1] == pytest.approx(vy * h, abs=2e-4)
                assert abs(angle(now[2] - last[2])) <= (abs(speed) + abs(drift)) * h / 90 + 1e-12
            last = now

    check()
