"""Emergency braking: the design space counted by hand, and what sensors, tracker and brakes decide by closed forms."""

from __future__ import annotations

import itertools
import math
import shutil
from pathlib import Path
from typing import Any

import pytest

import dse

pytestmark = pytest.mark.usefixtures("kept_cache")
ROOT = Path(__file__).parents[2]
FOLDERS = ("components", "designs", "roads", "testbenches")
KMH = 1 / 3.6
REST = (
    "controller is pd_acc and lateral is pure_pursuit and powertrain is combustion_ideal and chassis is longitudinal"
    " and slip is absent"
)
SENSORS = "sensor: {alternatives: [object_radar_long"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the workspace, in which a sensor without faults can be chosen as well."""
    place = tmp_path_factory.mktemp("assisted")
    for name in FOLDERS:
        shutil.copytree(ROOT / name, place / name)
    design = place / "designs" / "aeb_vehicle.yaml"
    text = design.read_text("utf-8")
    assert text.count(SENSORS) == 1
    design.write_text(text.replace(SENSORS, SENSORS.replace("[", "[object_perfect, ")), encoding="utf-8")
    return place


def explored(folder: Path, name: str, where: str, benches: str, cases: str, **options: Any) -> Any:
    """The runs of a study of *benches* over the *cases*, a car that would be there after five seconds."""
    text = f"""
study: {name}
testbench: {benches}
configurations: {{where: "{REST} and {where}"}}
design_variables:
  controller.set_speed: {{derived: chassis.initial_speed}}
  road.start_station: {{derived: 150 m - 5 s * chassis.initial_speed}}
conditions: {cases}
keep_waveforms: none
"""
    (folder / "testbenches" / f"{name}.pet.yaml").write_text(text, encoding="utf-8")
    return dse.open(folder).studies[name].explore(folder / "out" / name, fresh=True, **options).to_pandas("si")


def speeds(*kmh: int) -> str:
    return "chassis.initial_speed: {values: [" + ", ".join(f"{each} km/h" for each in kmh) + "]}"


def test_the_design_space_counts_as_a_list_of_all_combinations_does() -> None:
    costs = {"long": 145, "mid": 95, "lidar": 620, "camera": 80, "kalman": 25, "none": 5}
    brakes = {"pump": (130, 15), "booster": (210, 20), "wire": (390, 45)}
    powers = {"long": 9, "mid": 5, "lidar": 8, "camera": 6, "kalman": 3, "none": 1}
    controllers = {"pd": (4, 0.5), "pi": (5, 1.0), "idm": (9, 4.0)}
    raw = valid = controlled = 0
    for first, second, tracker, brake, controller in itertools.product(
        ("long", "mid", "lidar", "camera"), (None, "mid", "lidar", "camera"), ("kalman", "none"), brakes, controllers
    ):
        raw += 1
        seeing = [first, second] if second else [first]
        cost = sum(costs[each] for each in seeing) + costs[tracker] + 70 + brakes[brake][0]
        power = sum(powers[each] for each in [*seeing, tracker]) + 6 + 1 + controllers[controller][0] + brakes[brake][1]
        compute = (0.5 if tracker == "kalman" else 0.05) + controllers[controller][1]
        is_pair_fine = not second or (
            tracker == "kalman" and first not in ("camera", second) and (first, second) != ("lidar", "mid")
        )
        # 5 W each: both lateral controllers
        fits = cost <= 1150 and is_pair_fine and ("lidar" not in seeing or compute >= 1)
        valid += 5 * (fits and power + 5 <= 80)
        controlled += 3 * sum(
            fits and power + 5 + slip <= 80 for slip in (5, 5, 8)
        )  # three of the chassis are that car
    design = dse.open(ROOT).designs["aeb_vehicle"]
    others = 3 * 5 * 2  # calibrations, powertrains, lateral controllers
    assert (raw * 5 * 4 * others, valid * others, controlled * others) == (172_800, 16_800, 27_090)
    assert design.count(where="slip is absent") == valid * others
    assert design.count() == (valid + controlled) * others
    assert 0 < design.count(on=["by_rule"]) < design.count()


@pytest.mark.thorough
def test_who_never_brakes_hits_with_the_speed_it_drives(folder: Path) -> None:
    """The least speed of the brake is beyond that of the car."""
    rows = explored(
        folder,
        "unbraked",
        "sensor is object_perfect and second_sensor is absent and tracker is kalman_tracker and aeb is two_stage_aeb"
        " and brake is hydraulic_booster",
        "[aeb_pedestrian, aeb_car_to_car]",
        "{" + speeds(20, 30, 40, 50) + ", aeb.min_speed: {values: [60 km/h]}}",
    )
    assert len(rows) == 8
    # The cruise control lets the speed sag by some 0.1 km/h in the first second.
    assert (rows["impact_speed"] - rows["chassis.initial_speed"]).abs().max() < 0.1 * KMH
    assert set(rows["R1.verdict"]) == {"fail"}
    assert rows["braked"].isna().all()
    risk = rows[rows["testbench"] == "aeb_pedestrian"].set_index("chassis.initial_speed")["fatality_risk"].to_list()
    # Rosen and Sander 2009: at 50 km/h more than five times as high as at 30, more than twice as high as at 40.
    assert len(risk) == 4
    assert risk[3] > 5 * risk[1] > 0
    assert risk[3] > 2 * risk[2]
    assert risk[3] == pytest.approx(1 / (1 + math.exp(6.9 - 0.090 * 50)), rel=0.02)
    assert set(rows.loc[rows["testbench"] == "aeb_car_to_car", "fatality_risk"]) == {0.0}


def impact(speed: float, brake: dict[str, float]) -> float:
    """Impact speed with a car that stands, by the equations of aeb_late and of a brake, in steps of 0.1 ms."""
    grip, jerk, h = 0.9 * 9.81, 30.0, 1e-4
    full = max(0.6 * speed, speed * 0.1 + speed**2 / (2 * 8.5) + 0.5)
    partial = max(0.7 * speed, speed * 0.1 + speed**2 / (2 * 7.0) + 0.5)
    gap, demand, torque, stage = 3 * partial, 0.0, 0.0, 0
    late: list[float] = [0.0] * round(brake["dead_time"] / h)
    while speed > 0 and gap > 0:
        c = speed
        full = max(0.6 * c, c * 0.1 + c**2 / (2 * 8.5) + 0.5)
        partial = max(0.7 * c, c * 0.1 + c**2 / (2 * 7.0) + 0.5)
        stage = max(stage, 2 if gap <= full else 1 if gap <= partial else 0)
        wanted = (0.0, 4.0, 9.0)[stage]
        demand = min(wanted, demand + jerk * h)
        late.append(demand)
        torque += (late.pop(0) - torque) * h / brake["lag"]
        speed -= min(torque, grip) * h
        gap -= speed * h
    return max(speed, 0.0) if gap <= 0 else 0.0


@pytest.mark.thorough
def test_with_a_sensor_without_faults_a_late_brake_hits_as_the_equations_of_braking_say(folder: Path) -> None:
    brakes = {
        "esc_pump": {"dead_time": 0.15, "lag": 0.25},
        "hydraulic_booster": {"dead_time": 0.08, "lag": 0.12},
        "brake_by_wire": {"dead_time": 0.02, "lag": 0.04},
    }
    rows = explored(
        folder,
        "late",
        "sensor is object_perfect and second_sensor is absent and tracker is kalman_tracker and aeb is aeb_late",
        "aeb_car_to_car",
        "{" + speeds(15, 20, 30, 40, 50, 60) + "}",
    )
    assert len(rows) == 18
    driven = zip(rows["chassis.initial_speed"], rows["brake"], strict=True)
    expected = [impact(speed, brakes[brake]) for speed, brake in driven]
    found = rows["impact_speed"].tolist()
    # 50 ms at most are lost on the way through sensor, tracker, brake and tyres: 0.05 s * 9 m/s2, more near standstill.
    for told, seen in zip(found, expected, strict=True):
        assert told**2 == pytest.approx(seen**2, abs=2 * 9.0 * 0.06 * max(rows["chassis.initial_speed"]))
    assert min(found) == 0 < max(found)


@pytest.mark.thorough
def test_with_a_sensor_without_faults_an_early_brake_avoids_every_standing_car(folder: Path) -> None:
    """It begins where 3 m/s2 would do, so that 0.5 s to build up the pressure are no harm up to 80 km/h and beyond."""
    rows = explored(
        folder,
        "early",
        "sensor is object_perfect and second_sensor is absent and tracker is kalman_tracker and aeb is aeb_early",
        "[aeb_car_to_car, aeb_pedestrian]",
        "{" + speeds(10, 20, 30, 40, 50, 60, 70, 80) + "}",
    )
    cars = rows[rows["testbench"] == "aeb_car_to_car"]
    assert set(cars["R1.verdict"]) == {"pass"}
    assert cars["least_gap"].min() > 0


@pytest.mark.thorough
def test_fog_blinds_a_camera_and_no_radar(folder: Path) -> None:
    rows = explored(
        folder,
        "fog",
        "sensor in [object_radar_mid, object_camera] and second_sensor is absent and tracker is kalman_tracker"
        " and aeb is two_stage_aeb and brake is hydraulic_booster",
        "aeb_car_to_car",
        "{" + speeds(50) + ", weather.fog_visibility: {values: [20 m, 50 m, 10 km]}}",
    )
    by = {
        (row.sensor, round(visibility)): row
        for row, visibility in zip(rows.itertuples(), rows["weather.fog_visibility"], strict=True)
    }
    radar = [by["object_radar_mid", visibility] for visibility in (20, 50, 10_000)]
    assert {(row.impact_speed, row.tracked) for row in radar} == {(0.0, radar[0].tracked)}
    camera = [by["object_camera", visibility] for visibility in (20, 50, 10_000)]
    assert camera[0].impact_speed > camera[2].impact_speed
    assert camera[0].tracked < camera[1].tracked < camera[2].tracked
    # It sees where exp(-3 R / visibility) is a contrast of 5 %, that is at the visibility; 0.5 m ahead of the centre of
    # gravity, 4.55 m behind which the gap begins. Three looks, the latency and the tracker's step are 0.2 s.
    for row, visibility in ((camera[0], 20.0), (camera[1], 50.0)):
        assert row.tracked == pytest.approx((visibility - 1.8) * math.log(20) / 3 / (50 * KMH) - 0.15, abs=0.2)


@pytest.mark.thorough
def test_on_snow_an_emergency_brake_with_anti_lock_brakes_brakes_as_the_friction_allows() -> None:
    bench, speed = dse.open(ROOT).benches["aeb_car_to_car"], {}
    for slip in ("absent", "anti_lock"):
        where = REST.replace("longitudinal", "two_track").replace("slip is absent", f"slip is {slip}")
        design = "sensor is object_radar_long and second_sensor is absent and tracker is kalman_tracker"
        chosen = f"{where} and {design} and aeb is aeb_early and brake is hydraulic_booster"
        (configuration,) = bench.design.list(2, where=chosen)
        run = bench.simulate(configuration, set={"weather.road": "snow"})
        speed[slip] = run.metrics["impact_speed"]
        table = run.waveforms.to_pandas()
        braked = table.loc[table["aeb.stage"].isin(["partial", "full", 2, 3]), "road.actors[1].ahead"].iloc[0] - 4.55
    # Dead time and build-up of the brake: 0.2 s. The tyre of two_track, at the friction of snow.
    limit = math.sqrt((50 * KMH) ** 2 - 2 * 0.8 * 1.1739 * 0.24 * 9.81 * (braked - 0.2 * 50 * KMH))
    assert speed["anti_lock"] == pytest.approx(limit, rel=0.1)
    assert speed["absent"] > 1.3 * speed["anti_lock"]


@pytest.mark.thorough
def test_no_bit_depends_on_workers_or_on_how_runs_are_made(folder: Path) -> None:
    where = (
        "sensor is object_radar_mid and second_sensor in [object_lidar, object_camera] and aeb is aeb_early"
        " and brake is esc_pump"
    )
    cases = "{" + speeds(30, 60) + ", weather.fog_visibility: {values: [50 m, 10 km]}}"
    benches = "[aeb_pedestrian, aeb_car_to_car, aeb_bystander]"
    tables = [
        explored(folder, "bits", where, benches, cases, workers=workers, fuse=fuse)
        for workers, fuse in ((1, False), (2, False), (2, True))
    ]
    metrics = [name for name in tables[0].columns if tables[0][name].dtype.kind == "f" and name != "duration"]
    assert len({table[metrics].to_numpy().tobytes() for table in tables}) == 1
    assert len(tables[0]) == 24


@pytest.mark.thorough
def test_a_cut_in_is_judged_where_r157_says_it_can_be_avoided(folder: Path) -> None:
    bench = dse.open(folder).benches["aeb_cut_in"]
    where = f"{REST} and sensor is object_perfect and second_sensor is absent and tracker is kalman_tracker"
    configuration, *_ = bench.design.list(1, where=f"{where} and aeb is aeb_early and brake is brake_by_wire")
    verdicts = {}
    for gap in (22.0, 28.0):
        run = bench.simulate(configuration, set={"traffic.begin_gap": gap, "aeb.min_speed": 60.0})
        closing = run.metrics["closing_speed"]
        assert run.metrics["avoidable"] == pytest.approx(closing / 12 + 0.35)
        # 1.15 m of 3.5 m across: 0.406 of the quintic, which takes 1.875 * 3.5 m / 1.5 m/s.
        assert run.metrics["intrusion"] == pytest.approx(gap / closing - 0.406 * 1.875 * 3.5 / 1.5, abs=0.05)
        verdicts[gap] = run.verdicts["R1"]
    assert verdicts == {22.0: "not exercised", 28.0: "fail"}
    braked = bench.simulate(configuration)
    assert braked.verdicts["R1"] == "pass"


# Nothing is to be braked for. A set-up that brakes all the same, by the reason in docs/aeb.md.
NEEDLESS: dict[str, tuple[str, dict[str, Any]]] = {
    "aeb_bystander": ("aeb_early", {}),
    "aeb_parked_bend": ("aeb_early", {}),
    "aeb_oncoming_turn": ("aeb_early", {}),
    "aeb_cyclist": ("aeb_late", {"aeb.vulnerable_margin": "1.5 m"}),
    "aeb_bridge": ("aeb_late", {"sensor.least_clearance": "0 m"}),
    "aeb_manhole": ("aeb_late", {"sensor.least_height": "0 m"}),
    "aeb_spray": ("aeb_early", {}),
    "aeb_guard_rail": ("aeb_early", {}),
}


@pytest.mark.thorough
@pytest.mark.parametrize("name", NEEDLESS)
def test_where_nothing_is_to_be_braked_for_only_a_gullible_set_up_brakes(folder: Path, name: str) -> None:
    bench = dse.open(folder).benches[name]
    place = {"chassis.initial_speed": "60 km/h", "controller.set_speed": "60 km/h"}
    if name == "aeb_bystander":
        place["road.start_station"] = "66.667 m"  # contact after five seconds
    if name == "aeb_spray":
        place["sensor.spray_share"] = "1"
    heights = {"sensor.least_clearance": "2.5 m", "sensor.least_height": "0.15 m"}

    def run(aeb: str, **values: Any) -> Any:
        where = f"{REST} and sensor is object_perfect and second_sensor is absent and tracker is kalman_tracker"
        configuration, *_ = bench.design.list(1, where=f"{where} and aeb is {aeb} and brake is brake_by_wire")
        return bench.simulate(configuration, set={**place, **heights, **values})

    exact, gullible = run("aeb_late"), run(NEEDLESS[name][0], **NEEDLESS[name][1])
    for each in (exact, gullible):
        assert each.metrics["met"] > 0.5
        assert set(each.verdicts) == {"R3"}
    # The cruise control lets the speed sag by some 0.1 km/h.
    assert exact.metrics["needless"] < 0.2 * KMH
    assert gullible.metrics["needless"] > 2 * KMH
    assert (exact.verdicts["R3"], gullible.verdicts["R3"]) == ("pass", "fail")
    # It drives on and passes, without contact; or follows the truck.
    assert exact.metrics["hit"] == 0
    ahead = exact.waveforms.to_pandas()["road.actors[1].ahead"]
    assert ahead.iloc[-1] < 0 or (name == "aeb_spray" and ahead.iloc[-1] == pytest.approx(ahead.iloc[0], abs=1.0))


@pytest.mark.thorough
def test_in_ordinary_traffic_nothing_is_to_be_braked_for_and_false_brakes_are_counted_per_distance() -> None:
    bench = dse.open(ROOT).benches["aeb_traffic"]
    where = f"{REST} and second_sensor is absent and tracker is kalman_tracker and brake is brake_by_wire"
    (configuration,) = bench.design.list(2, where=f"{where} and sensor is object_camera and aeb is aeb_early")
    never = {"aeb.partial_ttc": 0, "aeb.full_ttc": 0, "aeb.partial_required": 20, "aeb.full_required": 20}
    gullible = {"aeb.deviations": 0, "aeb.warning_deviations": 0, "aeb.vulnerable_margin": 2}
    for seed in (1, 2, 3):
        unbraked = bench.simulate(configuration, set={"traffic.seed": seed, **never})
        assert unbraked.metrics["driven"] > 1500
        assert (unbraked.metrics["hit"], unbraked.metrics["brakes"], unbraked.metrics["false_brakes"]) == (0, 0, 0)
        assert unbraked.metrics["least_gap"] > 10
        assert unbraked.verdicts["R4"] == "pass"
        braked = bench.simulate(configuration, set={"traffic.seed": seed, **gullible})
        stages = braked.waveforms.to_pandas()["aeb.stage"].isin(["partial", "full", 2, 3])
        # A row is kept every 100 ms, so that a short brake may be missed.
        assert braked.metrics["brakes"] >= (stages & ~stages.shift(fill_value=False)).sum() > 0
        assert braked.metrics["false_brakes"] == braked.metrics["brakes"] / braked.metrics["driven"]
        assert braked.verdicts["R4"] == "fail"


@pytest.mark.thorough
def test_each_bench_without_a_reason_to_brake_is_judged_by_its_needless_braking() -> None:
    """A bench that R3 does not name would not be judged."""
    benches = dse.open(ROOT).benches
    judged = {name for name in benches for each in benches[name].noun.requirements if each.metric == "needless"}
    texts = {file.stem: file.read_text("utf-8") for file in (ROOT / "testbenches").glob("aeb_*.yaml")}
    assert judged == {name for name, text in texts.items() if "_aeb_needless.yaml" in text} | {"aeb_bystander"}
    assert judged == set(NEEDLESS)
