"""What road users of a scenario do, against closed forms; all of them are in one FMU, which is compiled once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from components.conftest import WORKSPACE, Shelf
from fusion.conftest import Workshop, assert_same, both_ways, failures, system_of
from numpy.typing import NDArray
from opendrive_texts import geometry, lane as lane_text, opendrive, road, section
from scenario_texts import (
    after,
    by_entity,
    car,
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
from scipy.special import fresnel
from workspaces import written

from dse.domain.component import Causality, Component, CSource, Interface, Kind, Parameter, Port, Type
from dse.world import read_scenario, scenario_files

H, STOP, FIRST = 0.01, 9.0, 1.0
PLAN = geometry(0.0, 0.0, 0.0, 0.0, 2000.0)
ROAD = opendrive(road("0", PLAN, 2000.0, section(0.0, "", lane_text(-1) + lane_text(-2))))
EDGE = (0.0, 2.0, 5.0)
VERTICES = [(0, 100), (30, 100), (30, 160)]
POLYLINE = "".join(f'<Vertex time="{t}">{world(x, y)}</Vertex>' for t, (x, y) in zip(EDGE, VERTICES, strict=True))
POLYLINE = f"<Polyline>{POLYLINE}</Polyline>"
LENGTH, LAST = 60.0, 0.02
CLOTHOID = f'<Clothoid curvature="0" curvaturePrime="{LAST / LENGTH}" length="{LENGTH}">{world(0, 300)}</Clothoid>'
TIMING = '<Timing domainAbsoluteRelative="relative" scale="1" offset="0"/>'
SYNCHRONIZE = (
    '<PrivateAction><SynchronizeAction masterEntityRef="Master">'
    + lane(300).replace("Position>", "TargetPositionMaster>", 1).replace("</Position>", "</TargetPositionMaster>")
    + lane(300, -2).replace("Position>", "TargetPosition>", 1).replace("</Position>", "</TargetPosition>")
    + '<FinalSpeed><AbsoluteSpeed value="$final"/></FinalSpeed></SynchronizeAction></PrivateAction>'
)
RAMPS = {
    "Linear": speed(20, "linear", 4), "Cubic": speed(20, "cubic", 4), "Sinusoidal": speed(20, "sinusoidal", 4),
    "CubicRate": speed(20, "cubic", 5, "rate"), "SinusoidalRate": speed(20, "sinusoidal", 5, "rate"),
    "Distance": speed(20, "linear", 60, "distance"),
}  # fmt: skip
STARTS = {
    **{name: (lane(200 + 20 * i), 10.0) for i, name in enumerate(RAMPS)},
    "Changer": (lane(700), 20.0), "Master": (lane(160), 20.0), "Slave": (lane(240, -2), 5.0),
    "Timed": (world(0, 100), 0.0), "Curved": (world(0, 300), 10.0), "Chaser": (lane(1000), 20.0),
    "Target": (lane("${1000 + $gap + 4}"), 0.0),
}  # fmt: skip
ACTIONS = {
    **RAMPS, "Changer": lane_change(-2), "Slave": SYNCHRONIZE, "Timed": trajectory(POLYLINE, TIMING),
    "Curved": trajectory(CLOTHOID),
}  # fmt: skip
CONTACT = by_entity("Chaser", '<CollisionCondition><EntityRef entityRef="Target"/></CollisionCondition>')
NEVER = by_entity("Master", '<StandStillCondition duration="1"/>')
TEXT = scenario(
    "".join(car(name, centre=0.0) for name in STARTS),
    "".join(private(name, teleport(place), speed(v)) for name, (place, v) in STARTS.items()),
    "".join(story(name, event(f"{name}Event", action, after(FIRST))) for name, action in ACTIONS.items())
    + story("Target", event("Contact", speed("${10 / $divisor}"), CONTACT), event("Never", speed(1), NEVER)),
    parameters=declared(gap=73.3, divisor=1e9, final=15),
    road="road.xodr",
)
START = {"gap": 73.3, "divisor": 1e9, "final": 15.0}
POSE = ("station", "offset", "turn", "speed")


@dataclass(frozen=True)
class Played:
    """Over *time*, n rows: ``poses[NAME]`` (n, 4) of x, y, heading and speed, and ``states[NAME]`` (n,)."""

    time: NDArray[np.float64]
    poses: Mapping[str, NDArray[np.float64]]
    states: Mapping[str, NDArray[np.int64]]

    def speed(self, name: str) -> NDArray[np.float64]:
        return self.poses[name][:, 3]

    def since(self) -> NDArray[np.float64]:
        """Time since the actions begin, in s; 0 before."""
        return np.maximum(self.time - FIRST, 0.0)


@pytest.fixture(scope="session")
def component(tmp_path_factory: pytest.TempPathFactory) -> Component:
    folder = written(tmp_path_factory.mktemp("moving"), {"scenario.xosc": TEXT, "road.xodr": ROAD})
    found = read_scenario(folder / "scenario.xosc")
    assert {each.name for each in found.parameters} == START.keys()
    written(folder, scenario_files(found))
    units = tuple(sorted(folder.glob("*.c")))
    source = CSource(units, folder / "scenario.h", "scenario", "scenario_init", "scenario_step", None)
    numbers = (Parameter(name, Type(Kind.REAL), value, tunable=False) for name, value in START.items())
    own = (
        Parameter("drives_host", Type(Kind.BOOLEAN), True, tunable=False),
        Parameter("host_front", Type(Kind.REAL), 2.0),
    )
    return Component("moving", WORKSPACE.interfaces["scenario"], source=source, parameters=(*own, *numbers))


@pytest.fixture(scope="session")
def play(component: Component, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Played]:
    shelf = Shelf(tmp_path_factory.mktemp("shelf"), WORKSPACE, warnings=())
    folder = component.source.header.parent  # type: ignore[union-attr]
    elements = [each.name.rpartition("/")[2] for each in read_scenario(folder / "scenario.xosc").elements]

    def run(stop: float = STOP, **parameters: float) -> Played:
        part = shelf.instance(component, **parameters)
        part.init()
        rows, states = [], []
        for number in range(round(stop / H) + 1):
            if number:
                part.step(H)
            rows.append([[part[f"everyone[{i + 1}].{port}"] for port in POSE] for i in range(len(STARTS))])
            states.append([part[f"states[{i + 1}]"] for i in range(len(elements))])
        poses = np.array(rows)
        time = np.arange(len(rows)) * H
        return Played(
            time,
            {name: poses[:, i] for i, name in enumerate(STARTS)},
            {name: np.array(states)[:, i] for i, name in enumerate(elements)},
        )

    return run


@pytest.fixture(scope="session")
def played(play: Callable[..., Played]) -> Played:
    return play()


# Speeds are those of the end of each step and exact, but for rounding and the 1e-9 s by which the core ends early.
@pytest.mark.parametrize(
    ("name", "duration", "shape"),
    [
        ("Linear", 4.0, lambda p: p),
        ("Cubic", 4.0, lambda p: p * p * (3 - 2 * p)),
        ("Sinusoidal", 4.0, lambda p: 0.5 * (1 - np.cos(np.pi * p))),
        ("CubicRate", 1.5 * 10 / 5, lambda p: p * p * (3 - 2 * p)),
        ("SinusoidalRate", 0.5 * np.pi * 10 / 5, lambda p: 0.5 * (1 - np.cos(np.pi * p))),
        ("Distance", 2 * 60 / (10 + 20), lambda p: p),
    ],
)
@pytest.mark.thorough
def test_speeds_change_in_their_shape(
    played: Played, name: str, duration: float, shape: Callable[[NDArray[np.float64]], NDArray[np.float64]]
) -> None:
    expected = 10 + 10 * shape(np.minimum(played.since() / duration, 1.0))
    np.testing.assert_allclose(played.speed(name), expected, atol=1e-7)


def test_a_change_over_a_distance_takes_that_distance(played: Played) -> None:
    x = played.poses["Distance"][:, 0]
    begin, end = np.flatnonzero(played.time >= FIRST - 1e-9)[0], np.flatnonzero(played.speed("Distance") > 20 - 1e-6)[0]
    # Half a step at the difference of both speeds, as positions advance at the speed of the end of each step.
    assert x[end] - x[begin] == pytest.approx(60.0, abs=0.5 * H * 10 + 1e-6)


def test_a_lane_change_ends_in_the_middle_of_the_lane_after_its_duration(played: Played) -> None:
    y = played.poses["Changer"][:, 1]
    part = np.minimum(played.since() / 4.0, 1.0)
    np.testing.assert_allclose(y, -1.75 - 3.5 * 0.5 * (1 - np.cos(np.pi * part)), atol=1e-6)
    assert y[-1] == pytest.approx(-5.25, abs=1e-9)
    state = played.states["ChangerEvent"]
    assert played.time[np.flatnonzero(state == 2)[0]] == pytest.approx(FIRST + 4.0, abs=H + 1e-9)


def test_synchronized_road_users_arrive_at_the_same_time_with_the_final_speed(played: Played) -> None:
    arrivals = [np.interp(300.0, played.poses[name][:, 0], played.time) for name in ("Master", "Slave")]
    assert arrivals[0] == pytest.approx((300 - 160) / 20, abs=1e-9)
    assert arrivals[1] == pytest.approx(arrivals[0], abs=H)
    at = np.searchsorted(played.time, arrivals[1])
    assert played.speed("Slave")[at] == pytest.approx(15.0, abs=0.1)


def test_a_polyline_with_times_is_at_its_vertices_when_they_say(played: Played) -> None:
    x, y = played.poses["Timed"][:, 0], played.poses["Timed"][:, 1]
    inside = (played.time > FIRST) & (played.time < FIRST + EDGE[-1] - H)
    time = played.since()[inside]
    np.testing.assert_allclose(x[inside], np.interp(time, EDGE, [0, 30, 30]), atol=1e-6)
    np.testing.assert_allclose(y[inside], np.interp(time, EDGE, [100, 100, 160]), atol=1e-6)


def test_a_clothoid_is_its_fresnel_integral(played: Played) -> None:
    travelled = 10 * played.since()
    on_it = (travelled > 0) & (travelled < LENGTH)
    s, rate = travelled[on_it], LAST / LENGTH
    scale = np.sqrt(np.pi / rate)
    sine, cosine = fresnel(s / scale)
    # Chords of a 64th of the length are at most curvature x chord^2 / 8 off, 2.2 mm, and shorter by a 24th of
    # (curvature x chord)^2, 0.4 mm in all.
    np.testing.assert_allclose(played.poses["Curved"][on_it, 0], scale * cosine, atol=3e-3)
    np.testing.assert_allclose(played.poses["Curved"][on_it, 1], 300 + scale * sine, atol=3e-3)
    np.testing.assert_allclose(played.poses["Curved"][on_it, 2], 0.5 * rate * s * s, atol=3e-4)


@pytest.mark.parametrize("gap", [73.3, 40.0, 101.05])
def test_contact_without_braking_is_at_the_time_of_the_closed_form(play: Callable[..., Played], gap: float) -> None:
    played = play(gap / 20 + 0.1, gap=gap)
    clear = played.poses["Target"][:, 0] - played.poses["Chaser"][:, 0] - 4.0
    touches, seen = np.flatnonzero(clear <= 1e-9)[0], np.flatnonzero(played.states["Contact"] > 0)[0]
    assert gap / 20 - 1e-9 <= played.time[touches] <= gap / 20 + H
    assert seen == touches + 1  # triggers see what the last step left


def test_states_of_events_show_what_occurred(played: Played) -> None:
    assert played.states["Never"].max() == 0
    assert played.states["TargetS"].min() == 1
    begun = played.time[np.flatnonzero(played.states["LinearEvent"] == 1)[0]]
    assert begun == pytest.approx(FIRST + H, abs=1e-9)
    assert set(played.states["LinearEvent"]) == {0, 1, 2}
    assert set(played.states["Contact"]) == {0, 2}  # a step of speed is over at once


@pytest.mark.thorough
def test_a_scenario_is_the_same_bits_fused_or_not_in_fmi_2_and_3(component: Component, tmp_path: Path) -> None:
    record = [f"traffic.everyone[{i + 1}].{port}" for i in range(len(STARTS)) for port in POSE]
    found = []
    for version in (2, 3):
        workshop = Workshop(tmp_path, tmp_path / "cache", version)
        system = system_of({"traffic": workshop.built(component)}, [], record)
        starts = [{}, {"traffic.final": 12.0}, {}]
        first, other, again = both_ways(workshop, system, record, starts, stop=STOP, step=H)
        assert first.tobytes() == again.tobytes()
        assert first.tobytes() != other.tobytes()
        found.append(first)
    assert found[0].tobytes() == found[1].tobytes()
    assert np.isfinite(found[0]).all()


@pytest.mark.thorough
def test_a_division_by_zero_ends_the_run_by_name(component: Component, tmp_path: Path) -> None:
    workshop = Workshop(tmp_path, tmp_path / "cache")
    ports = Port("u", Causality.INPUT, Type(Kind.REAL)), Port("y", Causality.OUTPUT, Type(Kind.REAL))
    code = "void seen_init(seen *c) { c->out.y = c->in.u; }\n"
    code += "void seen_step(seen *c, double h) { c->out.y = c->in.u + 0 * h; }"
    members = "struct { double u; } in; struct { double y; } out;"
    seen = workshop.c("seen", members, code, Interface("seen", ports))
    parts = {"traffic": workshop.built(component), "seen": seen}
    system = system_of(parts, ["traffic.movers[1].station -> seen.u"], ["seen.y"])
    failed = assert_same(failures(workshop, system, ["seen.y"], {"traffic.divisor": 0.0}, stop=STOP, step=H))
    assert "traffic.movers[1].station" in str(failed)
