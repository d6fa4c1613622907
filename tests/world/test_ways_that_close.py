"""Ways close although a lane splits or joins inside a road; where they end in the network is told."""

from __future__ import annotations

import math
from pathlib import Path

import pytest
from opendrive_texts import connection, geometry, lane, network, road, section, to_junction, to_road

from dse.world import LaneGraph, LanePlace, Route, Way, lane_graph, list_ways, way_end, way_of

LINE = geometry(0.0, 0.0, 0.0, 0.0, 50.0)


def ring(first: str, second: str) -> str:
    """A circle, road 0, with these lanes in its first half and its second."""
    length = math.tau * 40.0
    plan = geometry(0.0, 40.0, 0.0, math.pi / 2, length, '<arc curvature="0.025"/>')
    links = to_road("predecessor", "0", "end") + to_road("successor", "0", "start")
    return road("0", plan, length, section(0.0, "", first) + section(length / 2, "", second), link=links)


# Two lanes become one; only the inner one is come back to.
JOINS = ring(lane(-1, before=-1, after=-1) + lane(-2, after=-1), lane(-1, before=-1, after=-1))
# One lane becomes two; the outer one, which is tried first, ends.
SPLITS = ring(lane(-1, before=-1, after=-2), lane(-1, before=-1) + lane(-2, before=-1, after=-1))
LEFT = ring(lane(-1, before=-1, after=-1), lane(-1, before=-1, after=-1) + lane(-2, before=-1))


@pytest.mark.parametrize("text", [JOINS, SPLITS, LEFT], ids=["joins", "splits", "splits, and one ends"])
def test_a_way_closes_although_lanes_split_or_join_inside_its_road(text: str, tmp_path: Path) -> None:
    graph = lane_graph(network(tmp_path, text))
    assert any(way.closed for way in list_ways(graph))
    assert way_of(graph, Route(("0",))).closed
    assert way_of(graph, Route()).closed


def test_a_way_from_a_lane_that_is_not_come_back_to_stays_open(tmp_path: Path) -> None:
    graph = lane_graph(network(tmp_path, JOINS))
    assert not way_of(graph, Route(("0",), -2)).closed
    assert [(way.lane, way.closed) for way in list_ways(graph)] == [(-2, False), (-1, True)]


def test_ways_are_for_cars_and_end_where_a_lane_becomes_a_hard_shoulder(tmp_path: Path) -> None:
    lanes = (
        section(0.0, "", lane(-1, after=-1) + lane(-2, after=-2)),
        section(25.0, "", lane(-1) + lane(-2, type_="stop")),
    )
    graph = lane_graph(network(tmp_path, road("1", LINE, 50.0, "".join(lanes))))
    assert [[len(passage) for passage in way.passages] for way in list_ways(graph)] == [[1], [2]]


@pytest.mark.parametrize("type_", ["stop", "bus", "parking", "biking"])
def test_the_outermost_lane_for_cars_is_driven_unless_another_one_is_named(type_: str, tmp_path: Path) -> None:
    graph = lane_graph(network(tmp_path, road("1", LINE, 50.0, section(0.0, "", lane(-1) + lane(-2, 2.5, type_)))))
    assert way_of(graph, Route()).lane == way_of(graph, Route(("1",))).lane == -1
    assert way_of(graph, Route(("1",), -2)).lane == -2
    assert [way.lane for way in list_ways(graph)] == [-1]


def junction_roads(*, linked: bool, leads: bool = True) -> tuple[str, ...]:
    """Road 1 leads through road 3, in a junction, to road 2; *linked*: lanes of road 3 say so."""
    inner = lane(-1, before=-1, after=-1) if linked else lane(-1)
    joined = connection("1", "3", "start", [(-1, -1)]) if leads else ""
    one = section(0.0, "", lane(-1))
    return (
        road("1", LINE, 50.0, one, link=to_junction("successor", "100")),
        road("3", geometry(0.0, 50.0, 0.0, 0.0, 20.0), 20.0, section(0.0, "", inner), junction="100",
             link=to_road("predecessor", "1", "end") + to_road("successor", "2", "start")),
        road("2", geometry(0.0, 70.0, 0.0, 0.0, 50.0), 50.0, one, link=to_junction("predecessor", "100")),
        f'<junction id="100" name="">{joined}</junction>',
    )  # fmt: skip


def end_of(folder: Path, *parts: str, route: Route = Route()) -> str:  # noqa: B008  # frozen
    graph = lane_graph(network(folder, *parts))
    problem = way_end(graph, way_of(graph, route))
    return "" if problem is None else f"{problem.where.line}: {problem.what}"


def test_a_way_that_ends_in_a_junction_says_where_and_why(tmp_path: Path) -> None:
    assert end_of(tmp_path, *junction_roads(linked=True)) == ""
    told = "the way ends in junction '100': lane -1 of road '3' names no <successor> in road '2'"
    assert end_of(tmp_path, *junction_roads(linked=False), route=Route(("1", "3"))) == f"19: {told}"
    told = "the way ends at junction '100': no connection leads on from lane -1 of road '1'"
    assert end_of(tmp_path, *junction_roads(linked=True, leads=False), route=Route(("1",))) == f"5: {told}"


def test_a_way_that_its_user_ends_or_that_leaves_the_network_is_no_fault(tmp_path: Path) -> None:
    assert end_of(tmp_path, *junction_roads(linked=True), route=Route(("1", "3"))) == ""
    assert end_of(tmp_path, *junction_roads(linked=True), route=Route(("2",))) == ""
    assert end_of(tmp_path, ring(lane(-1, before=-1, after=-1), lane(-1, before=-1, after=-1))) == ""


def test_a_lane_that_ends_inside_a_road_is_told(tmp_path: Path) -> None:
    lanes = section(0.0, "", lane(-1, after=-1) + lane(-2)), section(25.0, "", lane(-1, before=-1))
    graph: LaneGraph = lane_graph(network(tmp_path, road("1", LINE, 50.0, "".join(lanes))))
    problem = way_end(graph, Way(((LanePlace("1", 0, -2),),), closed=False))
    assert problem is not None
    assert problem.what == "the way ends inside road '1': its lane -2 ends there"
