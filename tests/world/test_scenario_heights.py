"""Heights of scenarios: which of two roads above each other is meant, and how high driven paths are."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path
from xml.etree.ElementTree import parse

import numpy as np
import pytest
from opendrive_texts import opendrive
from world.small_roads import CROSSINGS

import dse
from dse.interchange import DrivenEntity, scenario_text
from dse.world import place, project, read_network, road_tables
from dse.world.openscenario.paths import Paths, height_at

ROOT = Path(__file__).parents[2]
OVER_AND_UNDER = (("a bridge 8 m above", 8.0), ("an underpass in a dip", -4.8))


@pytest.mark.parametrize(("name", "height"), OVER_AND_UNDER)
def test_the_height_of_a_place_chooses_between_a_bridge_and_the_road_below(
    name: str, height: float, tmp_path: Path
) -> None:
    file = tmp_path / "bridge.xodr"
    file.write_text(opendrive(*CROSSINGS[name].parts), "utf-8")
    paths = Paths(read_network(file, file.name))
    lower, upper = sorted((0.0, height))
    by_height = {"1": height if height < 0 else lower, "2": upper}
    # Where they cross, next to the middle of the lane of either.
    for road, z in by_height.items():
        for x, y in ((199.0, -1.0), (201.0, -2.0)):
            found = paths.nearest(x, y, z + 0.3)
            assert found is not None
            assert found[0] == road
    assert paths.nearest(201.0, -2.0, 500.0) == paths.nearest(201.0, -2.0)  # on no level: as if it had no height


def test_a_banked_road_is_higher_on_its_left(tmp_path: Path) -> None:
    file = tmp_path / "ramp.xodr"
    file.write_text(opendrive(*CROSSINGS["a ramp that rises to a bridge"].parts), "utf-8")
    road = read_network(file, file.name).roads["2"]
    banked = replace(road, superelevation=(replace(road.elevation[0], a=0.05),))
    assert height_at(road, 130.0, 3.0) == pytest.approx(3.0)
    assert height_at(banked, 130.0, 3.0) == pytest.approx(3.0 + 3.0 * math.tan(0.05))


def test_a_driven_path_has_the_height_of_its_road() -> None:
    line = np.linspace(0.0, 10.0, 3)
    text = scenario_text([DrivenEntity("Ego", 1, (4.6, 1.8, 1.5), line, line, 0 * line, 0.06 * line, 0 * line)], "", "")
    assert 'x="5.000000" y="0.000000" z="0.300000" h="0.000000"' in text
    # A player moves the box if the rear axle is not at the position.
    assert '<RearAxle maxSteering="0.5" wheelDiameter="0.65" trackWidth="1.5" positionZ="0.32" positionX="0"/>' in text
    assert '<Center x="0" y="0" z="0.75"/>' in text


@pytest.mark.thorough
def test_an_exported_run_is_as_high_as_its_road(tmp_path: Path) -> None:
    bench = dse.open(ROOT).benches["road_braking"]
    chosen = next(each.id for each in bench.design.list(20000) if each.choices.get("road") == "road_hill")
    dse.api.export_scenario(bench.noun, chosen, {}, tmp_path / "run.xosc")
    roads = read_network(tmp_path / "run.xodr", "run.xodr")
    path = road_tables(roads).paths[0]
    places = parse(tmp_path / "run.xosc").iter("WorldPosition")  # noqa: S314  # our own file
    points = [{name: float(text) for name, text in each.attrib.items()} for each in places]
    assert np.ptp([point["z"] for point in points]) > 1.0
    for point in points[::7]:
        station, t = project(path, point["x"], point["y"])
        assert point["z"] == pytest.approx(float(place(path, np.array([station]), t).z[0]), abs=0.02)
