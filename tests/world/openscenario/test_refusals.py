"""Scenarios that are wrong, hostile or beyond what is supported: one problem at its line each, never a traceback."""

from __future__ import annotations

from pathlib import Path

import pytest
from opendrive_texts import geometry, opendrive, road
from scenario_texts import (
    HEADER,
    after,
    by_entity,
    car,
    catalog,
    declared,
    event,
    lane,
    lane_change,
    private,
    scenario,
    speed,
    story,
    teleport,
    trajectory,
    world,
)  # fmt: skip
from workspaces import written

from dse.errors import DseError
from dse.world import read_scenario

ROAD = opendrive(road("0", geometry(0.0, 0.0, 0.0, 0.0, 500.0), 500.0))
EGO = car("Ego")
START = private("Ego", teleport(lane(50)), speed(20))
CATALOGS = '<TrajectoryCatalog><Directory path="catalogs"/></TrajectoryCatalog>'
LOOP = catalog(
    "lines",
    '<Trajectory name="loop" closed="false"><Shape><Polyline>'
    + '<Vertex time="0"><Position><TrajectoryPosition s="1"><TrajectoryRef><CatalogReference catalogName="lines"'
    ' entryName="loop"/></TrajectoryRef></TrajectoryPosition></Position></Vertex>'
    * 2
    + "</Polyline></Shape></Trajectory>",
)
REFERENCE = '<CatalogReference catalogName="lines" entryName="loop"/>'
FOLLOW = (
    f"<PrivateAction><RoutingAction><FollowTrajectoryAction><TrajectoryRef>{REFERENCE}</TrajectoryRef>"
    "</FollowTrajectoryAction></RoutingAction></PrivateAction>"
)
DOUBLED = '<ParameterDeclaration name="p0" parameterType="double" value="1"/>\n' + "".join(
    f'<ParameterDeclaration name="p{i}" parameterType="double" value="${{$p{i - 1} + $p{i - 1}}}"/>\n'
    for i in range(1, 60)
)
VERTEX = f'<Vertex time="1">{world(1, 2)}</Vertex>'
CLOTHOID = '<Clothoid curvature="0" curvaturePrime="0.1" length="{}"><Position/></Clothoid>'


def on_road(*actions: str, parameters: str = "", **more: str) -> str:
    return scenario(EGO, private("Ego", *actions), parameters=parameters, road="road.xodr", **more)


def in_story(*events: str, **more: str) -> str:
    return scenario(EGO, START, story("Ego", *events), road="road.xodr", **more)


REFUSED: dict[str, tuple[str, str]] = {
    "no XML": ("<OpenSCENARIO><a></OpenSCENARIO>", "not XML: mismatched tag"),
    "another root": ("<OpenDRIVE/>", "begins with <OpenSCENARIO>, not with <OpenDRIVE>"),
    "another version": (scenario().replace('revMajor="1"', 'revMajor="2"'), "OpenSCENARIO 2 is not supported"),
    "a document type": ("<!DOCTYPE a><OpenSCENARIO/>", "it declares a document type or entities"),
    "entities": ('<!DOCTYPE x [<!ENTITY a "b">]><OpenSCENARIO>&a;</OpenSCENARIO>', "it declares a document type"),
    "nested 10^6 deep": ("<OpenSCENARIO>" + "<a>" * 10**6, "elements are nested more than 100 levels deep"),
    "no storyboard": (f"<OpenSCENARIO>{HEADER}<Entities/></OpenSCENARIO>", "<OpenSCENARIO> has no <Storyboard>"),
    "a catalogue": (catalog("a"), "<OpenSCENARIO> has no <Entities>"),
    "parameters in a circle": (on_road(parameters=declared(a="$b", b="$a")), "there is no parameter 'b'"),
    "a parameter of itself": (on_road(parameters=declared(a="${$a + 1}")), "there is no parameter 'a'"),
    "a parameter without a name": (on_road(parameters="<ParameterDeclaration/>"), "has no 'name'"),
    "a parameter that doubles": (on_road(parameters=DOUBLED), "it has more than 100000 characters with"),
    "a division by zero": (on_road(speed("${1 / 0}")), "the expression '1 / 0': it has no value"),
    "a root of a negative number": (on_road(speed("${sqrt(0 - 1)}")), "it has no value"),
    "a long expression": (on_road(speed("${" + "1+" * 10**5 + "1}")), "an expression has at most 10000 characters"),
    "a deep expression": (on_road(speed("${" + "(" * 3000 + "1" + ")" * 3000 + "}")), "more than 100 levels"),
    "signs without end": (on_road(speed("${" + "-" * 3000 + "1}")), "more than 100 levels"),
    "code": (on_road(speed("${__import__('os')}")), "'__import__' is not known"),
    "a catalogue in a circle": (
        scenario(EGO, START, story("Ego", event("E", FOLLOW)), road="road.xodr", catalogs=CATALOGS),
        "refers to itself",
    ),
    "no catalogue": (on_road(FOLLOW), "no catalogue 'lines' has an entry 'loop'"),
    "no entry": (on_road(FOLLOW.replace("loop", "lop"), catalogs=CATALOGS), "no catalogue 'lines' has an entry 'lop'"),
    "NaN": (on_road(teleport(lane("NaN"))), "<LanePosition>: 's' is 'NaN', not a number"),
    "infinity": (on_road(teleport(lane("INF"))), "<LanePosition>: 's' is infinite"),
    "an infinite place": (on_road(teleport(world("-INF", 0))), "<WorldPosition>: 'x' is infinite"),
    "an infinite curve": (
        in_story(event("E", trajectory(CLOTHOID.format("INF").replace("<Position/>", lane(1))))),
        "<Clothoid>: 'length' is infinite",
    ),
    "an infinite lane": (
        in_story(event("E", lane_change(1).replace('Lane value="1"', 'Lane value="INF"'))),
        "<AbsoluteTargetLane>: 'value' is inf, not a whole number",
    ),
    "no number": (on_road(speed("fast")), "<AbsoluteTargetSpeed>: 'value' is 'fast', not a number"),
    "a number of millions of digits": (on_road(teleport(lane("9" * 10**6))), "<LanePosition>: 's' is infinite"),
    "no road network": (on_road(teleport(lane(1))).replace("road.xodr", "rod.xodr"),
                        "the road network 'rod.xodr' does not exist"),
    "a device": (on_road().replace("road.xodr", "/dev/zero"), "the road network '/dev/zero' does not exist"),
    "a path without end": (on_road().replace("road.xodr", "a" * 10**5), "does not exist"),
    "a scenario as a road": (on_road().replace("road.xodr", "scenario.xosc"), "'scenario.xosc' is not supp"),
    "no road": (on_road(teleport(lane(1, road=7))), "there is no road '7' in the road network"),
    "no lane": (on_road(teleport(lane(1, lane=-7))), "road '0' has no lane -7"),
    "no entity": (scenario(EGO, private("Eggo", speed(1))), "there is no entity 'Eggo'"),
    "two entities": (scenario(EGO + EGO), "there is another entity 'Ego'"),
    "too many entities": (scenario("".join(car(f"c{i}") for i in range(10**4))), "at most 48"),
    "10^5 events": (in_story(*[event("E", speed(1), after(1))] * 10**5), "a storyboard has at most 10000 elements"),
    "10^5 actions at the start": (scenario(EGO, private("Ego", *[speed(1)] * 10**5)), "at most 20000 private actions"),
    "10^5 vertices": (
        in_story(event("E", trajectory(f"<Polyline>{VERTEX * 10**5}</Polyline>"))),
        "a trajectory has at most 10000",
    ),
    "an unknown action": (on_road("<PrivateAction><JumpAction/></PrivateAction>"), "<JumpAction> is not supported"),
    "an unknown condition": (in_story(event("E", speed(1), by_entity("Ego", "<MoodCondition/>"))),
                             "<MoodCondition> is not supported"),
    "an unknown rule": (in_story(event("E", speed(1), after(1).replace("greaterOrEqual", "about"))),
                        "<SimulationTimeCondition>: rule 'about' is not supported"),
    "an empty action": (in_story(event("E", "<PrivateAction/>")), "<PrivateAction> is empty"),
}  # fmt: skip


def _marked(case: str) -> object:
    return pytest.param(case, marks=pytest.mark.thorough) if case == "10^5 vertices" else case


@pytest.mark.sampled(3)
@pytest.mark.parametrize("case", [*map(_marked, REFUSED)])
def test_what_is_wrong_is_one_problem_at_its_line(tmp_path: Path, case: str) -> None:
    text, what = REFUSED[case]
    written(tmp_path, {"scenario.xosc": text, "road.xodr": ROAD, "catalogs/lines.xosc": LOOP})
    with pytest.raises(DseError) as error:
        read_scenario(tmp_path / "scenario.xosc")
    (problem,) = error.value.problems
    assert what in problem.what
    assert problem.where is not None
    assert problem.where.line > 0


def test_files_outside_the_workspace_are_refused(tmp_path: Path) -> None:
    inner = tmp_path / "inner"
    written(tmp_path, {"road.xodr": ROAD, "catalogs/lines.xosc": LOOP})
    for text, what in (
        (on_road().replace("road.xodr", "../road.xodr"), "the road network '../road.xodr' is outside the workspace"),
        (on_road().replace("road.xodr", str(tmp_path / "road.xodr")), "is outside the workspace"),
        (
            on_road(catalogs=CATALOGS.replace("catalogs", "../catalogs")).replace("road.xodr", ""),
            "the folder '../catalogs' is outside the workspace",
        ),
    ):
        written(inner, {"scenario.xosc": text})
        with pytest.raises(DseError) as error:
            read_scenario(inner / "scenario.xosc", inside=inner)
        assert what in error.value.problems[0].what
    (inner / "road.xodr").symlink_to(tmp_path / "road.xodr")
    written(inner, {"scenario.xosc": on_road()})
    with pytest.raises(DseError, match="is outside the workspace"):
        read_scenario(inner / "scenario.xosc", inside=inner)


@pytest.mark.parametrize(
    "name", ["ego-speed", "ego.speed", "2nd", "int", "while", "and", "drives_host", "NAN", "SB_NONE"]
)
def test_parameters_that_c_cannot_name_are_decided_when_the_fmu_is_built(tmp_path: Path, name: str) -> None:
    parameters = declared(v=3).replace('"v"', f'"{name}"') + declared(w=4)
    path = tmp_path / "scenario.xosc"
    path.write_text(scenario(EGO, private("Ego", speed(f"${name}")), parameters=parameters), encoding="utf-8")
    found = read_scenario(path)
    assert [each.name for each in found.parameters] == ["w"]
    assert found.decided == {name: "3"}
    assert read_scenario(path, {name: "5"}).tables.numbers.keys() >= {"5.0"}


def test_a_catalogue_that_is_a_device_is_not_read(tmp_path: Path) -> None:
    devices = '<RouteCatalog><Directory path="/dev/zero"/></RouteCatalog>'
    written(tmp_path, {"scenario.xosc": on_road(catalogs=devices), "road.xodr": ROAD})
    assert read_scenario(tmp_path / "scenario.xosc").entities == ("Ego",)


def test_a_wrong_scenario_reports_all_its_problems(tmp_path: Path) -> None:
    written(tmp_path, {"scenario.xosc": in_story(event("A", speed("x")), event("B", speed("y"))), "road.xodr": ROAD})
    with pytest.raises(DseError) as error:
        read_scenario(tmp_path / "scenario.xosc")
    assert ["'x'" in problem.what or "'y'" in problem.what for problem in error.value.problems] == [True, True]
