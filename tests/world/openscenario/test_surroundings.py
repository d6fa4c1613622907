"""What triggers see besides road users: traffic signals, the time of day, the edge of the road; and who triggered."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from opendrive_texts import geometry, lane as lane_of, opendrive, road, section
from scenario_texts import (
    after,
    by_entity,
    by_value,
    car,
    event,
    private,
    scenario,
    speed,
    story,
    teleport,
    trajectory,
    world,
)  # fmt: skip
from scenario_tracks import Track, played_tracks
from workspaces import written

from dse.errors import DseError
from dse.world import read_scenario

ROADS = opendrive(
    road("0", geometry(0.0, 0.0, 0.0, 0.0, 300.0), 300.0, section(0.0, lane_of(1), lane_of(-1) + lane_of(-2)))
)
PHASE = '<Phase name="{}" duration="{}"><TrafficSignalState trafficSignalId="{}" state="{}"/></Phase>'
LIGHTS = "".join((
    '<TrafficSignals><TrafficSignalController name="lights">',
    PHASE.format("stop", 2, "s1", "red") + PHASE.format("go", 3, "s1", "green"),
    '</TrafficSignalController><TrafficSignalController name="next" delay="1" reference="lights">',
    PHASE.format("stop", 2, "s2", "red") + PHASE.format("go", 3, "s2", "green"),
    "</TrafficSignalController></TrafficSignals>",
))  # fmt: skip


def globally(inside: str) -> str:
    return f"<GlobalAction>{inside}</GlobalAction>"


def signals(inside: str) -> str:
    action = f"<TrafficSignalAction>{inside}</TrafficSignalAction>"
    return globally(f"<InfrastructureAction>{action}</InfrastructureAction>")


def shows(signal: str, state: str) -> str:
    return f'<TrafficSignalCondition name="{signal}" state="{state}"/>'


def time_of_day(text: str) -> str:
    return f'<TimeOfDayCondition rule="greaterOrEqual" dateTime="{text}"/>'


def later(time: float, condition: str) -> str:
    """A trigger of two conditions."""
    both = "</ByValueCondition></Condition><Condition name='d' delay='0' conditionEdge='none'><ByValueCondition>"
    return after(time).replace("</ByValueCondition></Condition>", f"{both}{condition}</ByValueCondition></Condition>")


GO = '<TrafficSignalControllerAction trafficSignalControllerRef="lights" phase="go"/>'
GOES = '<TrafficSignalControllerCondition trafficSignalControllerRef="lights" phase="go"/>'
NEW_YEAR = globally(
    '<EnvironmentAction><Environment name="e"><TimeOfDay animation="false" dateTime="2027-01-01T00:00:00Z"/>'
    "</Environment></EnvironmentAction>"
)
AWAY = (
    "<Polyline>" + "".join(f'<Vertex time="{t}">{world(50, y)}</Vertex>' for t, y in ((0, 0), (1, 200))) + "</Polyline>"
)
BESIDE = (
    '<PrivateAction><LateralAction><LateralDistanceAction entityRef="lead" distance="3.5" freespace="false"'
    ' continuous="true"><DynamicConstraints maxAcceleration="2" maxDeceleration="2"/></LateralDistanceAction>'
    "</LateralAction></PrivateAction>"
)
TRAVELLED = by_entity("near", '<TraveledDistanceCondition value="10"/>').replace(
    '<EntityRef entityRef="near"/>', '<EntityRef entityRef="near"/><EntityRef entityRef="far"/>'
)
CHOSEN = story("near", event("chosen", speed(9), TRAVELLED)).replace(
    '<Actors selectTriggeringEntities="false"><EntityRef entityRef="near"/></Actors>',
    '<Actors selectTriggeringEntities="true"/>',
)
NEAR = by_entity(
    "jumps",
    '<RelativeDistanceCondition entityRef="post" relativeDistanceType="euclidianDistance" value="5" freespace="false"'
    ' rule="lessThan"/>',
)
# Who begins to drive at 5 m/s, at which time in s, by what.
BEGINS = {
    "by_light": (2.0, by_value(shows("s1", "green"))),
    "by_delay": (1.0, by_value(shows("s2", "red"))),
    "by_state": (1.5, by_value(shows("s3", "blinks"))),
    "by_phase": (6.0, later(5.5, GOES)),
    "by_return": (9.0, later(7.5, shows("s1", "red"))),
    "by_clock": (4.0, by_value(time_of_day("2026-11-28T00:00:04"))),
    "by_date": (6.0, by_value(time_of_day("2026-12-31T23:59:59+00:00"))),
}
STORIES = (
    story("lead", event("state", signals('<TrafficSignalStateAction name="s3" state="blinks"/>'), after(1.5)))
    + story("lead", event("phase", signals(GO), after(6)))
    + story("lead", event("date", NEW_YEAR, after(6)))
    + "".join(story(name, event(name, speed(5), start)) for name, (_, start) in BEGINS.items())
    + story("leaves", event("off", speed(5), by_entity("leaves", '<OffroadCondition duration="2"/>')))
    + story("aside", event("aside", BESIDE, after(0)))
    + CHOSEN
    + story("post", event("before", speed(0), NEAR))
    + story("jumps", event("jump", teleport(world(2, -400)), after(1)), event("near", speed(9), NEAR))
)  # fmt: skip
INIT = {
    **{name: (teleport(world(0, -100 - 10 * i)), speed(1)) for i, name in enumerate(BEGINS)},
    "leaves": (teleport(world(50, 0)), speed(10), trajectory(AWAY)),
    "near": (teleport(world(0, -50)), speed(5)), "far": (teleport(world(0, -60)), speed(1)),
    "lead": (teleport(world(0, -300)), speed(1)), "aside": (teleport(world(0, -300)), speed(1)),
    "post": (teleport(world(0, -400)), speed(0)), "jumps": (teleport(world(-90, -400)), speed(1)),
}  # fmt: skip


def text_of(stories: str) -> str:
    init = "".join(private(name, *actions) for name, actions in INIT.items())
    text = scenario("".join(map(car, INIT)), init, stories, road="roads.xodr")
    return text.replace("</RoadNetwork>", f"{LIGHTS}</RoadNetwork>")


@pytest.fixture(scope="module")
def tracks(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Track]:
    return played_tracks(tmp_path_factory.mktemp("surroundings"), text_of(STORIES), ROADS)[1]


@pytest.mark.parametrize("name", BEGINS)
def test_signals_and_the_time_of_day_trigger_events(tracks: dict[str, Track], name: str) -> None:
    at = round(10 * BEGINS[name][0])
    v = tracks[name][:, 3]
    assert (v[: at + 1] == 1).all()
    assert (v[at + 1 :] == 5).all()


def test_time_off_the_road_counts_from_its_edge(tracks: dict[str, Track]) -> None:
    # 10 m/s over 3.5 m to the edge of the left lane, then 2 s.
    assert tracks["leaves"][[23, 24], 3].tolist() == [10, 5]


def test_actors_can_be_those_that_triggered(tracks: dict[str, Track]) -> None:
    assert tracks["near"][[20, 21], 3].tolist() == [5, 9]
    assert (tracks["far"][:, 3] == 1).all()


def test_a_lateral_distance_is_reached_within_the_greatest_acceleration(tracks: dict[str, Track]) -> None:
    aside = tracks["aside"][:, 1] - tracks["lead"][:, 1]
    assert aside[-1] == pytest.approx(3.5, abs=0.01)
    assert aside.max() < 3.5 + 0.02
    bends = np.diff(aside, 2) / 0.01
    assert 1.9 < bends.max() <= 2 + 1e-6
    assert bends.min() >= -2 - 1e-6


def test_a_distance_is_measured_again_after_a_jump_within_the_step(tracks: dict[str, Track]) -> None:
    # The jump is at 1 s, after the same distance was measured for "before"; from there on it drives at 9 m/s.
    assert tracks["jumps"][11, 0] == pytest.approx(2 + 9 * 0.1)


@pytest.mark.parametrize(
    ("part", "changed", "what"),
    [
        ('reference="lights"', 'reference="light"', "there is no controller 'light' before this one"),
        ("</TrafficSignals>", "<TrafficSignalController/>" * 99 + "</TrafficSignals>", "101 controllers of traffic"),
        ('name="next"', 'name="lights"', "the controller 'lights' exists already"),
        ('phase="go"/>', 'phase="no"/>', "the controller 'lights' has no phase 'no'"),
        ('trafficSignalControllerRef="lights"', 'trafficSignalControllerRef="x"', "there is no controller 'x'"),
        ("2027-01-01T00:00:00Z", "soon", "<TimeOfDay>: 'dateTime' is 'soon', not a date with a time"),
    ],
)
def test_wrong_signals_and_dates_are_refused(tmp_path: Path, part: str, changed: str, what: str) -> None:
    text = text_of(STORIES)
    assert part in text
    written(tmp_path, {"scenario.xosc": text.replace(part, changed, 1), "roads.xodr": ROADS})
    with pytest.raises(DseError) as error:
        read_scenario(tmp_path / "scenario.xosc")
    assert what in str(error.value)
