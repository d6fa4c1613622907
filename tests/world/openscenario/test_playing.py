"""An OpenSCENARIO file through the front door: played by itself, and in a study."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from opendrive_texts import geometry, lane as lane_of, opendrive, road, section
from scenario_texts import (
    after,
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
    trigger,
)  # fmt: skip
from workspaces import written

from dse.api import open as open_workspace, play_scenario
from dse.errors import DseError

ROOT = Path(__file__).parents[3]
ROADS = opendrive(road("0", geometry(0.0, 0.0, 0.0, 0.0, 300.0), 300.0, section(0.0, lane_of(1), lane_of(-1))))
# A lane beside that of the leader which the road does not have.
ASIDE = lane_change(1).replace('AbsoluteTargetLane value="1"', 'RelativeTargetLane entityRef="leader" value="7"')
TEXT = scenario(
    car("leader") + car("changer"),
    private("leader", teleport(lane(50)), speed("${1 / $divisor}")) + private("changer", teleport(lane(10)), speed(5)),
    story("changer", event("away", ASIDE, after("$begin"))),
    parameters=declared(divisor=2, begin=1),
    road="roads.xodr",
    more=trigger(
        '<ByValueCondition><SimulationTimeCondition value="2" rule="greaterOrEqual"/></ByValueCondition>', "StopTrigger"
    ),
)


@pytest.mark.thorough
def test_a_scenario_ends_with_its_stop_trigger_or_by_the_name_of_a_lost_entity(tmp_path: Path) -> None:
    written(tmp_path, {"scenario.xosc": TEXT, "roads.xodr": ROADS})
    path = tmp_path / "scenario.xosc"
    played = play_scenario(path, ROOT, {"begin": "9"}, stop=3.0)
    assert played.ended == pytest.approx(2.0)
    assert played.time[-1] == pytest.approx(2.0)
    with pytest.raises(DseError, match=r"entity 'changer' has no position from 1\.01 s on"):
        play_scenario(path, ROOT, {}, stop=3.0)
    with pytest.raises(DseError, match="an expression of the scenario has no finite value"):
        play_scenario(path, ROOT, {"divisor": "0"}, stop=3.0)


STUDY = """study: small
testbench: scenario_cut_in
configurations: {where: "powertrain is bev_ideal and chassis is single_track and aeb is present"}
conditions: {traffic.gap: {values: [20 m, 35 m], title: gap at the cut-in}}
sampler: {uniform: {configurations: 2}}
seed: 1
"""


@pytest.mark.thorough
@pytest.mark.usefixtures("kept_cache")
def test_a_study_of_a_scenario_is_the_same_bytes_on_one_and_two_workers(tmp_path: Path) -> None:
    for name in ("components", "designs", "roads", "testbenches"):
        shutil.copytree(ROOT / name, tmp_path / name)
    written(tmp_path, {"testbenches/small.pet.yaml": STUDY})
    study = open_workspace(tmp_path).studies["small"]
    rows = [study.explore(tmp_path / f"out{n}", workers=n, fresh=True).to_pandas() for n in (1, 2)]
    one, two = (each.sort_values("run").to_csv(index=False) for each in rows)
    assert len(rows[0]) == 4
    assert rows[0]["min_ttc"].nunique() > 1
    assert one == two
