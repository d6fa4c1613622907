"""Roads as components: what is wrong is told at its line, and the world is the same bits however it is run."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from components.conftest import WORKSPACE
from fusion.conftest import Workshop, both_ways, system_of
from kinds.examples import EXAMPLES
from opendrive_texts import geometry, lane, opendrive, road, section, to_junction

from dse.domain.method import Algorithm, Method
from dse.errors import DseError
from dse.loading import kind_of
from dse.testing.kinds import lay_out, the_component

PARTS = {"road": "road_curve", "car": "two_track", "traffic": "lead_vehicle", "weather": "set_weather",
         "scene": "ray_scanner", "sensor": "lidar_905nm"}  # fmt: skip
WIRES = [
    "car.motion -> road.motion", "car.contacts -> road.contacts", "traffic.movers -> road.movers",
    "weather.surface -> road.surface", "weather.air -> car.air", "road.ground -> car.ground", "road.start -> car.start",
    "road.lane -> traffic.lane", "road.actors -> scene.actors", "road.lane -> scene.lane", "car.motion -> scene.motion",
    "scene.scene -> sensor.scene", "weather.visibility -> sensor.visibility",
]  # fmt: skip
RECORD = ["car.motion.x", "car.motion.speed", "road.lane.station", "road.lane.offset", "road.ground[4].slope_y",
          "road.actors[1].heading", "scene.scene.range", "scene.gap", "sensor.target.gap"]  # fmt: skip


def wired(parts: dict[str, str], wires: list[str]) -> Iterator[str]:
    """The wires between single ports that wires between groups of them mean."""
    components = {part: WORKSPACE.component(name) for part, name in parts.items()}
    for wire in wires:
        (giving, source), (taking, target) = (end.split(".", 1) for end in wire.split(" -> "))
        ends = zip(components[giving].interface.group(source), components[taking].interface.group(target), strict=True)
        yield from (f"{giving}.{a.name} -> {taking}.{b.name}" for a, b in ends)


@pytest.mark.thorough
@pytest.mark.parametrize(
    "algorithm", [Algorithm.GAUSS_SEIDEL, pytest.param(Algorithm.JACOBI, marks=pytest.mark.thorough)]
)
def test_a_world_is_the_same_bits_fused_or_not_and_again(tmp_path: Path, algorithm: Algorithm) -> None:
    workshop = Workshop(tmp_path, tmp_path / "cache", method=Method(algorithm))
    models = {part: workshop.built(WORKSPACE.component(name)) for part, name in PARTS.items()}
    system = system_of(models, list(wired(PARTS, WIRES)), RECORD)
    start = {"car.initial_speed": 20.0, "road.start_station": 250.0, "traffic.initial_gap": 40.0,
             "weather.rain_rate": 5e-6, "weather.fog_visibility": 300.0, "car.wheels.front": 150.0}  # fmt: skip
    first, _, again = both_ways(
        workshop, system, RECORD, [start, {**start, "road.start_station": 20.0}, start], stop=4.0
    )
    assert first.tobytes() == again.tobytes()
    assert np.isfinite(first).all()
    assert first[-1, RECORD.index("road.lane.station")] > 320  # along the curve, of which the lane banks
    assert abs(first[-1, RECORD.index("road.ground[4].slope_y")]) > 0


def checked(root: Path) -> None:
    component = the_component(root)
    kind = kind_of(component)
    assert kind is not None
    kind.check(component, component.source)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("old", "new", "line", "what"),
    [
        ("route: [1]", "route: [7]", 3, "there is no road '7' in the file"),
        ("implements: road", "implements: traffic", 1, "a road implements 'road', not 'traffic'"),
        ("start_station", "start_statoin", 5, "a road has no parameter 'start_statoin'"),
        ("start: 0, type: int", "start: 8, type: int", 5, "'start_lane': the path has no lane 8"),
        ("bend.yaml", "bent.yaml", 3, "no such file"),
        ("bend.yaml", "bend.csv", 3, "bend.csv"),
        ("route: [1]", "rout: [1]", 3, "unknown key 'rout'"),
    ],
)  # fmt: skip
def test_what_is_wrong_with_a_road_is_told_where_it_stands(
    tmp_path: Path, old: str, new: str, line: int, what: str
) -> None:
    files = dict(EXAMPLES["road"]())
    text = str(files["twice/component.yaml"])
    assert old in text
    root = lay_out({**files, "twice/component.yaml": text.replace(old, new)}, tmp_path)
    with pytest.raises(DseError) as caught:
        checked(root)
    problem = caught.value.problems[0]
    assert what in problem.what
    assert f"component.yaml:{line}:" in f"{problem.where}:"


def test_what_is_wrong_in_a_road_file_is_told_at_its_own_line(tmp_path: Path) -> None:
    files = {**EXAMPLES["road"](), "../roads/bend.yaml": "road: bend\nsegments:\n  - straight: 50 kg\n"}
    root = lay_out(files, tmp_path)
    with pytest.raises(DseError) as caught:
        checked(root)
    assert ["bend.yaml:3" in str(problem.where) for problem in caught.value.problems] == [True]


def test_further_paths_follow_the_hosts_in_their_order(tmp_path: Path) -> None:
    files = dict(EXAMPLES["road"]())
    text = str(files["twice/component.yaml"]).replace(
        "{same: {route: [1]}}", "{back: {route: [1], lane: 1}, there: {route: [1], lane: -2}}"
    )
    root = lay_out({**files, "twice/component.yaml": text}, tmp_path)
    component = the_component(root)
    ways = component.source.ways  # type: ignore[union-attr]
    assert [(way.name, way.roads, way.lane) for way in ways] == [
        ("host", (), 0), ("back", ("1",), 1), ("there", ("1",), -2),
    ]  # fmt: skip
    checked(root)


def with_road(folder: Path, source: str, text: str) -> tuple[str, ...]:
    """What is told of a road component with that *source*, of the OpenDRIVE *text*."""
    files = dict(EXAMPLES["road"]())
    written = str(files["twice/component.yaml"])
    old = written[written.index("source:") : written.index("parameters:")]
    files["twice/component.yaml"] = written.replace(
        old, f"source: {{kind: road, file: ../../roads/own.xodr{source}}}\n"
    )
    files["../roads/own.xodr"] = text
    component = the_component(lay_out(files, folder))
    kind = kind_of(component)
    assert kind is not None
    return tuple(f"{Path(str(p.where).split(':')[0]).name}: {p.what}" for p in kind.check(component, component.source))


@pytest.mark.thorough
def test_what_a_tolerance_smooths_is_told_and_what_is_larger_is_refused(tmp_path: Path) -> None:
    pieces = geometry(0.0, 0.0, 0.0, 0.0, 50.0) + geometry(50.0, 50.0, 0.3, 0.1, 50.0)
    text = opendrive(road("1", pieces, 100.0))
    (told,) = with_road(tmp_path / "a", ", tolerance: {step: 50 cm, kink: 10 deg}", text)
    assert told.startswith("own.xodr: smoothed over")
    for source in ("", ", tolerance: {step: 50 cm}", ", tolerance: {step: 20 cm, kink: 10 deg}"):
        with pytest.raises(DseError, match=r"(begins|continues) .*(m off|kink)"):
            with_road(tmp_path / "b", source, text)
    with pytest.raises(DseError, match="'step' of 'tolerance' is not between 0 and 2"):
        with_road(tmp_path / "c", ", tolerance: {step: 3 m}", text)


def test_signs_without_effect_and_ways_that_end_in_a_junction_are_told(tmp_path: Path) -> None:
    attributes = 'id="s" s="9" t="-4" orientation="+" dynamic="no" country="JP" type="323" unit="km/h"'
    sign = f"<signals><signal {attributes}/></signals>"
    line = geometry(0.0, 0.0, 0.0, 0.0, 100.0)
    one = road("1", line, 100.0, section(0.0, "", lane(-1)), link=to_junction("successor", "9"), more=sign)
    told = with_road(tmp_path, "", opendrive(one, '<junction id="9" name=""/>'))
    assert told == (
        "own.xodr: the sign '323' of JP has the unit of a speed, and is no known speed sign: it is ignored",
        "own.xodr: the way ends at junction '9': no connection leads on from lane -1 of road '1'",
    )
