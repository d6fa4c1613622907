"""The design space of a highway pilot: its counts, what its rules leave, and that its benches say what physics says."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

import dse

pytestmark = pytest.mark.usefixtures("kept_cache")
ROOT = Path(__file__).parents[2]
PARTS = {
    "sensor": "object_radar_mid",
    "second_sensor": "object_camera",
    "tracker": "kalman_tracker",
    "target": "cut_in_target",
    "computer": "computer_middle",
    "controller": "pd_acc",
    "assistant": "speed_assistant",
    "lane_sensor": "lane_camera",
    "lateral": "lq_preview",
    "aeb": "absent",
    "brake": "hydraulic_booster",
    "powertrain": "bev_ideal",
    "chassis": "single_track",
}


def driven(bench: str, sets: dict[str, float], fuse: bool = False, **choices: str) -> Any:
    found = dse.open(ROOT).benches[bench]
    where = " and ".join(f"{part} is {name}" for part, name in {**PARTS, **choices}.items())
    (configuration,) = found.design.list(2, where=where)
    return found.simulate(configuration, set=sets, fuse=fuse)


@pytest.mark.thorough
def test_there_are_so_many_pilots_and_what_is_cheap_enough_has_a_place() -> None:
    design = dse.open(ROOT).benches["highway_cut_in"].design
    assert design.count() == 49_400
    winter = dse.open(ROOT).designs["highway_winter"]
    assert (winter.count(), winter.count(where="slip is absent")) == (91_910, 49_400)
    # Sight of 150 m, and who sees farthest is first: so that is a radar.
    first = {name: design.count(where=f"sensor is {name}") for name in ("object_radar_long", "object_radar_mid")}
    assert sum(first.values()) == 49_400
    assert min(first.values()) > 0
    assert design.count(where="second_sensor is object_lidar") == 0  # beyond the budget, beside a radar
    for place, name in (
        ("second_sensor", "object_stereo"),
        ("second_sensor", "object_camera"),
        ("computer", "computer_small"),
        ("controller", "idm_acc"),
        ("controller", "lq_acc"),
        ("target", "cut_in_target"),
        ("tracker", "no_tracker"),
        ("lane_sensor", "lane_camera"),
    ):
        assert design.count(where=f"{place} is {name}") > 0, name


@pytest.mark.thorough
def test_behind_who_cut_in_the_gap_becomes_what_was_set() -> None:
    """A time gap of 1.5 s and 4 m; the gap closes with e^(-kp/kd t), kp/kd = 0.12/0.65 s."""
    found = driven("highway_cut_in", {"traffic.begin_gap": 45.0})
    assert found.metrics["crashed"] == 0
    speed = found.metrics["final_speed"]
    assert speed == pytest.approx(85 / 3.6, abs=0.5)
    assert found.metrics["time_gap"] == pytest.approx(1.5 + 4 / speed, abs=0.1)
    assert found.metrics["offset"] < 0.5
    assert set(found.verdicts.values()) <= {"pass"}


@pytest.mark.thorough
def test_who_sees_the_cut_in_come_brakes_less_close() -> None:
    gaps = {
        target: driven("highway_cut_in", {"traffic.begin_gap": 30.0}, target=target).metrics["least_gap"]
        for target in ("lane_target", "cut_in_target")
    }
    assert gaps["cut_in_target"] > gaps["lane_target"] + 1


@pytest.mark.thorough
def test_on_fresh_snow_anti_lock_brakes_stop_the_pilot_in_its_lane() -> None:
    runs = {
        slip: driven("highway_snow", {}, chassis="two_track", aeb="two_stage_aeb", slip=slip)
        for slip in ("absent", "anti_lock")
    }
    # 1 mm of lying water, and 4 mm/h for 25 s; three quarters of the loss at 0.5 mm.
    friction = 1 - 0.76 * (1 - 0.25 ** ((1 + 4 * 25 / 3600) / 0.5))
    braked = runs["anti_lock"].metrics
    assert braked["braking"] == pytest.approx(0.8 * 1.1739 * friction * 9.81, rel=0.1)
    assert (braked["crashed"], braked["final_speed"]) == (0, pytest.approx(0, abs=0.01))
    assert braked["offset"] < 0.5
    locked = runs["absent"].metrics
    assert locked["crashed"] > 0
    assert locked["offset"] > 1.875  # half a lane: locked wheels do not steer


@pytest.mark.thorough
@pytest.mark.parametrize("bench", ["highway_cut_in", "highway_following", "highway_bends"])
def test_a_fused_run_has_the_bits_of_fmi_calls(bench: str) -> None:
    first, second = (driven(bench, {}, fuse, controller="lq_acc") for fuse in (False, True))
    one, other = (run.waveforms.to_pandas() for run in (first, second))
    assert one.to_numpy().tobytes() == other.to_numpy().tobytes()
    assert first.metrics == second.metrics
    assert first.metrics["driven"] > 700


@pytest.mark.thorough
def test_two_workers_give_the_bits_of_one(tmp_path: Path) -> None:
    for name in ("components", "designs", "roads", "testbenches"):
        shutil.copytree(ROOT / name, tmp_path / name)
    file = tmp_path / "testbenches" / "highway_architectures.pet.yaml"
    text = file.read_text("utf-8")
    fewer = text.replace("configurations: 24", "configurations: 3").replace("[25 m, 35 m, 45 m, 60 m]", "[30 m]")
    file.write_text(fewer, encoding="utf-8")
    tables = [
        dse.open(tmp_path)
        .studies["highway_architectures"]
        .explore(tmp_path / str(n), workers=n, fresh=True)
        .to_pandas()
        for n in (1, 2)
    ]
    assert len(tables[0]) == 45  # 9 points of five draws
    metrics = ["least_gap", "min_ttc", "time_gap", "braking", "offset", "driven"]
    one, two = (table.sort_values("run")[metrics].to_numpy().tobytes() for table in tables)
    assert one == two
