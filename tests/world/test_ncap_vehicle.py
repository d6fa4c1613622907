"""The car for Euro NCAP's tests: its design space, and what must be monotone in the impact speeds."""

from __future__ import annotations

import math
import shutil
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

import dse
from dse.expression import parse_expression
from dse.loading import Workspace
from dse.rating import verify
from dse.space import open_space

pytestmark = pytest.mark.usefixtures("kept_cache")
ROOT = Path(__file__).parents[2]
KMH = 1 / 3.6
CAR = (
    "lane_sensor is lane_camera and lane_support is absent and slip is absent and controller is pd_acc"
    " and powertrain is combustion_ideal and chassis is longitudinal and computer is computer_large"
    " and tracker is kalman_tracker and manoeuvre is absent and door is no_door_retention"
)
MIDDLE = CAR + " and sensor is object_radar_mid and second_sensor is object_camera and aeb is crossing_aeb"
PERFECT = CAR + " and sensor is object_perfect and second_sensor is absent and aeb is crossing_aeb"
SENSORS = "sensor: {alternatives: [object_radar_long"
PEDESTRIAN = """
  traffic.kind: {values: [adult]}
  traffic.approach: {values: [nearside]}
  traffic.speed: {values: [5 km/h]}
  traffic.acceleration_distance: {values: [1 m]}
  traffic.steady_distance: {values: [3 m]}
  traffic.impact_location: {values: [25 %, 75 %]}
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the workspace, in which a sensor without faults can be chosen as well."""
    place = tmp_path_factory.mktemp("rated")
    for name in ("components", "designs", "roads", "testbenches"):
        shutil.copytree(ROOT / name, place / name)
    design = place / "designs" / "ncap_vehicle.yaml"
    text = design.read_text("utf-8")
    assert text.count(SENSORS) == 1
    design.write_text(text.replace(SENSORS, SENSORS.replace("[", "[object_perfect, ")), encoding="utf-8")
    return place


def explored(folder: Path, name: str, where: str, bench: str, speeds: str, more: str) -> Any:
    """The runs of *bench* at the host's *speeds* (km/h) if it drives, further *more* conditions, by both."""
    text = f"""
study: {name}
testbench: {bench}
configurations: {{where: "{where}"}}
"""
    if speeds:
        text += "design_variables:\n  controller.set_speed: {derived: chassis.initial_speed}\n"
        hosts = ", ".join(f"{speed} km/h" for speed in speeds.split())
        more = f"  chassis.initial_speed: {{values: [{hosts}]}}\n" + more
    text += f"conditions:\n{more}\nkeep_waveforms: none\n"
    (folder / "testbenches" / f"{name}.pet.yaml").write_text(text, encoding="utf-8")
    return dse.open(folder).studies[name].explore(folder / "out" / name, fresh=True).to_pandas("si")


def test_the_design_space_has_more_than_a_million_raw_configurations() -> None:
    design = dse.open(ROOT).designs["ncap_vehicle"]
    assert design.total == 5 * (7 + 1) * 2 * 6 * (1 + 1) * 2 * 3 * 4 * 3 * (3 + 1) * 5 * 5 * 2 * (1 + 1)
    assert 100_000 < design.count() < design.total
    assert design.count(where=MIDDLE + " and brake is hydraulic_booster") == 1


STANDING = """
  traffic.speed: {values: [0 km/h]}
  traffic.impact_location: {values: [0 %, 50 %, 125 %]}
"""
CELL = ["chassis.initial_speed", "traffic.impact_location"]


@pytest.mark.thorough
@pytest.mark.parametrize(("bench", "more"), [("ncap_rear", STANDING), ("ncap_crossing", PEDESTRIAN)])
def test_a_better_brake_never_costs_impact_speed(folder: Path, bench: str, more: str) -> None:
    late = PERFECT.replace("crossing_aeb", "aeb_late")
    rows = explored(folder, f"{bench}_brakes", late, bench, "20 30 40 50 60 70 80", more)
    impacts = rows.pivot_table(index=CELL, columns="brake", values="impact_speed")
    assert len(impacts) >= 14
    # A tick of the emergency brake may come earlier or later: 10 ms at 9 m/s2.
    assert (impacts["brake_by_wire"] <= impacts["hydraulic_booster"] + 0.1).all()
    assert (impacts["hydraulic_booster"] <= impacts["esc_pump"] + 0.1).all()
    assert impacts["esc_pump"].max() > impacts["brake_by_wire"].max()


@pytest.mark.thorough
@pytest.mark.parametrize(("bench", "more"), [("ncap_rear", STANDING), ("ncap_crossing", PEDESTRIAN)])
def test_a_sensor_without_faults_is_never_worse(folder: Path, bench: str, more: str) -> None:
    """Without errors that a run keeps: a camera that sees all objects too near brakes earlier."""
    where = PERFECT.replace("crossing_aeb", "aeb_late") + " and brake is esc_pump"
    impacts = []
    unbiased = "".join(f"  sensor.{name}: {{values: [0]}}\n" for name in ("scale_bias", "scale_drift"))
    for sensor, errors in (("object_perfect", ""), ("object_camera", unbiased)):
        chosen = where.replace("object_perfect", sensor)
        rows = explored(folder, f"{bench}_{sensor}", chosen, bench, "20 30 40 50 60 70 80", more + errors)
        impacts.append(rows.set_index(CELL)["impact_speed"].sort_index())
    perfect, faulty = impacts
    assert (perfect <= faulty + 0.1).all()
    assert faulty.max() > perfect.max()


@pytest.mark.thorough
def test_night_and_fog_never_help_a_camera(folder: Path) -> None:
    where = PERFECT.replace("object_perfect", "object_camera") + " and brake is hydraulic_booster"
    weathers = "  weather.darkness: {values: [0, 1]}\n  weather.fog_visibility: {values: [10 km, 40 m]}\n"
    rows = explored(folder, "seen", where, "ncap_crossing", "20 40 60", PEDESTRIAN + weathers)
    rows["weather"] = list(zip(rows["weather.darkness"], rows["weather.fog_visibility"], strict=True))
    impacts = rows.pivot_table(index=CELL, columns="weather", values="impact_speed")
    day = impacts[0, 10_000]
    for weather in ((1, 10_000), (0, 40), (1, 40)):
        assert (impacts[weather] >= day - 0.1).all(), weather
    assert impacts[0, 40].mean() > day.mean()


def stopped(speed: float, gap: float) -> tuple[float, float]:
    """TTC at the first braking and the gap left, by the equations of the emergency brake, and of a brake of 80 ms dead
    time and 120 ms lag: closed forms for the beginning, steps of 0.1 ms for the rest."""
    h, grip = 1e-4, 0.9 * 9.81
    begin = {2: (1.2, 4.0), 3: (0.7, 6.0)}  # ttc, required deceleration
    wanted = {0: 0.0, 2: 4.0, 3: 9.0}
    late, demand, torque, stage, first = [0.0] * round(0.08 / h), 0.0, 0.0, 0, math.nan
    while speed > 0:
        for number, (ttc, required) in begin.items():
            if gap <= max(ttc * speed, speed * 0.2 + speed**2 / (2 * required) + 0.5):
                stage = max(stage, number)
        if stage and math.isnan(first):
            first = gap / speed
        demand = min(wanted[stage], demand + 30 * h)
        late.append(demand)
        torque += (late.pop(0) - torque) * h / 0.12
        speed -= min(torque, grip) * h
        gap -= speed * h
    return first, gap


@pytest.mark.thorough
def test_a_middle_car_brakes_and_stops_as_the_equations_of_its_brake_say(folder: Path) -> None:
    exact = "  aeb.deviations: {values: [0]}\n  aeb.warning_deviations: {values: [0]}\n"
    where = MIDDLE + " and brake is hydraulic_booster"
    one = STANDING.replace("0 %, 50 %, 125 %", "50 %")
    rows = explored(folder, "middle", where, "ncap_rear", "30 40 50 60 70 80", one + exact)
    assert len(rows) == 6
    for speed, braked, left in zip(rows["chassis.initial_speed"], rows["braked"], rows["least_gap"], strict=True):
        first, gap = stopped(speed, 5 * speed)
        # The camera errs by 5 % of the distance, the radar by less, and both report it 60 ms later at least.
        assert braked == pytest.approx(first, rel=0.05, abs=0.06)
        assert left == pytest.approx(gap, abs=0.05 * first * speed)
    assert rows["impact_speed"].max() == 0


@pytest.mark.thorough
def test_a_simulated_car_that_does_not_brake_hits_as_fast_as_it_drives_and_when_the_test_says(folder: Path) -> None:
    where = MIDDLE.replace("crossing_aeb", "no_aeb").replace("tracker is kalman_tracker", "tracker is no_tracker")
    where = where.replace("second_sensor is object_camera", "second_sensor is absent") + " and brake is esc_pump"
    side = "  traffic.kind: {values: [motorcyclist]}\n  traffic.contact: {values: [side]}\n"
    for number, (bench, more) in enumerate(
        (
            ("ncap_rear", STANDING),
            ("ncap_head_on", "  traffic.impact_location: {values: [25 %, 100 %]}\n"),
            ("ncap_crossing", PEDESTRIAN),
            ("ncap_crossing", "  traffic.speed: {values: [20 km/h, 60 km/h]}\n"),
            ("ncap_crossing", side),
        )
    ):
        rows = explored(folder, f"unbraked{number}", where, bench, "20 50 80", more)
        assert len(rows) >= 3
        # One step late at most: 5 s from the start, to within the sag of the speed that the cruise control leaves.
        assert rows["contact_time"].between(5 - 0.011, 5 + 0.021).all(), bench
        assert (rows["host_impact_speed"] - rows["chassis.initial_speed"]).abs().max() < 0.1 * KMH
        assert rows["warned"].max() == 0


@pytest.mark.thorough
def test_a_simulated_car_that_starts_hits_when_the_test_says_unless_it_brakes_for_manoeuvres(folder: Path) -> None:
    """From standstill 3 s after the start, with 1.5 m/s2 up to 10 km/h, forwards and in reverse."""
    where = MIDDLE.replace("object_camera", "object_surround_radars").replace("manoeuvre is absent and ", "")
    where = where.replace("crossing_aeb", "aeb_late") + " and brake is hydraulic_booster"
    child = "  traffic.kind: {values: [child]}\n  traffic.approach: {values: [nearside]}\n"
    child += "  traffic.pull_away_distance: {values: [1 m, 2 m, 4 m]}\n  traffic.speed: {values: [5 km/h]}\n"
    child += "  aeb.min_speed: {values: [60 km/h]}\n"  # it does not act
    reverse = "  traffic.reverses: {values: [true]}\n  robot.reverses: {values: [true]}\n"
    rows = pd.concat(
        explored(folder, f"started{len(way)}", where, "ncap_low_speed", "", child + way) for way in ("", reverse)
    )
    is_helped = rows["manoeuvre"] == "manoeuvre_aeb"
    unbraked, braked = rows[~is_helped], rows[is_helped]
    assert len(unbraked) == len(braked) == 6
    limit = (10 * KMH) ** 2 / 3
    for way, time, speed in zip(
        unbraked["traffic.pull_away_distance"], unbraked["contact_time"], unbraked["host_impact_speed"], strict=True
    ):
        begins = math.sqrt(2 * way / 1.5) if way < limit else 10 * KMH / 1.5 + (way - limit) / (10 * KMH)
        assert time == pytest.approx(3 + begins, abs=0.021)  # a step late at most, and its tick
        assert speed == pytest.approx(min(math.sqrt(3 * way), 10 * KMH), abs=0.05)
    assert braked["host_impact_speed"].max() == 0


@pytest.mark.thorough
@pytest.mark.parametrize("bench", ["ncap_departure", "ncap_adjacent"])
def test_lane_support_keeps_the_car_on_its_lane(folder: Path, bench: str) -> None:
    where = MIDDLE.replace("object_camera", "object_surround_radars").replace("longitudinal", "two_track")
    where = where.replace("lane_support is absent and ", "") + " and brake is hydraulic_booster"
    drifts = "  lateral.drift: {values: [0.2 m/s, 0.4 m/s, 0.7 m/s]}\n"
    if bench == "ncap_adjacent":
        drifts = "  traffic.approach: {values: [same, opposite]}\n  traffic.speed: {values: [110 km/h]}\n"
    rows = explored(folder, bench, where, bench, "50 70 100", drifts)
    metric = "edge_distance" if bench == "ncap_departure" else "impact"
    is_helped = rows["lane_support"] == "emergency_lane_keeping"
    without, with_it = rows[~is_helped][metric], rows[is_helped][metric]
    assert len(without) == len(with_it) >= 6
    if metric == "impact":
        assert (without.min(), with_it.max()) == (1, 0)
    else:
        assert without.max() < 0 < with_it.min()


@pytest.mark.thorough
def test_no_case_of_un_r152_is_passed_without_a_brake_and_all_are_with_an_ideal_sensor(
    folder: Path, tmp_path: Path
) -> None:
    space = Workspace(folder)
    procedure, design = space.procedure("un_r152"), space.design("ncap_vehicle")
    found = {}
    for name, where in (
        (
            "none",
            CAR.replace("tracker is kalman_tracker", "tracker is no_tracker and aeb is no_aeb")
            + " and sensor is object_perfect",
        ),
        ("ideal", PERFECT.replace("crossing_aeb", "crossing_aeb_early") + " and brake is brake_by_wire"),
    ):
        opened = open_space(design, where=parse_expression(where))
        found[name] = verify(procedure, design, [next(opened.configurations())], tmp_path / name)
    cases = {(each.test, each.case) for each in found["none"].verdicts}
    assert len(cases) == 9 + 4
    assert {(each.test, each.case) for each in found["none"].verdicts if each.verdict == "fail"} == cases
    impacts = [each for each in found["none"].verdicts if each.requirement == "impact"]
    for each in impacts:  # nothing brakes: the impact is at the closing speed; a step of 10 ms, tyres that roll
        speed = float(each.case.split()[1]) - (20.0 if each.test == "moving" else 0.0)
        assert each.value / KMH == pytest.approx(speed, abs=0.1)
    assert {each.verdict for each in impacts} == {"fail"}
    assert {each.verdict for each in found["ideal"].verdicts} == {"pass"}
