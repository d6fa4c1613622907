"""Benches that somebody can drive: sensible without a driver, and whatever somebody does there."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import dse
from dse.api.drives.live import View
from dse.domain.design import Configuration
from dse.domain.drive import Drive, Pace
from dse.domain.run import Run, RunRequest
from dse.live.recorded_drive import bench_of_drive
from dse.loading.workspace import Workspace
from dse.report import SceneSignals
from dse.space.space import open_space
from dse.testbench.prepare import prepare_bench
from dse.testbench.runner import Runner
from dse.testbench.wired_bench import wire_bench

pytestmark = pytest.mark.usefixtures("kept_cache")
ROOT = Path(__file__).parents[2]
BENCHES = ("drive_following", "drive_motorway", "drive_scenario", "drive_town")
MANUAL, STANDBY, CRUISE, OVERRIDE, EMERGENCY = range(5)
MIDDLE = 2
RED = 2
Columns = dict[str, NDArray[np.float64]]
SEEN = ("chassis.speed", "chassis.acceleration", "road.lane.offset", "road.lane.on_road", "scene.gap")
SEEN = (
    *SEEN,
    "road.light.colour",
    "road.light.distance",
    "scene.collision",
    "controls.mode",
    "controls.steered_by",
    "chassis.motion.lateral_acceleration",
)


@cache
def chosen(chassis: str, aeb: bool = True) -> Configuration:
    """The first pilot with that car, with or without an emergency brake."""
    space = open_space(Workspace(ROOT).bench("drive_following").design)
    return next(c for c in space.configurations() if c.choices["chassis"] == chassis and ("aeb" in c.choices) == aeb)


def driven(
    folder: Path,
    stop: float,
    does: Mapping[str, list[tuple[float, float]]],
    chassis: str = "single_track",
    aeb: bool = True,
    on: str = "drive_following",
) -> tuple[Run, Columns]:
    """A run that somebody drove who *does* that: from each time in s on, each control has a value."""
    bench, car = Workspace(ROOT).bench(on), chosen(chassis, aeb)
    step = bench.simulation.step
    time = np.arange(round(stop / step) + 1) * step
    ports = ("accelerator", "brake", "steering", "hands_on", "cruise", "set_speed", "gap_setting")
    first = {"set_speed": 30.0, "gap_setting": MIDDLE}
    inputs = {name: np.full(len(time), float(first.get(name, 0))) for name in ports}
    for name, said in does.items():
        for (begin, value), (end, _) in pairwise([*said, (np.inf, 0.0)]):
            inputs[name][(time >= begin - 1e-6) & (time < end - 1e-6)] = value
    drive = Drive(bench.name, car.id, "me", step, time, inputs, Pace(len(time) - 1, 0, 0.0, 0.0))
    again = bench_of_drive(drive, bench, car, folder)
    again = replace(again, simulation=replace(again.simulation, record=SEEN))
    with Runner(prepare_bench(again, [car])[car.id]) as runner:
        run = runner.run(RunRequest(0, car.id, {}), keep=True)
    assert run.waveforms is not None, run.problem
    assert all(np.isfinite(values).all() for values in run.waveforms.values.values())
    return run, dict(run.waveforms.values)


def test_a_test_drive_has_the_configurations_of_the_pilot() -> None:
    benches = dse.open(ROOT).benches
    assert benches["drive_following"].design.count() == benches["highway_following"].design.count() == 49_400


@pytest.mark.parametrize("name", BENCHES)
def test_a_bench_that_can_be_driven_is_a_scene(name: str) -> None:
    bench = Workspace(ROOT).bench(name)
    wired = wire_bench(bench, chosen("single_track"))
    settings = {label: setting.value for label, setting in wired.settings.items()}
    told = SceneSignals(wired.signals, settings, bench.figures)
    assert told.is_scene
    assert {"controls.mode", "driver.gap_setting", "chassis.speed", "road.actors[1].x"} <= set(told.wanted)
    assert {"controller.kp_speed", "controller.kd_gap", "controls.overrun"} <= settings.keys()


@pytest.mark.thorough
@pytest.mark.parametrize("name", BENCHES)
def test_with_nobody_at_the_wheel_cruise_control_keeps_all_that_is_asked_for(name: str) -> None:
    found = dse.open(ROOT).benches[name].simulate(chosen("single_track").id)
    assert found.metrics["by_hand"] == 0
    assert found.metrics["emergency"] == 0
    assert found.metrics["driven"] > 1000
    assert set(found.verdicts.values()) <= {"pass", "not exercised"}
    assert found.verdicts["R1"] == "pass"


@pytest.mark.thorough
def test_the_driver_takes_over_and_gives_back(tmp_path: Path) -> None:
    run, seen = driven(
        tmp_path,
        25.0,
        {
            "cruise": [(0, 1), (9, 0), (10, 1)],
            "brake": [(5, 0.3), (6, 0)],
            "accelerator": [(15, 0.9), (17, 0)],
            "hands_on": [(20, 1), (22, 0)],
            "steering": [(20, 0.1), (21, -0.1)],
        },
    )
    mode = {at: seen["controls.mode"][round(at / 0.01)] for at in (4.9, 5.01, 7.0, 9.5, 10.01, 16.0, 18.0)}
    assert list(mode.values()) == [CRUISE, STANDBY, STANDBY, MANUAL, CRUISE, OVERRIDE, CRUISE]
    assert seen["chassis.acceleration"][500:600].min() < -2
    assert seen["chassis.acceleration"][1650] > seen["chassis.acceleration"][1490] + 0.5
    assert set(seen["controls.steered_by"][2002:2200]) == {0}
    assert abs(seen["road.lane.offset"][-1]) < 0.5
    assert run.metrics["take_overs"] == pytest.approx(2.0, abs=0.05)


@pytest.mark.thorough
def test_a_car_stands_still_and_starts_again(tmp_path: Path) -> None:
    _, seen = driven(tmp_path, 20.0, {"brake": [(0, 1), (6, 0)], "accelerator": [(15, 0.5)], "hands_on": [(0, 1)]})
    standing = seen["chassis.speed"][800:1500]
    assert abs(standing).max() < 1e-3
    assert abs(seen["chassis.acceleration"][800:1500]).max() < 0.05
    assert seen["chassis.speed"][-1] > 5


@pytest.mark.thorough
def test_the_emergency_brake_is_above_a_driver_with_the_accelerator_to_the_floor(tmp_path: Path) -> None:
    run, seen = driven(tmp_path, 15.0, {"accelerator": [(0, 1)]})
    assert run.metrics["crashed"] == 0
    is_emergency = seen["controls.mode"] == EMERGENCY
    assert is_emergency.any()
    assert seen["chassis.acceleration"][is_emergency].min() < -6


@pytest.mark.thorough
@pytest.mark.parametrize("chassis", ["single_track", "two_track"])
def test_off_the_road_nothing_breaks(tmp_path: Path, chassis: str) -> None:
    does = {
        "accelerator": [(0, 1), (5, 0), (7, 1), (14, 0.3)],
        "brake": [(5, 1), (7, 0), (12, 1), (14, 0)],
        "hands_on": [(0, 1), (20, 0)],
        "steering": [(at, 0.6 if at // 2 % 2 else -0.6) for at in range(0, 20, 2)],
    }
    run, seen = driven(tmp_path, 60.0, does, chassis)
    assert run.metrics["off_road"] > 5
    assert abs(seen["chassis.motion.lateral_acceleration"]).max() < 10


@pytest.mark.thorough
@pytest.mark.parametrize(("brakes", "crosses"), [([(0, 1), (28, 0)], True), ([(0, 1), (28, 0), (36, 1)], False)])
def test_who_drives_over_the_line_at_red_is_told_to_have(
    tmp_path: Path, brakes: list[tuple[float, float]], crosses: bool
) -> None:
    """The light of the main road is yellow from 30 s and red from 33 s on; of it the car is some 50 m away then."""
    does = {"brake": brakes, "accelerator": [(28, 1), (36, 1 if crosses else 0)]}
    run, seen = driven(tmp_path, 42.0, does, on="drive_town")
    colour, distance = seen["road.light.colour"], seen["road.light.distance"]
    assert set(colour[3310:3600]) == {RED}
    assert (colour[-1] != RED) == crosses  # there is no second light
    assert (run.metrics["red_light"] > 0) == crosses
    if not crosses:
        assert 1 < distance[-1] < 60
        assert seen["chassis.speed"][-1] < 0.1


@pytest.mark.thorough
def test_the_lights_of_a_town_show_their_colours_while_it_is_driven() -> None:
    view = View(wire_bench(Workspace(ROOT).bench("drive_town"), chosen("single_track")), 80.0)
    lights = view.document["lights"]
    assert isinstance(lights, list)
    assert sorted(f"light.{light['told']}" for light in lights) == [c for c in view.columns if c.startswith("light.")]
    place = view.wanted.index("road.light_heads[1].colour")
    shown = [dict(zip(view.columns, view.of(np.eye(len(view.wanted))[place] * k), strict=True)) for k in (RED, 5)]
    assert [each["light.0"] for each in shown] == [RED, 5]


@pytest.mark.thorough
def test_who_runs_into_the_lead_is_told_to_have_crashed(tmp_path: Path) -> None:
    run, seen = driven(tmp_path, 20.0, {"accelerator": [(0, 1)], "hands_on": [(0, 1)]}, aeb=False)
    first = int(np.argmax(seen["scene.collision"] > 0))
    assert first > 0
    assert (seen["scene.collision"][first:] == 1).all()
    assert run.metrics["crashed"] > 1
