from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from opendrive_texts import connection, geometry, lane, network, road, section, to_junction, to_road

from dse.errors import DseError
from dse.world import Route, lane_graph, lane_middle, list_ways, place, road_tables, value, way_of

_QUARTER = math.pi / 2


def _crossing() -> list[str]:
    """Four arms of 50 m meet; from the west (1) one goes straight on to the east (2), left to the north (3).

    Arms 1 and 3 begin far away; arm 2 begins at the crossing.
    """
    arms = [
        road("1", geometry(0.0, -60.0, 0.0, 0.0, 50.0), 50.0, link=to_junction("successor", "100")),
        road("2", geometry(0.0, 10.0, 0.0, 0.0, 50.0), 50.0, link=to_junction("predecessor", "100")),
        road("3", geometry(0.0, 0.0, 60.0, -_QUARTER, 50.0), 50.0, link=to_junction("successor", "100")),
    ]
    straight = road(
        "10",
        geometry(0.0, -10.0, 0.0, 0.0, 20.0),
        20.0,
        section(0.0, "", lane(-1, before=-1, after=-1)),
        junction="100",
        link=to_road("predecessor", "1", "end") + to_road("successor", "2", "start"),
    )
    bend = 10.0 * _QUARTER
    left = road(
        "11",
        geometry(0.0, -10.0, 0.0, 0.0, bend, '<arc curvature="0.1"/>'),
        bend,
        section(0.0, "", lane(-1, before=-1, after=1)),
        junction="100",
        link=to_road("predecessor", "1", "end") + to_road("successor", "3", "end"),
    )
    joined = connection("1", "11", "start", [(-1, -1)]) + connection("1", "10", "start", [(-1, -1)])
    return [*arms, straight, left, f'<junction id="100" name="x">{joined}</junction>']


def _ring(pieces: int = 2) -> list[str]:
    """A circle of 40 m radius of as many roads, each linked to the next."""
    length = math.tau * 40.0 / pieces
    roads = []
    for i in range(pieces):
        at = math.tau * i / pieces
        plan = geometry(0.0, 40 * math.cos(at), 40 * math.sin(at), at + _QUARTER, length, '<arc curvature="0.025"/>')
        before, after = str((i - 1) % pieces), str((i + 1) % pieces)
        links = to_road("predecessor", before, "end") + to_road("successor", after, "start")
        lanes = section(0.0, lane(1, before=1, after=1), lane(-1, before=-1, after=-1))
        roads.append(road(str(i), plan, length, lanes, link=links))
    return roads


def test_a_path_goes_straight_on_at_a_crossing_if_no_route_is_named(tmp_path: Path) -> None:
    (path,) = road_tables(network(tmp_path, *_crossing())).paths
    assert path.length == 120.0
    ahead = place(path, np.array([0.0, 60.0, 120.0]))
    assert ahead.x == pytest.approx([-60, 0, 60])
    assert ahead.y == pytest.approx([0, 0, 0])


def test_a_route_turns_where_it_says_and_lanes_go_on_against_a_roads_stations(tmp_path: Path) -> None:
    route = Route(("1", "11", "3"), name="left")
    (path,) = road_tables(network(tmp_path, *_crossing()), [route]).paths
    assert path.name == "left"
    assert path.length == pytest.approx(100 + 10 * _QUARTER)
    end = place(path, np.array([path.length]), lane_middle(path, np.array([path.length])))
    assert (end.x[0], end.y[0], end.heading[0]) == pytest.approx((1.75, 60.0, _QUARTER))


def test_the_reference_line_may_jump_to_its_side_but_lanes_go_on(tmp_path: Path) -> None:
    two = section(0.0, "", lane(-1) + lane(-2, after=-1))
    one = section(0.0, "", lane(-1, before=-2))
    roads = [
        road("1", geometry(0.0, 0.0, 0.0, 0.0, 50.0), 50.0, two, link=to_road("successor", "2", "start")),
        road("2", geometry(0.0, 50.0, -3.5, 0.0, 50.0), 50.0, one, link=to_road("predecessor", "1", "end")),
    ]
    (path,) = road_tables(network(tmp_path, *roads), [Route(("1", "2"))]).paths
    around = np.array([50.0 - 1e-9, 50.0])
    assert lane_middle(path, around) == pytest.approx([-5.25, -1.75])
    assert place(path, around, lane_middle(path, around)).y == pytest.approx([-5.25, -5.25])
    beside = next(band for band in path.lanes if band.number == 1)
    assert value(beside.left, around) - value(beside.right, around) == pytest.approx([3.5, 0.0])


def test_roads_linked_in_a_circle_are_a_closed_path(tmp_path: Path) -> None:
    (path,) = road_tables(network(tmp_path, *_ring(3))).paths
    assert path.closed
    assert path.length == pytest.approx(80 * math.pi)
    assert place(path, np.array([0.0])).x == pytest.approx(place(path, np.array([path.length])).x, abs=1e-6)


def test_a_road_linked_to_itself_is_a_closed_path(tmp_path: Path) -> None:
    (path,) = road_tables(network(tmp_path, *_ring(1))).paths
    assert path.closed
    (twice,) = road_tables(network(tmp_path, *_ring(1)), [Route(("0", "0"), -1)]).paths
    assert twice.length == pytest.approx(2 * path.length)


def test_the_other_lane_of_a_circle_is_driven_the_other_way(tmp_path: Path) -> None:
    (path,) = road_tables(network(tmp_path, *_ring(2)), [Route(("1", "0"), 1)]).paths
    assert path.closed
    assert place(path, np.array([5.0])).curvature[0] == pytest.approx(-0.025, abs=1e-6)


def test_all_ways_are_listed_the_straightest_first(tmp_path: Path) -> None:
    ways = list_ways(lane_graph(network(tmp_path, *_crossing())))
    assert [(way.roads, way.lane) for way in ways] == [
        (("1", "10", "2"), -1),
        (("1", "11", "3"), -1),
        (("1",), 1),
        (("2",), 1),
        (("3",), -1),
    ]


def test_a_direct_junction_leads_from_road_to_road(tmp_path: Path) -> None:
    main = section(0.0, "", lane(-1) + lane(-2))
    roads = [
        road("1", geometry(0.0, 0.0, 0.0, 0.0, 50.0), 50.0, main, link=to_junction("successor", "9")),
        road(
            "2",
            geometry(0.0, 50.0, 0.0, 0.0, 70.0),
            70.0,
            section(0.0, "", lane(-1)),
            link=to_junction("predecessor", "9"),
        ),
        road(
            "3",
            geometry(0.0, 50.0, -3.5, 0.0, 80.0, '<arc curvature="-0.01"/>'),
            80.0,
            section(0.0, "", lane(-1, type_="exit")),
            link=to_junction("predecessor", "9"),
        ),
    ]
    joints = "".join(
        f'<connection id="{to}" incomingRoad="1" linkedRoad="{to}" contactPoint="start">'
        f'<laneLink from="{lane_}" to="-1"/></connection>'
        for to, lane_ in (("2", -1), ("3", -2))
    )
    read = network(tmp_path, *roads, f'<junction id="9" name="exit" type="direct">{joints}</junction>', minor=8)
    exit_, onward = (road_tables(read, [Route(("1", to))]).paths[0] for to in "32")
    assert (exit_.length, onward.length) == (130.0, 120.0)
    assert place(exit_, np.array([100.0])).curvature[0] == pytest.approx(-0.01, abs=1e-6)


def test_a_connection_without_lane_links_joins_lanes_of_the_same_number(tmp_path: Path) -> None:
    parts = [part.replace('<laneLink from="-1" to="-1"/>', "") for part in _crossing()]
    assert road_tables(network(tmp_path, *parts)).paths[0].length == 120.0


@pytest.mark.parametrize(
    ("route", "message"),
    [
        (Route(("1", "7")), "there is no road '7' in the file"),
        (Route(("1", "3")), "the route cannot go from road '1' to road '3'"),
        (Route(("1", "10"), 1), "the route cannot go from road '1' to road '10'"),
        (Route(("1",), -4), "road '1' does not begin with a lane -4"),
        (Route((), -4), "no road begins with a lane -4 for vehicles"),
    ],
)
def test_a_route_that_cannot_be_driven_is_refused(route: Route, message: str, tmp_path: Path) -> None:
    with pytest.raises(DseError) as refused:
        way_of(lane_graph(network(tmp_path, *_crossing())), route)
    (problem,) = refused.value.problems
    assert message in problem.what
    assert problem.where is not None
    assert problem.hint or not route.roads


def test_a_lane_that_goes_on_elsewhere_is_refused_with_the_line_of_the_road(tmp_path: Path) -> None:
    moved = [part.replace('x="10.0"', 'x="10.4"') for part in _crossing()]
    with pytest.raises(DseError, match=r"road.xodr:\d+:1: the lane of the path continues 0.4 m off in this road"):
        road_tables(network(tmp_path, *moved))


def test_a_sign_limits_who_drives_towards_it_until_the_next_limit(tmp_path: Path) -> None:
    signs = (
        '<type s="0" type="town"><speed max="100" unit="km/h"/></type><type s="40" type="town"><speed max="20"/></type>'
        '<signals><signal id="1" s="10" t="-4" orientation="+" country="DE" type="274" value="30" unit="mph"/>'
        '<signal id="2" s="25" t="-4" dynamic="no" orientation="+" country="OpenDRIVE" type="278"/>'
        '<signal id="3" s="50" t="4" dynamic="no" orientation="-" country="DE" type="274" value="-1" subtype="60"/>'
        '<signal id="4" s="30" t="4" dynamic="no" orientation="+" country="US" type="274" value="5"/>'
        '<signal id="5" s="30" t="4" dynamic="no" orientation="none" country="DE" type="274" value="5">'
        '<validity fromLane="2" toLane="2"/></signal>'
        '<signal id="6" s="60" t="-4" orientation="+" country="DE" type="274" value="5"/></signals>'
    )
    one = road("1", geometry(0.0, 0.0, 0.0, 0.0, 60.0), 60.0, section(0.0, lane(1), lane(-1)), more=signs)
    along, against = (road_tables(network(tmp_path, one), [Route(("1",), id_)]).paths[0] for id_ in (-1, 1))
    written, told = 100 / 3.6, 30 * 0.44704
    stations = np.array([5.0, 15.0, 35.0, 45.0])
    assert value(along.speed_limit, stations) == pytest.approx([written, told, written, 20.0])
    # Against the stations the sign stands 10 m after the start, and what is written changes at 20 m.
    assert value(against.speed_limit, np.array([5.0, 15.0, 25.0])) == pytest.approx([20.0, 60 / 3.6, written])


def test_limits_lights_and_slippery_patches_lie_along_the_path(tmp_path: Path) -> None:
    limits = '<type s="0" type="town"><speed max="50" unit="km/h"/></type><type s="30" type="town"/>'
    own = '<speed sOffset="40" max="20" unit="mph"/><material sOffset="25" friction="0.3"/>'
    lights = (
        '<signals><signal id="5" s="45" t="-4" dynamic="yes" orientation="+" country="OpenDRIVE" type="1000001">'
        '<userData code="dse.phases" value="green 20, yellow 3, red 27"/><userData code="dse.shift" value="10"/>'
        "</signal>"
        '<signal id="6" s="5" t="4" dynamic="yes" orientation="-" country="OpenDRIVE" type="1000001"/>'
        '<signal id="7" s="5" t="4" dynamic="no" orientation="+" country="DE" type="274"/></signals>'
    )
    slick = (
        '<objects><object id="1" type="patch" s="20" t="-2" zOffset="0" hdg="0" length="4" width="1">'
        '<material friction="0.1"/></object><object id="2" type="tree" s="1" t="9"/></objects>'
    )
    lanes = section(0.0, lane(1), lane(-1, more=own))
    one = road("1", geometry(0.0, 0.0, 0.0, 0.0, 60.0), 60.0, lanes, more=limits + lights + slick)
    controlled = (
        '<controller id="1"><control signalId="6"/><userData code="dse.phases" value="red 5, green 5"/></controller>'
    )
    along, against = (road_tables(network(tmp_path, one, controlled), [Route(("1",), id_)]).paths[0] for id_ in (-1, 1))
    stations = np.array([10.0, 35.0, 50.0])
    assert value(along.speed_limit, stations) == pytest.approx([50 / 3.6, 0.0, 20 * 0.44704])
    assert value(against.speed_limit, 60 - stations) == pytest.approx([50 / 3.6, 0.0, 0.0])
    assert value(along.lanes[0].friction, stations) == pytest.approx([1.0, 0.3, 0.3])
    (light,), (other,) = along.lights, against.lights
    assert (light.id, light.station, light.shift) == ("5", 45.0, 10.0)
    assert light.phases == (("green", 20.0), ("yellow", 3.0), ("red", 27.0))
    assert (other.id, other.station, other.phases) == ("6", 55.0, (("red", 5.0), ("green", 5.0)))
    (patch,), (turned,) = along.patches, against.patches
    assert (patch.start, patch.end, patch.right, patch.left, patch.friction) == (18.0, 22.0, -2.5, -1.5, 0.1)
    assert (turned.start, turned.end, turned.right, turned.left) == (38.0, 42.0, 1.5, 2.5)


def test_a_path_ends_where_its_lane_does(tmp_path: Path) -> None:
    left = lane(1, after=1) + lane(2, 3.0, before=0)
    two = section(0.0, left, lane(-1, after=-1) + lane(-2, 3.0))
    one = section(60.0, lane(1, before=1) + lane(2, 3.0), lane(-1, before=-1))
    plan = geometry(0.0, 0.0, 0.0, 0.0, 50.0) + geometry(50.0, 50.0, 0.0, 0.0, 50.0, '<arc curvature="0.01"/>')
    hill = '<elevationProfile><elevation s="0" a="0" b="0.1" c="0" d="0"/></elevationProfile>'
    read = network(tmp_path, road("1", plan, 100.0, two + one, more=hill))
    lengths = {id_: road_tables(read, [Route(("1",), id_)]).paths[0].length for id_ in (-2, -1, 1, 2)}
    assert lengths == {-2: 60.0, -1: 100.0, 1: 100.0, 2: 40.0}
    ended, against = (road_tables(read, [Route(("1",), id_)]).paths[0] for id_ in (-2, 2))
    assert place(ended, np.array([0.0, 60.0])).z == pytest.approx([0.0, 6.0])
    assert place(against, np.array([0.0, 40.0])).z == pytest.approx([10.0, 6.0])
    assert value(against.lanes[0].right, np.array([20.0])) == pytest.approx([-6.5])
    assert road_tables(read).paths[0].length == 100.0
    assert road_tables(read, [Route(("1",))]).paths[0].length == 100.0
