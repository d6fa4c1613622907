"""What is seen beside lanes: markings, signs and objects of a road's file, at their places."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from dse.domain.component import Kind, Type
from dse.loading import Workspace
from dse.report import SceneSignals
from dse.report.roadside import kind_of, markings_of, standing_objects, standing_signs
from dse.report.scene.ground import ground_of
from dse.world import Network, open_roads, read_network

ROOT = Path(__file__).parents[2]
ROAD = """<?xml version="1.0"?>
<OpenDRIVE><header revMajor="1" revMinor="7"/>
<road length="200" id="1" junction="-1">{type}
<planView><geometry s="0" x="0" y="0" hdg="0" length="200"><line/></geometry></planView>
<lanes><laneSection s="0"><center><lane id="0" type="none">{middle}</lane></center>
<right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/>{outer}</lane></right>
</laneSection></lanes>
<objects>{objects}</objects><signals>{signals}</signals></road></OpenDRIVE>"""


def read(tmp_path: Path, **parts: str) -> Network:
    file = tmp_path / "road.xodr"
    known = dict.fromkeys(("type", "middle", "outer", "objects", "signals"), "")
    file.write_text(ROAD.format(**(known | parts)), encoding="utf-8")
    return read_network(file, "road.xodr")


def test_markings_lie_on_the_outer_borders_of_their_lanes_from_where_they_begin(tmp_path: Path) -> None:
    outer = '<roadMark sOffset="0" type="solid" width="0.2"/><roadMark sOffset="50" type="broken" color="yellow"/>'
    network = read(tmp_path, middle='<roadMark sOffset="0" type="solid solid" weight="bold"/>', outer=outer)
    middle, solid, broken = markings_of(network)
    assert (middle.kind, middle.width, middle.colour) == ("solid solid", 0.25, "white")
    assert np.all(middle.line[:, 1] == 0.0)
    assert (solid.kind, solid.width) == ("solid", 0.2)
    assert solid.line[[0, -1], :2].tolist() == [[0.0, -3.5], [50.0, -3.5]]
    assert (broken.kind, broken.colour, broken.width) == ("broken", "yellow", 0.12)
    assert broken.line[[0, -1], 0].tolist() == [50.0, 200.0]


def test_signs_have_the_number_in_their_own_unit(tmp_path: Path) -> None:
    place = 's="20" t="-5" dynamic="no"'
    signals = (
        f'<signal {place} id="1" orientation="+" country="US" type="R2-1" value="35" unit="mph"/>'
        f'<signal {place} id="2" orientation="-" country="DE" type="274" subtype="60"/>'
        f'<signal {place} id="3" orientation="+" country="DE" type="206"/>'
        f'<signal {place} id="4" orientation="+" country="DE" type="101"/>'
        f'<signal {place} id="5" orientation="+" country="GB" type="670" value="40"/>'
    )
    signs = standing_signs(read(tmp_path, signals=signals))
    assert [(sign.kind, sign.text) for sign in signs] == [
        ("limit", "35"),
        ("limit", "60"),
        ("206", ""),
        ("limit", "40"),
    ]
    assert [round(np.degrees(sign.heading)) for sign in signs] == [0, 180, 0, 0]
    assert signs[0].place.tolist() == [20.0, -5.0, 0.0]


def test_a_limit_without_signs_gets_one_where_it_changes(tmp_path: Path) -> None:
    kinds = "".join(
        f'<type s="{s}" type="rural"><speed max="{limit}" unit="km/h"/></type>'
        for s, limit in ((0, 70), (60, 70), (90, 50))
    )
    signs = standing_signs(read(tmp_path, type=kinds))
    assert [(sign.text, float(sign.place[0])) for sign in signs] == [("70", 15.0), ("50", 105.0)]
    assert all(sign.place[1] < -3.5 for sign in signs)


def test_repeated_objects_are_as_many_as_they_are_and_odd_numbers_are_not_drawn(tmp_path: Path) -> None:
    objects = (
        '<object id="1" type="tree" s="10" t="6" radius="2" height="8">'
        '<repeat s="10" length="100" distance="25" tStart="6" tEnd="8"/></object>'
        '<object id="2" type="crosswalk" s="150" t="-1.75" hdg="1.5" length="3.5" width="3"/>'
        '<object id="3" type="tree" s="nan" t="1e400" height="x"/>'
    )
    found = standing_objects(read(tmp_path, objects=objects))
    trees = [each for each in found if each.kind == "tree"][:5]
    assert [each.place[0] for each in trees] == [10.0, 35.0, 60.0, 85.0, 110.0]
    assert trees[0].place[1] == 6.0
    assert trees[-1].place[1] == pytest.approx(8.0)
    assert trees[0].size == (4.0, 4.0, 8.0)
    assert [each.size for each in found if each.kind == "crosswalk"] == [(3.5, 3.0, 0.0)]
    assert all(np.isfinite(each.place).all() for each in found)


@pytest.mark.parametrize(("road", "kind"), [("motorway", "motorway"), ("crossroads", "town"), ("country", "rural")])
def test_what_a_road_is_follows_from_its_limits_where_its_file_does_not_say(road: str, kind: str) -> None:
    network = open_roads(road, Workspace(ROOT))
    assert kind_of(network) == kind
    ground = ground_of(network, np.zeros((1, 2)), 300.0)
    assert ground.kind == kind
    assert {mark.kind for mark in ground.markings} == {"solid", "broken"}
    assert all(sign.kind == "limit" for sign in ground.signs)


def test_a_type_in_the_file_goes_before_limits(tmp_path: Path) -> None:
    assert (
        kind_of(read(tmp_path, type='<type s="0" type="motorway"><speed max="50" unit="km/h"/></type>')) == "motorway"
    )


def test_displays_brakes_and_sun_are_taken_from_the_signals_that_there_are() -> None:
    real = Type(Kind.REAL)
    names = ["car.motion.heading", *(f"car.motion.{axis}" for axis in ("x", "y", "speed")), "car.wheel_speed.front"]
    names += ["brake.torque.front", "brake.torque.rear", "weather.visibility.fog_extinction", "weather.sun.elevation"]
    names += ["sense.target.gap", "sense.target.detected"]
    names += [f"road.lane.{port}" for port in ("on_road", "speed_limit", "offset", "width")]
    told = SceneSignals(dict.fromkeys(names, real), {"chassis.wheel_radius": 0.33}, ())
    assert {"brake.torque.rear", "road.lane.speed_limit", "weather.sun.elevation"} <= set(told.wanted)
    columns = {name: np.full(2, float(number)) for number, name in enumerate(told.wanted)}
    host = told.host(columns)
    assert host.wheel == 0.33
    assert host.columns["brake"].tolist() == (columns["brake.torque.front"] + columns["brake.torque.rear"]).tolist()
    assert "drive" not in host.columns
    assert set(told.driver(columns)) == {"limit", "offset", "width", "gap", "detected"}
    weather = told.weather(columns)
    assert weather["elevation"].tolist() == columns["weather.sun.elevation"].tolist()
    assert "water" not in weather
