"""How road users of a scenario move, against closed forms: one file with all of them, built and run once."""

from __future__ import annotations

import math

import numpy as np
import pytest
from opendrive_texts import geometry, lane as lane_of, opendrive, road, section
from scenario_texts import after, car, event, lane, lane_change, private, scenario, speed, story, teleport, world
from scenario_tracks import Track, played_tracks

from dse.world.openscenario.scenario import Scenario

ARC = '<arc curvature="-0.01"/>'
LINK = '<{0} elementType="{1}" elementId="{2}"{3}/>'
JUNCTION = """<junction id="9" name="" type="direct">
<connection id="0" incomingRoad="0" linkedRoad="1" contactPoint="start"><laneLink from="-1" to="-1"/></connection>
<connection id="1" incomingRoad="0" linkedRoad="2" contactPoint="start"><laneLink from="-2" to="-1"/></connection>
</junction>
"""
# Lane -2 of road 0 is an exit: it goes on in road 2, which bends to the right.
ROADS = opendrive(
    road("0", geometry(0.0, 0.0, 0.0, 0.0, 300.0), 300.0, section(0.0, lane_of(1), lane_of(-1) + lane_of(-2)),
         link=LINK.format("successor", "junction", 9, "")),
    road("1", geometry(0.0, 300.0, 0.0, 0.0, 300.0), 300.0, section(0.0, "", lane_of(-1)),
         link=LINK.format("predecessor", "junction", 9, "")),
    road("2", geometry(0.0, 300.0, -3.5, 0.0, 150.0, ARC), 150.0, section(0.0, "", lane_of(-1)),
         link=LINK.format("predecessor", "junction", 9, "")),
    JUNCTION,
)  # fmt: skip
TRAILER = """<TrailerHitch dx="-1"/><Trailer><Trailer name="t"><Vehicle name="t" vehicleCategory="trailer"><BoundingBox>
<Center x="1" y="0" z="0.7"/><Dimensions width="2" length="4" height="1"/></BoundingBox><TrailerCoupler dx="3"/>
</Vehicle></Trailer></Trailer></Vehicle>"""
WEAK = '<Performance maxSpeed="50" maxAcceleration="2" maxDeceleration="4"/></Vehicle>'
FOLLOWED = """<PrivateAction><RoutingAction><FollowTrajectoryAction><Trajectory name="l" closed="false"><Shape>
<Polyline>{}</Polyline></Shape></Trajectory><TimeReference>{}</TimeReference>
<TrajectoryFollowingMode followingMode="follow"/></FollowTrajectoryAction></RoutingAction></PrivateAction>"""
RELATIVE = '<Timing domainAbsoluteRelative="relative" scale="1" offset="0"/>'
AS_FAST = speed(0).replace(
    '<AbsoluteTargetSpeed value="0"/>',
    '<RelativeTargetSpeed entityRef="{}" value="{}" speedTargetValueType="{}" continuous="{}"/>',
)
WAITING = after(0).replace('delay="0"', 'delay="1"')
STARTED = """<StartTrigger><ConditionGroup><Condition name="c" delay="0" conditionEdge="none"><ByValueCondition>
<StoryboardElementStateCondition storyboardElementType="event" storyboardElementRef="first" state="startTransition"/>
</ByValueCondition></Condition></ConditionGroup></StartTrigger>"""
CLEAR = """<StartTrigger><ConditionGroup><Condition name="c" delay="0" conditionEdge="none"><ByEntityCondition>
<TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="{}"/></TriggeringEntities><EntityCondition>
<RelativeClearanceCondition distanceForward="60" distanceBackward="60" oppositeLanes="false" freeSpace="false">
<RelativeLaneRange from="{}" to="{}"/>{}</RelativeClearanceCondition></EntityCondition></ByEntityCondition></Condition>
</ConditionGroup></StartTrigger>"""


def points(*vertices: tuple[float, float]) -> str:
    return "".join(f'<Vertex time="{t}">{world(x, -80)}</Vertex>'.replace(' h="0"', "") for t, x in vertices)


ENTITIES = {
    "exit": car("exit"),
    "leader": car("leader"),
    "weak": car("weak").replace("</Vehicle>", WEAK),
    "tow": car("tow").replace("</Vehicle>", TRAILER),
    "long": car("long").replace("</Vehicle>", TRAILER),
    "timed": car("timed"),
    "backwards": car("backwards"),
    "twice": car("twice"),
    "first": car("first"),
    "second": car("second"),
    "nowhere": car("nowhere"),
    "alone": car("alone"),
}
INIT = {
    "exit": (teleport(lane(150)), speed(20)),
    "leader": (teleport(lane(20)), speed(20)),
    "weak": (teleport(world(0, -50)), AS_FAST.format("leader", 1, "factor", "true")),
    "tow": (teleport(world(0, -100)), speed(10)),
    "long": (teleport(lane(5)), speed(10)),
    "timed": (teleport(world(0, -80)), speed(10), FOLLOWED.format(points((0, 0), (4, 60), (6, 70)), RELATIVE)),
    "backwards": (teleport(world(0, -80)), speed(-5), FOLLOWED.format(points((0, 0), (0, 100)), "<None/>")),
    "twice": (teleport(world(0, -120)), speed(5)),
    "first": (teleport(world(0, -130)), speed(1)),
    "second": (teleport(world(0, -140)), speed(1)),
    "nowhere": (teleport(lane(10)), speed(1)),
    "alone": (teleport(lane(30)), speed(1)),
}
TURN = "<PrivateAction><TeleportAction>" + world(30, -100, math.pi / 2) + "</TeleportAction></PrivateAction>"
STORIES = (
    story("exit", event("change", lane_change(-2), after(1)))
    + story("leader", event("faster", speed(30), after(1)))
    + story("long", event("aside", lane_change(-2), after(1)))
    + story("tow", event("turn", TURN, after(4)))
    + story("twice", event("more", AS_FAST.format("twice", 5, "delta", "false"), WAITING).replace(
        'priority="parallel"', 'priority="parallel" maximumExecutionCount="2"'))
    + story("first", event("first", speed(10), after(1)))
    + story("second", event("second", speed(10), STARTED))
    + story("nowhere", event("never", speed(9), CLEAR.format("nowhere", 2, 3, "")))
    + story("alone", event("at once", speed(9), CLEAR.format("alone", 0, 0, '<EntityRef entityRef="exit"/>')))
)  # fmt: skip


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> tuple[Scenario, dict[str, Track]]:
    folder = tmp_path_factory.mktemp("movement")
    init = "".join(private(name, *actions) for name, actions in INIT.items())
    text = scenario("".join(ENTITIES.values()), init, STORIES, road="roads.xodr")
    return played_tracks(folder, text, ROADS)


def test_who_changed_to_an_exit_lane_takes_the_exit(played: tuple[Scenario, dict[str, Track]]) -> None:
    x, y, heading, _ = played[1]["exit"].T
    assert x[75] < 300 < x[85]
    # Lane -1 of road 2 has a radius of 98.25 m around (300, -103.5).
    away = np.hypot(x[85:] - 300, y[85:] + 103.5)
    assert away == pytest.approx(np.full(36, 98.25), abs=1e-3)
    angle = np.arctan2(x[85:] - 300, y[85:] + 103.5)
    assert heading[85:] == pytest.approx(-angle, abs=1e-4)
    # 20 m/s along the lane; each step is one of Euler's.
    assert np.diff(angle) * 98.25 == pytest.approx(np.full(35, 2.0), abs=1e-3)


def test_a_speed_that_is_followed_stays_within_the_limits(played: tuple[Scenario, dict[str, Track]]) -> None:
    t = 0.1 * np.arange(121)
    assert played[1]["leader"][[10, 11], 3].tolist() == [20, 30]
    # The leader jumps to 30 m/s at 1 s; who follows at 2 m/s2 is one step of 0.01 s late.
    assert played[1]["weak"][:, 3] == pytest.approx(np.clip(20 + 2 * (t - 1), 20, 30), abs=0.03)


@pytest.mark.parametrize("name", ["tow", "long"])
def test_a_trailer_keeps_its_coupler_at_the_hitch(played: tuple[Scenario, dict[str, Track]], name: str) -> None:
    tow, trailer = played[1][name], played[1][f"{name}+"]
    hitch = tow[:, :2] - np.column_stack([np.cos(tow[:, 2]), np.sin(tow[:, 2])])
    coupler = trailer[:, :2] + 3 * np.column_stack([np.cos(trailer[:, 2]), np.sin(trailer[:, 2])])
    assert coupler == pytest.approx(hitch, abs=1e-6)


def test_a_trailer_follows_its_tow_and_stands_straight_where_it_is_put(
    played: tuple[Scenario, dict[str, Track]],
) -> None:
    assert played[1]["tow+"][10] == pytest.approx((6, -100, 0, 10), abs=1e-6)
    assert played[1]["tow+"][45, 2] == pytest.approx(math.pi / 2)
    # 10 m/s over 3 m, drawn 1 m behind the axle: 0.3 b' + b = h - 0.1 h'. 3.5 m in 4 s turn the tow by 0.137 rad.
    heading, behind = played[1]["long"][:, 2], played[1]["long+"][:, 2]
    assert np.ptp(heading) == pytest.approx(0.137, abs=0.002)
    rates = np.gradient(heading, 0.1), np.gradient(behind, 0.1)
    # Where the lane change begins and ends the rates jump.
    assert behind + 0.3 * rates[1] == pytest.approx(heading - 0.1 * rates[0], abs=0.006)


def test_a_line_that_is_followed_is_passed_at_its_times(played: tuple[Scenario, dict[str, Track]]) -> None:
    x, _, _, v = played[1]["timed"].T
    t = 0.1 * np.arange(41)
    # From 10 m/s over 60 m in 4 s with a constant acceleration, 2.5 m/s2; the next 10 m are too short: it stops there.
    assert x[:41] == pytest.approx(10 * t + 1.25 * t**2, abs=1e-6)
    t = 0.1 * np.arange(11)
    assert x[40:51] == pytest.approx(60 + 20 * t - 10 * t**2, abs=1e-6)
    assert x[50:60] == pytest.approx(np.full(10, 70.0))
    assert v[55] == pytest.approx(0)


def test_who_begins_to_reverse_faces_back_along_the_line(played: tuple[Scenario, dict[str, Track]]) -> None:
    x, _, heading, v = played[1]["backwards"].T
    assert x == pytest.approx(0.5 * np.arange(121))
    assert np.cos(heading) == pytest.approx(np.full(121, -1.0))
    assert np.all(v == -5)


def test_a_repeated_event_waits_for_its_delay_again(played: tuple[Scenario, dict[str, Track]]) -> None:
    v = played[1]["twice"][:, 3]
    assert [float(v[i]) for i in (9, 15, 19, 25, 60)] == [5, 10, 10, 15, 15]


def test_what_starts_is_seen_in_its_own_step_by_what_comes_later(played: tuple[Scenario, dict[str, Track]]) -> None:
    assert played[1]["second"][:, [0, 3]] == pytest.approx(played[1]["first"][:, [0, 3]])
    assert played[1]["first"][11, 3] == 10


def test_clearance_asks_for_its_entities_and_for_lanes_that_are_there(
    played: tuple[Scenario, dict[str, Track]],
) -> None:
    assert np.all(played[1]["nowhere"][:, 3] == 1)
    assert played[1]["alone"][1, 3] == 9
