"""Where paths cross and join, and who gives way there."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from components.conftest import WORKSPACE
from kinds.examples import EXAMPLES
from world.test_road_core import put
from world.traced_roads import Frame, Traced

from dse.errors import DseError
from dse.formats import read_xml
from dse.loading import kind_of
from dse.testing.kinds import lay_out, the_component
from dse.world import (
    WIDTH,
    Conflict,
    Light,
    Network,
    RoadPath,
    Route,
    find_conflict_areas,
    lane_middle,
    network_in,
    opendrive_of,
    place,
    road_tables,
)

EAST = Traced([(100.0, 0.0, 0.0)], Frame(-40.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("degrees", [90, 60, 30, 15, -45, 120, 165])
def test_lanes_that_cross_are_in_the_way_for_the_closed_form(degrees: float) -> None:
    angle = math.radians(degrees)
    crossing = Traced([(120.0, 0.0, 0.0)], Frame(-70 * math.cos(angle), -70 * math.sin(angle), angle, 0.0))
    one, other = EAST.path(), crossing.path()
    (met,) = find_conflict_areas(one, other)
    # Both middles lie t to the left of their lines, and cross at (x, t).
    t = float(lane_middle(one, np.zeros(1))[0])
    x = t * (math.cos(angle) - 1) / math.sin(angle)
    along = 70 + x * math.cos(angle) + t * math.sin(angle)
    half = WIDTH / 2 * (1 + abs(math.cos(angle))) / abs(math.sin(angle))
    told = (met.entry, met.exit, met.other_entry, met.other_exit)
    assert told == pytest.approx((40 + x - half, 40 + x + half, along - half, along + half), abs=1e-4)


def test_a_lane_that_joins_is_in_the_way_until_both_are_one_and_one_that_parts_is_not() -> None:
    bend = math.pi / 3
    joining = Traced([(30 * bend, 1 / 30, 1 / 30), (50.0, 0.0, 0.0)],
                     Frame(-30 * math.sin(bend), 30 - 30 * math.cos(bend), -bend, 0.0))  # fmt: skip
    # On the reference lines themselves: a circle of 30 m and its tangent.
    one, other = (replace(each.path(), lanes=(on_the_line(each.path()),)) for each in (EAST, joining))
    (met,) = find_conflict_areas(one, other)
    # The nearest lane's points: the vehicle's side touches where the circle's centre is 31 m from its upper corner.
    assert met.entry == pytest.approx(40 - math.sqrt(31**2 - 29**2), abs=1e-3)
    assert met.exit == pytest.approx(40 - math.sqrt(30.25**2 - 30**2), abs=0.01)
    assert met.other_exit == pytest.approx(30 * bend - 30 * math.acos(29.75 / 30), abs=0.01)
    parting = Traced([(50.0, 0.0, 0.0), (30 * bend, 1 / 30, 1 / 30)], Frame(-40.0, 0.0, 0.0, 0.0)).path()
    assert list(find_conflict_areas(one, replace(parting, lanes=(on_the_line(parting),)))) == []


def on_the_line(path: RoadPath) -> Any:
    own = path.lanes[0]
    return replace(own, left=shifted(own.left, 1.75), right=shifted(own.right, -1.75))


def shifted(border: Any, to: float) -> Any:
    return replace(border, starts=np.zeros(1), coefficients=np.array([[to]]))


def brute(one: RoadPath, other: RoadPath) -> list[tuple[float, float]]:
    """The stations of *one* whose width comes within half a width of *other*, by points 5 and 10 cm apart."""
    s, u = (np.arange(0, path.length, step) for path, step in ((one, 0.2), (other, 0.1)))
    centre = place(other, u, lane_middle(other, u))
    across = np.linspace(-WIDTH / 2, WIDTH / 2, 41)
    touch = []
    for at in s:
        t = lane_middle(one, np.array([at])) + across
        spot = place(one, np.full(41, at), t)
        far = np.hypot(spot.x[:, None] - centre.x, spot.y[:, None] - centre.y)
        touch.append(far.min() <= WIDTH / 2)
    edges = np.flatnonzero(np.diff([0, *map(int, touch), 0]))
    return [(float(s[a]), float(s[b - 1])) for a, b in zip(edges[::2], edges[1::2], strict=True)]


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(seed, marks=pytest.mark.thorough) for seed in range(2, 20))])
def test_winding_lanes_that_cross_agree_with_brute_force(seed: int) -> None:
    chance = np.random.default_rng(seed)
    k = chance.uniform(-1 / 25, 1 / 25, 5)
    winding = Traced([(25.0, k[0], k[1]), (25.0, k[1], k[2]), (30.0, k[3], k[3])], Frame(-25.0, 0.0, 0.0, 0.0)).path()
    there = Traced([(45.0, k[4], k[0])], Frame(0.0, -25.0, math.pi / 2 + chance.uniform(-0.5, 0.5), 0.0)).path()
    found = list(find_conflict_areas(winding, there))
    assert [(met.entry, met.exit) for met in found] == [pytest.approx(pair, abs=0.25) for pair in brute(winding, there)]
    assert [(met.other_entry, met.other_exit) for met in found] == [
        pytest.approx(pair, abs=0.25) for pair in brute(there, winding)
    ]


def test_a_bridge_is_no_crossing_and_a_ring_is_crossed_beyond_its_seam() -> None:
    across = Traced([(100.0, 0.0, 0.0)], Frame(0.0, -50.0, math.pi / 2, 0.0)).path()
    high = replace(across, height=shifted(across.height, 5.0))
    assert list(find_conflict_areas(EAST.path(), high)) == []
    assert len(list(find_conflict_areas(EAST.path(), across))) == 1
    ring = Traced([(2 * math.pi * 20, 1 / 20, 1 / 20)], Frame(0.0, -20.0, 0.0, 0.0))
    (there, here) = find_conflict_areas(replace(ring.path(), closed=True), across)
    # The ring is crossed at its top, and at its bottom, where it begins.
    assert (there.entry + there.exit) / 2 == pytest.approx(ring.length / 2, abs=1e-3)
    assert (here.entry + here.exit) / 2 == pytest.approx(ring.length, abs=1e-3)
    assert here.entry < ring.length < here.exit


def network(name: str, *changes: tuple[str, str]) -> Network:
    text = opendrive_of(WORKSPACE.road(name))
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return network_in(read_xml(text.encode(), name))


def rows(name: str, *routes: str, changes: tuple[tuple[str, str], ...] = ()) -> tuple[Conflict, ...]:
    return road_tables(network(name, *changes), [Route(tuple(route.split())) for route in routes]).conflicts


def duties(found: tuple[Conflict, ...]) -> list[tuple[int, int, bool]]:
    return [(each.path, each.other_path, each.gives_way) for each in found]


HOST, FROM_THE_LEFT, FROM_THE_RIGHT, ONCOMING_LEFT = "1 7 2", "3 16 4", "4 19 3", "2 13 4"
DARK = (('code="dse.phases"', 'code="dark"'), ('code="dse.phases"', 'code="dark"'))


def test_lights_see_to_it_but_for_who_turns_left_before_those_who_come_from_ahead() -> None:
    assert duties(rows("intersection", HOST, FROM_THE_LEFT)) == [(0, 1, False), (1, 0, False)]
    assert duties(rows("intersection", HOST, ONCOMING_LEFT)) == [(0, 1, False), (1, 0, True)]


def test_where_lights_are_dark_right_goes_before_left() -> None:
    found = duties(rows("intersection", HOST, FROM_THE_LEFT, FROM_THE_RIGHT, ONCOMING_LEFT, changes=DARK))
    wanted = {(0, 1): False, (0, 2): True, (0, 3): False, (1, 3): False, (2, 3): True}
    assert {(one, other): gives_way for one, other, gives_way in found} == {
        **wanted, **{(other, one): not gives_way for (one, other), gives_way in wanted.items()}
    }  # fmt: skip


@pytest.mark.parametrize(("kind", "first"), [("205", False), ("206", False), ("301", True), ("306", True)])
def test_signs_go_before_right_before_left(kind: str, first: bool) -> None:
    sign = f'<signal id="s" s="190" t="-8" orientation="+" country="DE" type="{kind}" dynamic="no"/>'
    for route in (FROM_THE_LEFT, FROM_THE_RIGHT):
        found = rows("intersection", HOST, route, changes=(*DARK, ("<signals>", f"<signals>{sign}")))
        assert duties(found) == [(0, 1, not first), (1, 0, first)]


def test_a_priority_of_the_junction_goes_before_signs() -> None:
    sign = '<signal id="s" s="190" t="-8" orientation="+" country="DE" type="301" dynamic="no"/>'
    junction = '<controller id="5a" type="0"/>'
    changes = (*DARK, ("<signals>", f"<signals>{sign}"), (junction, f'<priority high="16" low="7"/>{junction}'))
    assert duties(rows("intersection", HOST, FROM_THE_LEFT, changes=changes)) == [(0, 1, True), (1, 0, False)]


def test_who_enters_a_roundabout_gives_way_whether_priorities_or_a_group_say_so() -> None:
    routes = "1 18 10 19 11 23 2", "3 15 9 16 10 20 4", "4 21 11 22 12 14 3"
    wanted = [(0, 1, True), (0, 2, False), (1, 0, False), (2, 0, True)]
    assert duties(rows("roundabout", *routes)) == wanted
    text = opendrive_of(WORKSPACE.road("roundabout"))
    ranks = [line.strip() for line in text.splitlines() if "<priority" in line]
    ids = [line.split('id="')[1].split('"')[0] for line in text.splitlines() if "<junction " in line]
    group = '<junctionGroup id="g" name="" type="roundabout">' + "".join(
        f'<junctionReference junction="{each}"/>' for each in ids
    )
    changes = (*((rank, "") for rank in ranks), ("</OpenDRIVE>", f"{group}</junctionGroup></OpenDRIVE>"))
    assert duties(rows("roundabout", *routes, changes=changes)) == wanted


def test_a_road_tells_its_paths_lights_and_conflicts(new_road: Callable[..., Any]) -> None:
    tables = road_tables(network("intersection"), [Route(tuple(r.split())) for r in ("1 6 2", FROM_THE_LEFT)])
    part = new_road(*tables.paths, conflicts=tables.conflicts)
    put(part, 100.0, -5.25)
    part.init()
    # It keeps to the inner one of two lanes; the oncoming ones are not its own.
    assert (part["paths[1].leftmost"], part["paths[1].rightmost"], part["paths[2].rightmost"]) == (0, -1, 0)
    assert part["paths[1].length"] == pytest.approx(tables.paths[0].length, abs=1e-6)
    assert (part["paths[1].lane_width"], part["paths[3].length"]) == (pytest.approx(3.5), 0.0)
    for i, row in enumerate(tables.conflicts, 1):
        told = [part[f"conflicts[{i}].{name}"] for name in ("path", "entry", "exit", "other_path", "gives_way")]
        assert told == [row.path, pytest.approx(row.entry), pytest.approx(row.exit), row.other_path, row.gives_way]
    assert (part["conflicts[3].entry"], part["conflicts[3].exit"]) == (0.0, 0.0)
    assert [part[f"light_heads[{i}].path"] for i in (1, 2)] == [0, 1]
    assert part["light_heads[3].colour"] == 0


def test_heads_of_the_hosts_path_show_what_it_is_told_of_the_light_ahead_to_the_tick(
    new_road: Callable[..., Any],
) -> None:
    phases = (("green", 1.3), ("yellow", 0.7), ("red", 2.1))
    part = new_road(replace(EAST.path(), lights=(Light("1", 60.0, phases, 0.37), Light("2", 90.0, (), 0.0))))
    put(part, 0.0, 0.0)
    part.init()
    for _ in range(900):
        assert part["light_heads[1].colour"] == part["light.colour"]
        assert part["light_heads[1].remaining"] == part["light.remaining"]
        assert (part["light_heads[2].colour"], part["light_heads[2].path"]) == (1, 0)
        part.step(0.01)
    assert part["light_heads[1].station"] == pytest.approx(60.0)


@pytest.mark.thorough
def test_more_than_a_road_can_tell_is_refused(tmp_path: Path) -> None:
    files = dict(EXAMPLES["road"]())
    many = ", ".join(f"p{i}: {{route: [1]}}" for i in range(8))
    text = str(files["twice/component.yaml"]).replace("{same: {route: [1]}}", f"{{{many}}}")
    component = the_component(lay_out({**files, "twice/component.yaml": text}, tmp_path))
    kind = kind_of(component)
    assert kind is not None
    with pytest.raises(DseError, match="9 paths: a road has at most 8"):
        kind.check(component, component.source)
