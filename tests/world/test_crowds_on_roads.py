"""Traffic of many on roads: told all together, whoever runs it."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from world.test_traffic_on_roads import BENCH, DESIGN, ROOT

import dse

pytestmark = pytest.mark.usefixtures("kept_cache")
WIRED = """
test_components:
  traffic: {component: stream_traffic, parameters: {WITH}}
connections:
  - road.lane -> traffic.lane
  - car.motion -> traffic.motion
  - traffic.movers -> road.movers
"""


STUDY = """
study: seeds
title: Another traffic each time
testbench: traffic
configurations: {where: road is road_straight}
conditions:
  traffic.seed: {values: [1, 2, 3, 4]}
"""


def workspace(folder: Path, given: str, stop: str) -> Any:
    for name in ("components", "roads"):
        shutil.copytree(ROOT / name, folder / name)
    for name in ("designs", "testbenches"):
        (folder / name).mkdir()
    (folder / "testbenches" / "seeds.pet.yaml").write_text(STUDY, encoding="utf-8")
    recorded = '"road.actors[1].x", "road.actors[1].y", "road.actors[1].id", "road.actors[1].speed", traffic.everyone'
    text = BENCH.replace("PARTS", WIRED.replace("WITH", given)).replace("STOP", stop).replace("ACTORS", recorded)
    text = text.replace("final(road.actors[1].aside)", "final(traffic.everyone[1].station)")
    (folder / "designs" / "coasting.yaml").write_text(DESIGN, encoding="utf-8")
    (folder / "testbenches" / "traffic.yaml").write_text(text, encoding="utf-8")
    return dse.open(folder)


@pytest.mark.thorough
def test_a_crowd_has_the_same_bits_fused_or_not_by_fmi_2_and_3_and_by_two_workers(tmp_path: Path) -> None:
    opened = workspace(tmp_path, "count: 150, path_length: 1500 m, left_lane: 2, pedestrians: 5", "6 s")
    bench = opened.benches["traffic"]
    configuration, *_ = bench.design.list(1, where="road is road_straight")
    one, two, three = (
        bench.simulate(configuration, fuse=fuse, fmi=fmi).waveforms.to_pandas()
        for fuse, fmi in ((True, 2), (False, 2), (False, 3))
    )
    assert one.to_numpy().tobytes() == two.to_numpy().tobytes() == three.to_numpy().tobytes()
    ids = one[[f"traffic.everyone[{i}].id" for i in range(1, 257)]].to_numpy()
    assert (ids[-1] > 0).sum() > 140
    x, y, number = (one[f"road.actors[1].{name}"].to_numpy() for name in ("x", "y", "id"))
    stays = (number[1:] == number[:-1]) & (number[1:] > 0)
    assert stays.sum() > 400
    speed = one["road.actors[1].speed"].to_numpy()[1:]
    assert (np.hypot(np.diff(x), np.diff(y))[stays] <= 0.0101 * speed[stays] + 0.002).all()
    ends = [
        opened.studies["seeds"].explore(tmp_path / str(workers), workers=workers, fuse=True).to_pandas()["end"].tolist()
        for workers in (1, 2)
    ]
    assert ends[0] == ends[1]
    assert len(set(ends[0])) == 4
