"""Files that are wrong, hostile or beyond what is supported: one problem with its line each, never a traceback."""

from __future__ import annotations

from pathlib import Path

import pytest
from opendrive_texts import connection, factors, geometry, lane, opendrive, road, section, to_junction, to_road

from dse.errors import DseError
from dse.world import read_network, read_road_tables

LINE = geometry(0.0, 0.0, 0.0, 0.0, 100.0)
ONE = road("1", LINE, 100.0)


def _plan(shape: str, length: float = 100.0) -> str:
    return opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, length, shape), length))


def _with(lanes: str) -> str:
    return opendrive(road("1", LINE, 100.0, lanes))


def _extra(more: str) -> str:
    return opendrive(road("1", LINE, 100.0, more=more))


REFUSED = {
    "no XML": ("<OpenDRIVE><road></OpenDRIVE>", "not XML: mismatched tag"),
    "another root": ("<OpenSCENARIO/>", "an OpenDRIVE file begins with <OpenDRIVE>, not with <OpenSCENARIO>"),
    "no header": ("<OpenDRIVE/>", "<OpenDRIVE> has no <header>"),
    "another version": (opendrive(ONE, minor=9), "OpenDRIVE 1.9 is not supported"),
    "no road": (opendrive(), "there is no <road>"),
    "a document type": ("<!DOCTYPE OpenDRIVE><OpenDRIVE/>", "it declares a document type or entities"),
    "entities": ('<!DOCTYPE x [<!ENTITY a "b">]><OpenDRIVE>&a;</OpenDRIVE>', "it declares a document type"),
    "nested 10^6 deep": ("<OpenDRIVE>" + "<a>" * 10**6, "elements are nested more than 100 levels deep"),
    "two roads of one id": (opendrive(ONE, ONE), "there is another road '1'"),
    "two junctions of one id": (opendrive(ONE, *['<junction id="5"/>'] * 2), "there is another junction '5'"),
    "an unknown shape": (_plan("<bezier/>"), "<bezier> is not a known shape of a road"),
    "two shapes": (_plan("<line/><line/>"), "<geometry> has 2 shapes, not one"),
    "no curvature": (_plan("<arc/>"), "<arc> has no 'curvature'"),
    "NaN": (_plan('<arc curvature="nan"/>'), "<arc>: 'curvature' is nan, not between"),
    "infinity": (_plan('<spiral curvStart="0" curvEnd="INF"/>'), "<spiral>: 'curvEnd' is INF, not between"),
    "no number": (_plan('<arc curvature="1,0"/>'), "<arc>: 'curvature' is '1,0', not a number"),
    "a million turns": (_plan('<arc curvature="1e5"/>'), "<arc> turns 1.59e+06 times"),
    "a range that is none": (
        _plan('<paramPoly3 pRange="all" aU="0" bU="1" cU="0" dU="0" aV="0" bV="0" cV="0" dV="0"/>'),
        "<paramPoly3>: 'pRange' cannot be 'all'",
    ),
    "a curve that stands still": (
        _plan('<paramPoly3 pRange="normalized" aU="0" bU="0" cU="100" dU="0" aV="0" bV="0" cV="0" dV="0"/>'),
        "the curve has no direction",
    ),
    "a huge number": (
        opendrive(road("1", geometry(0.0, 1e9, 0.0, 0.0, 100.0), 100.0)),
        "<geometry>: 'x' is 1000000000.0, not between",
    ),
    "no length": (opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 0.0), 0.0)), "<road> has no length"),
    "pieces without length": (
        opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 0.0), 10.0)),
        "<planView> has no <geometry> with a length",
    ),
    "a negative length": (
        opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, -5.0), 10.0)),
        "<geometry>: 'length' is -5.0, not at least 0",
    ),
    "a piece that ends early": (
        opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 40.0), 50.0)),
        "the <geometry> from 0 m on is 40 m long, but the road ends at 50 m",
    ),
    "a gap": (
        opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 50.0) + geometry(50.0, 50.0, 0.5, 0.0, 50.0), 100.0)),
        "this <geometry> begins 0.5 m off the end of the one before",
    ),
    "a kink": (
        opendrive(road("1", geometry(0.0, 0.0, 0.0, 0.0, 50.0) + geometry(50.0, 50.0, 0.0, 0.2, 50.0), 100.0)),
        "this <geometry> begins with a kink of -0.2 rad",
    ),
    "pieces out of order": (
        opendrive(road("1", geometry(50.0, 50.0, 0.0, 0.0, 50.0) + geometry(0.0, 0.0, 0.0, 0.0, 50.0), 100.0)),
        "the <geometry> at 0 m comes after that at 50 m",
    ),
    "a curve of another length": (
        _plan('<paramPoly3 pRange="normalized" aU="0" bU="90" cU="0" dU="0" aV="0" bV="0" cV="0" dV="0"/>'),
        "the curve is 90 m long, its <geometry> gives 100 m",
    ),
    "no sections": (_with("<b/>"), "<lanes> has no <laneSection>"),
    "sections that begin late": (_with(section(5.0, "", lane(-1))), "the first <laneSection> begins at 5 m, not at 0"),
    "a section behind the end": (
        _with(section(0.0, "", lane(-1)) + section(100.0, "", lane(-1))),
        "the <laneSection> at 100 m is beyond the end of its road, 100 m",
    ),
    "two lanes of one id": (_with(section(0.0, "", lane(-1) * 2)), "there is another lane -1 in this section"),
    "a lane on the wrong side": (_with(section(0.0, lane(-1))), "lane -1 is in <left>"),
    "a lane without width": (_with(section(0.0, "", lane(-1, "<a/>"))), "lane -1 has neither <width> nor <border>"),
    "a width that begins late": (
        _with(section(0.0, "", lane(-1, f'<width sOffset="3"{factors(3.5)}/>'))),
        "the width of lane -1 begins 3 m behind its section",
    ),
    "a negative width": (_with(section(0.0, "", lane(-1, -2.0))), "the road has in lane -1 a width of -2 m"),
    "a width that explodes": (
        _with(section(0.0, "", lane(-1, f'<width sOffset="0"{factors(3.0, 0.0, 0.0, 1e20)}/>'))),
        "the road has in lane -1 a width of 1e+26 m",
    ),
    "a border inside another": (
        _with(
            section(
                0.0,
                "",
                lane(-1, f'<border sOffset="0"{factors(-3.5)}/>') + lane(-2, f'<border sOffset="0"{factors(-3.0)}/>'),
            )
        ),
        "lane -2 is up to 0.5 m inside the lanes beside it",
    ),
    "a lane linked to none": (
        _with(section(0.0, "", lane(-1, after=-3)) + section(50.0, "", lane(-1, before=-1))),
        "lane -1 is linked to lane -3, which the next section does not have",
    ),
    "a speed in knots": (_extra('<type s="0" type="town"><speed max="9" unit="kn"/></type>'), "'kn' is not a unit"),
    "a missing road": (
        opendrive(road("1", LINE, 100.0, link=to_road("successor", "2", "start"))),
        "there is no road '2' for road '1' to meet at its end",
    ),
    "a missing junction": (
        opendrive(road("1", LINE, 100.0, link=to_junction("successor", "8"))),
        "there is no junction '8' for road '1' to meet at its end",
    ),
    "a junction with a missing road": (
        opendrive(ONE, f'<junction id="5">{connection("1", "7", "start", [])}</junction>'),
        "there is no road '7'",
    ),
    "a junction with a missing lane": (
        opendrive(
            road("1", LINE, 100.0, link=to_junction("successor", "5")),
            road("2", LINE, 100.0, junction="5"),
            f'<junction id="5">{connection("1", "2", "start", [(-1, -2)])}</junction>',
        ),
        "lane -1 of road '1' is linked to lane -2, which is not there",
    ),
    "a lateral shape": (
        _extra(f'<lateralProfile><shape s="0" t="0"{factors(0.1)}/></lateralProfile>'),
        "a road with a lateral <shape> is not supported on a path",
    ),
    "a road surface": (_extra('<surface><CRG file="a.crg"/></surface>'), "a road with an OpenCRG <surface>"),
    "a bank beyond all": (
        _extra(f'<lateralProfile><superelevation s="0"{factors(2.0)}/></lateralProfile>'),
        "the road has a superelevation of 2 rad",
    ),
    "a lane of its own height": (
        _with(section(0.0, "", lane(-1, more='<height sOffset="0" inner="0.1" outer="0.1"/>'))),
        "a lane with a <height> of its own is not supported on a path",
    ),
    "a level lane beside a banked road": (
        opendrive(
            road(
                "1",
                LINE,
                100.0,
                section(0.0, "", lane(-1) + lane(-2, attributes=' level="true"')),
                more=f'<lateralProfile><superelevation s="0"{factors(0.1)}/></lateralProfile>',
            )
        ),
        "a lane for vehicles that is level beside a banked road is not supported",
    ),
    "a virtual junction": (
        opendrive(road("1", LINE, 100.0, junction="5"), '<junction id="5" type="virtual"/>'),
        "a road in a virtual junction is not supported on a path",
    ),
    "phases in no words": (
        _extra(
            '<signals><signal id="1" s="5" t="0" dynamic="yes" type="1000001">'
            '<userData code="dse.phases" value="blue 3"/></signal></signals>'
        ),
        "'blue 3' is not a phase of a traffic light",
    ),
    "a slippery disc": (
        _extra('<objects><object id="1" s="5" t="0" radius="3"><material friction="0.1"/></object></objects>'),
        "an <object> with friction must be a rectangle along the road",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_followed_is_refused_where_it_stands(name: str, tmp_path: Path) -> None:
    text, message = REFUSED[name]
    file = tmp_path / "road.xodr"
    file.write_text(text, "utf-8")
    with pytest.raises(DseError) as refused:
        read_road_tables(file, "road.xodr")
    (problem,) = refused.value.problems
    assert message in problem.what
    assert problem.where is not None
    assert problem.where.file == "road.xodr"
    assert problem.where.line > 0


def test_all_that_is_wrong_is_told_at_once(tmp_path: Path) -> None:
    bad = road("2", geometry(0.0, 0.0, 0.0, 0.0, 9.0, "<curl/>"), 9.0)
    (tmp_path / "road.xodr").write_text(opendrive(bad, bad.replace("curl", "twist"), ONE), "utf-8")
    with pytest.raises(DseError) as refused:
        read_network(tmp_path / "road.xodr", "road.xodr")
    assert [problem.what.split()[0] for problem in refused.value.problems] == ["<curl>", "<twist>"]


def test_what_no_path_uses_does_not_stop_a_file(tmp_path: Path) -> None:
    odd = (
        '<surface><CRG file="a.crg"/></surface><objects><object id="1" s="5" t="0"/><bridge/></objects>'
        '<signals><signal id="9" s="nowhere"/></signals><railroad/>'
    )
    one = road("1", LINE, 100.0)
    other = road("2", geometry(0.0, 0.0, 9.0, 0.0, 60.0, '<line/><userData code="a"/>'), 60.0, more=odd)
    (tmp_path / "road.xodr").write_text(opendrive(one, other, "<userData/><station/>", minor=4), "utf-8")
    assert read_road_tables(tmp_path / "road.xodr", "road.xodr").paths[0].length == 100.0


def test_pieces_without_length_between_others_change_nothing(tmp_path: Path) -> None:
    plan = (
        geometry(0.0, 0.0, 0.0, 0.0, 50.0) + geometry(50.0, 50.0, 0.0, 1.0, 0.0) + geometry(50.0, 50.0, 0.0, 0.0, 50.0)
    )
    (tmp_path / "road.xodr").write_text(opendrive(road("1", plan, 100.0)), "utf-8")
    assert len(read_road_tables(tmp_path / "road.xodr", "road.xodr").paths[0].x.starts) == 2


@pytest.mark.thorough
def test_ten_megabytes_of_roads_are_read(tmp_path: Path) -> None:
    pieces = "".join(geometry(float(s), float(s), 0.0, 0.0, 1.0) for s in range(100))
    file = tmp_path / "road.xodr"
    file.write_text(opendrive(*(road(str(number), pieces, 100.0) for number in range(1000))), "utf-8")
    assert file.stat().st_size > 8e6
    assert read_road_tables(file, "road.xodr").paths[0].length == 100.0
