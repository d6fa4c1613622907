"""The benches of cars on roads: the paper's verdicts in a world of parts, and the same bits however runs are made."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

import dse

pytestmark = pytest.mark.usefixtures("kept_cache")
ROOT = Path(__file__).parents[2]
FOLDERS = ("components", "designs", "roads", "testbenches")
PARTS = {"sensor": "radar_77ghz_mid", "controller": "pd_acc", "brake": "hydraulic_booster"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the workspace, in which acc_following passes values on as the benches of roads do."""
    place = tmp_path_factory.mktemp("roads")
    for name in FOLDERS:
        shutil.copytree(ROOT / name, place / name)
    bench = place / "testbenches" / "acc_following.yaml"
    text = bench.read_text("utf-8")
    assert text.count("  step: 10 ms\n") == 1
    bench.write_text(text.replace("  step: 10 ms\n", "  step: 10 ms\n  algorithm: gauss_seidel\n"), encoding="utf-8")
    return place


def driven(folder: Path, bench: str, sets: dict[str, float], fuse: bool = False, **choices: str) -> Any:
    workspace = dse.open(folder)
    found = workspace.benches[bench]
    where = " and ".join(
        f"{part} is {name}" for part, name in {**PARTS, "powertrain": "combustion_ideal", **choices}.items()
    )
    configuration, *_ = found.design.list(1, where=where)
    return found.simulate(configuration, set=sets, fuse=fuse)


ON_ROAD = {"lateral": "pure_pursuit", "chassis": "longitudinal", "road": "road_straight"}


@pytest.mark.thorough
def test_on_a_straight_road_the_car_without_sideways_slip_repeats_the_paper(folder: Path) -> None:
    old = driven(folder, "acc_following", {}, video="absent")
    new = driven(folder, "road_clear", {}, **ON_ROAD)
    assert new.verdicts["R1"] == old.verdicts["R1"] == "pass"
    assert new.verdicts["R2"] == old.verdicts["R2"] == "pass"
    assert new.metrics["offset"] == 0
    # Nothing is ahead until the gap is in the sensor's range: the same arithmetic up to there.
    assert new.metrics["speed_reached"] == old.metrics["speed_reached"]
    # Then stations of the lead are rounded otherwise, by some 1e-13 m, and a ray may hit it a little sooner.
    assert new.metrics["gap_undershoot"] == pytest.approx(old.metrics["gap_undershoot"], abs=0.005)


@pytest.mark.thorough
def test_the_verdicts_of_the_gains_are_the_papers_one_by_one(folder: Path, tmp_path: Path) -> None:
    """A ninth of each axis of acc_gains; on all 2,178 points, too, when this was written."""
    found = {}
    for name in ("acc_gains", "road_gains"):
        file = folder / "testbenches" / f"{name}.pet.yaml"
        file.write_text(file.read_text("utf-8").replace("levels: 33", "levels: 5"), encoding="utf-8")
        rows = dse.open(folder).studies[name].explore(tmp_path / name, workers=2, fuse=True).to_pandas()
        found[name] = rows[["R1.verdict", "R2.verdict"]].to_numpy().tolist()
    assert found["road_gains"] == found["acc_gains"]
    assert {verdict for row in found["road_gains"] for verdict in row} == {"pass", "fail", "not exercised"}


CASES = [
    (
        "road_following",
        {"lateral": "lq_preview", "chassis": "two_track", "road": "road_curve"},
        {"weather.gust_speed": 20.0},
    ),
    ("road_braking", {"lateral": "preview_driver", "chassis": "single_track", "road": "road_split_friction"}, {}),
]


@pytest.mark.thorough
@pytest.mark.parametrize(("bench", "choices", "sets"), CASES)
def test_a_fused_run_has_the_bits_of_fmi_calls(
    folder: Path, bench: str, choices: dict[str, str], sets: dict[str, float]
) -> None:
    runs = [driven(folder, bench, sets, fuse, **choices) for fuse in (False, True)]
    first, second = (run.waveforms.to_pandas() for run in runs)
    assert first.to_numpy().tobytes() == second.to_numpy().tobytes()
    assert runs[0].metrics == runs[1].metrics
    assert first["road.lane.station"].iloc[-1] > 300


@pytest.mark.thorough
def test_workers_and_what_else_is_explored_change_no_bit(folder: Path, tmp_path: Path) -> None:
    """The same designs alone by one worker and FMI calls, and among others by two workers, fused."""
    text = (folder / "testbenches" / "road_lateral.pet.yaml").read_text("utf-8")
    small = text.replace("study: road_lateral", "study: few").replace("[dry, wet, snow]", "[dry, snow]")
    small = small.replace("[50 km/h, 60 km/h, 70 km/h, 80 km/h]", "[60 km/h]")
    (folder / "testbenches" / "few.pet.yaml").write_text(small, encoding="utf-8")
    alone = small.replace("study: few", "study: alone").replace("in [single_track, two_track]", "is two_track")
    (folder / "testbenches" / "alone.pet.yaml").write_text(alone, encoding="utf-8")
    tables = {}
    for name, workers, fuse in (("alone", 1, False), ("few", 2, True)):
        table = (
            dse.open(folder).studies[name].explore(tmp_path / name, workers=workers, fuse=fuse, fresh=True).to_pandas()
        )
        table = table[table["chassis"] == "two_track"] if "chassis" in table else table
        metrics = [column for column in table.columns if table[column].dtype.kind == "f" and column != "duration"]
        order = table.sort_values(["lateral", "weather.road", "weather.gust_speed"])
        tables[name] = {column: order[column].to_numpy().tobytes() for column in metrics}
    assert tables["few"].keys() == tables["alone"].keys()
    differing = [column for column, bits in tables["few"].items() if tables["alone"][column] != bits]
    assert not differing
