"""The C core against the evaluator in Python, on the roads of the library."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from components.conftest import ROOT, WORKSPACE

from dse.world import lane_middle, open_roads, place, project, road_tables, value

ROADS = sorted((ROOT / "roads").glob("*.yaml"))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("file", ROADS, ids=lambda file: file.stem)
def test_both_evaluators_place_points_alike(new_road: Callable[..., Any], file: Any) -> None:
    (path,) = road_tables(open_roads(str(file), WORKSPACE)).paths
    part = new_road(path)
    part.init()
    chance = np.random.default_rng(5)
    stations = np.sort(chance.uniform(0, path.length, 120))
    sides = chance.uniform(-3, 3, 120)
    places, middles = place(path, stations, sides), lane_middle(path, stations)
    edges = place(path, stations, middles)
    for i, (s, t) in enumerate(zip(stations, sides, strict=True)):
        part["motion.x"], part["motion.y"], part["motion.heading"] = places.x[i], places.y[i], places.heading[i]
        for wheel in range(1, 5):
            part[f"contacts[{wheel}].x"], part[f"contacts[{wheel}].y"] = places.x[i], places.y[i]
        part.step()
        found, aside = project(path, places.x[i], places.y[i])
        if abs(found - s) > 1e-6:
            continue  # the line jumps to its side here, and the point is nearer to its other end
        assert aside == pytest.approx(t, abs=1e-8)
        assert part["lane.offset"] == pytest.approx(t - middles[i], abs=1e-8)
        assert part["ground[1].height"] == pytest.approx(places.z[i], abs=1e-8)
        assert part["lane.bank"] == pytest.approx(places.bank[i], abs=1e-12)
        assert part["lane.speed_limit"] == value(path.speed_limit, np.array([s]))[0]
        # What stands on the middle of the lane that far along it stands there, too.
        part["movers[1].class"], part["movers[1].station"] = "car", part["lane.station"]
        part.step()
        assert math.hypot(part["actors[1].x"] - edges.x[i], part["actors[1].y"] - edges.y[i]) < 1e-7
        assert part["actors[1].ahead"] == pytest.approx(0, abs=1e-9)
    part["movers[1].class"] = "none"
