"""Traffic by SUMO: where its vehicles are on our roads, that they mind the host, and how it fails."""

from __future__ import annotations

import json
import os
import shutil
import signal
import socket
import struct
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import replace
from importlib.metadata import PackageNotFoundError
from pathlib import Path
from typing import Any

import numpy as np
import psutil
import pytest
from sumo_here import needs_sumo

import dse
from dse.domain.component import Component
from dse.errors import DseError
from dse.fmu import build, open_fmu
from dse.kinds.sumo import KIND
from dse.loading import Workspace
from dse.world import RoadPath, lane_middle, open_roads, opendrive_text, place, road_tables
from dse.world.code import along_own_lane
from dse.world.pieces import value
from dse.world.sumo.lanes import _Feet, placed_lanes, sumo_lanes
from dse.world.sumo.resources import sumo_network, sumo_version

pytestmark = [needs_sumo, pytest.mark.usefixtures("kept_cache")]

ROOT = Path(__file__).parents[2]
DRIVE = Path(__file__).parent / "sumo_drive.py"
NAMES = (
    "id", "class", "length", "width", "height", "clearance", "path", "lane", "station", "offset", "turn", "speed",
    "lateral_speed", "acceleration",
)  # fmt: skip
H = 0.01
START = 330.0  # m, before the bend
ROAD = """\
road: bend
lanes: {{forward: {lanes}, backward: 0, width: 3.75 m}}
speed_limit: 100 km/h
segments:
  - straight: 400 m
  - {{curve: {{radius: 250 m, angle: 60 deg, spiral: 60 m, bank: 3 %}}, grade: 3 %, rounding: 2 km}}
  - straight: 800 m
"""


def on_a_bend(lanes: int, folder: Path) -> Component:
    """Our component, on another road."""
    file = folder / "roads" / "bend.yaml"
    file.parent.mkdir()
    file.write_text(ROAD.format(lanes=lanes), encoding="utf-8")
    ours = Workspace(ROOT).component("sumo_traffic")
    return replace(ours, source=replace(ours.source, file=file, inside=folder))


@pytest.fixture(scope="module")
def component(tmp_path_factory: pytest.TempPathFactory) -> Component:
    return on_a_bend(3, tmp_path_factory.mktemp("three"))


@pytest.fixture(scope="module")
def resources(component: Component, kept_cache: None) -> Path:
    return open_fmu(build(component)).folder / "resources"


@pytest.fixture(scope="module")
def path(component: Component) -> RoadPath:
    return path_of(component)


def path_of(component: Component) -> RoadPath:
    return road_tables(open_roads(str(component.source.file), Workspace(component.source.inside))).paths[0]


def starts(component: Component, **others: float) -> dict[str, float]:
    """The parameters' starts as SUMO gets them."""
    found = {}
    for each in component.parameters:
        found[each.name] = each.type.items.index(each.start) if each.type.items else float(each.start)
        if each.type.unit.symbol:
            found[each.name] *= float(each.type.unit.factor)
    return {**found, **others}


def driven(path: RoadPath, speeds: np.ndarray, start: float = START) -> list[dict[str, float]]:
    """Inputs of a host in the middle of its lane, which drives at *speeds*."""
    own = along_own_lane(path)
    table = np.linspace(0.0, path.length, 100_000)
    stations = start + np.concatenate([[0.0], np.cumsum(speeds * H)[:-1]])
    s = np.interp(stations, value(own, table), table)
    at = place(path, s, lane_middle(path, s))
    return [
        {"lane.station": station, "motion.x": x, "motion.y": y, "motion.heading": heading, "motion.speed": speed}
        for station, x, y, heading, speed in zip(stations, at.x, at.y, at.heading, speeds, strict=True)
    ]


def run(resources: Path, parameters: dict[str, float], inputs: list[dict[str, float]], h: float = H) -> dict[str, Any]:
    given = {"folder": str(resources), "parameters": parameters, "inputs": inputs, "h": h}
    done = subprocess.run(
        [sys.executable, str(DRIVE)], input=json.dumps(given), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr[-2000:]
    told = json.loads(done.stdout[done.stdout.index("{") :])
    rows = np.array(told["rows"]).reshape(len(told["rows"]), 8, len(NAMES))
    return {**told, **{name: rows[:, :, i] for i, name in enumerate(NAMES)}}


@pytest.fixture(scope="module")
def cruise(component: Component, resources: Path, path: RoadPath) -> dict[str, Any]:
    """The host goes into the bend at 80 km/h, in dense traffic."""
    parameters = starts(component, warm_up=25.0, flow=4000 / 3600, truck_share=0.3, speed_deviation=0.2)
    return run(resources, parameters, driven(path, np.full(1200, 22.0)))


def test_netconvert_reads_the_heights_of_our_roads_and_a_lane_above_a_path_is_not_of_it(
    component: Component, path: RoadPath, kept_cache: None
) -> None:
    text = opendrive_text(str(component.source.file), Workspace(component.source.inside))
    lanes = sumo_lanes(sumo_network(text, None, None))
    feet = _Feet(path)
    for lane in lanes:
        # netconvert gives all lanes the height of the reference line, whatever the bank.
        assert lane.heights == pytest.approx(value(path.height, feet.of(lane.points)[0]), abs=0.02)
    assert max(lane.heights.max() for lane in lanes) > 20
    assert placed_lanes(lanes, [path], None)["lanes"].keys() == {lane.name for lane in lanes}
    with pytest.raises(DseError, match="has no lanes along the path"):
        placed_lanes([replace(lane, heights=lane.heights + 8.0) for lane in lanes], [path], None)


def test_vehicles_are_where_sumo_has_them_but_for_the_chords_it_drives_on(
    cruise: dict[str, Any], path: RoadPath
) -> None:
    own = along_own_lane(path)
    table = np.linspace(0.0, path.length, 200_000)
    along = value(own, table)
    compared = 0
    for k, places in enumerate(cruise["places"]):
        for i, there in enumerate(places):
            if there is None or cruise["lane"][k + 1, i] != 0 or k % 20:
                continue
            front = cruise["station"][k + 1, i] + cruise["length"][k + 1, i] / 2
            s = np.interp([front], along, table)
            at = place(path, s, lane_middle(path, s) + cruise["offset"][k + 1, i])
            assert np.hypot(at.x[0] - there[0], at.y[0] - there[1]) <= 2e-3
            compared += 1
    assert compared > 50


def test_the_points_of_lanes_agree_to_a_millimetre(resources: Path, path: RoadPath) -> None:
    own = along_own_lane(path)
    table = np.linspace(0.0, path.length, 200_000)
    lanes = json.loads((resources / "lanes.json").read_text("utf-8"))["lanes"]
    assert {lane["lane"] for lane in lanes.values()} == {0, 1, 2}
    for lane in lanes.values():
        station, offset, x, y = np.array(lane["knots"]).T
        s = np.interp(station, value(own, table), table)
        at = place(path, s, lane_middle(path, s, lane["lane"]))
        assert np.abs(offset).max() <= 1e-3
        assert np.hypot(at.x - x, at.y - y).max() <= 1e-3


def test_nobody_jumps(cruise: dict[str, Any], path: RoadPath) -> None:
    same = (cruise["id"][1:] == cruise["id"][:-1]) & (cruise["id"][1:] > 0)
    speed, turn = cruise["speed"], cruise["turn"]
    gone = np.diff(cruise["station"], axis=0)
    # SUMO moves on by the speed at the end of a step, on the lane from which stations are counted.
    assert np.abs(gone - (speed * np.cos(turn))[1:] * H)[same].max() < 2e-3
    aside = np.diff(cruise["offset"] + 3.75 * cruise["lane"], axis=0)
    assert np.abs(aside)[same].max() < 0.03
    assert (np.abs(turn)[cruise["id"] > 0] < 0.2).all()
    assert (np.abs(aside)[same] > 1e-3).any(), "nobody changed lanes"


def test_who_is_told_of_is_a_vehicle_with_sizes_and_a_number_of_its_own(cruise: dict[str, Any]) -> None:
    there = cruise["id"] > 0
    assert there.mean() > 0.9
    assert set(np.unique(cruise["class"][there])) <= {1, 2, 3}
    assert set(np.unique(cruise["length"][there])) <= {4.5, 12.0, 2.2}
    for numbers, present in zip(cruise["id"], there, strict=True):
        assert len(set(numbers[present])) == present.sum()


@pytest.mark.thorough
def test_who_drives_behind_brakes_for_the_host(tmp_path: Path) -> None:
    component = on_a_bend(1, tmp_path)
    resources = open_fmu(build(component)).folder / "resources"
    speeds = np.clip(22.0 - 5.0 * H * np.arange(2600), 0.0, None)
    inputs = driven(path_of(component), speeds)
    parameters = starts(component, warm_up=20.0, flow=1500 / 3600)
    gaps = {}
    for minds in (1.0, 0.0):
        seen = run(resources, {**parameters, "minds_host": minds}, inputs)
        host = np.array([each["lane.station"] for each in inputs])
        front = seen["station"][1:] + seen["length"][1:] / 2
        behind = (seen["id"][1:] > 0) & (seen["lane"][1:] == 0) & (np.abs(seen["offset"][1:]) < 1.0)
        gap = (host - 2.3)[:, None] - front
        gaps[minds] = np.where(behind & (gap > -4.6), gap, np.inf)
    assert 2.0 < gaps[1.0].min() < 3.0  # minGap of SUMO is 2.5 m
    assert gaps[0.0].min() < 0.0, "without minding it, somebody would have driven through the host"


@pytest.mark.thorough
def test_another_road_than_the_hosts_is_told(component: Component, resources: Path, path: RoadPath) -> None:
    inputs = driven(path, np.full(3, 20.0))
    moved = [{**each, "motion.x": each["motion.x"] + 30.0} for each in inputs]
    told = run(resources, starts(component, warm_up=0.0), moved)["error"]
    assert "road and traffic must name the same file and way" in told
    told = run(resources, starts(component, warm_up=0.0), inputs, h=0.015)["error"]
    assert (
        told == "a step of 0.015 s is not a multiple of SUMO's, which is 0.01 s: give 'step' in the component's source"
    )


class Partner:
    """The process beside a run, as the FMU's library has it."""

    def __init__(self, resources: Path) -> None:
        self.line, theirs = socket.socketpair()
        heard, self.life = os.pipe()
        command = [sys.executable, "-P", "-m", "dse.world.sumo.partner", str(resources)]
        self.process = subprocess.Popen(command, stdin=theirs, stdout=heard, start_new_session=True)
        theirs.close()
        os.close(heard)

    def ask(self, kind: int, *numbers: float) -> list[float] | str:
        self.line.sendall(struct.pack(f"=II{len(numbers)}d", kind, len(numbers), *numbers))
        is_text, count = struct.unpack("=II", self._read(8))
        return self._read(count).decode() if is_text else list(struct.unpack(f"={count}d", self._read(8 * count)))

    def _read(self, size: int) -> bytes:
        return self.line.recv(size, socket.MSG_WAITALL)

    def end(self) -> int:
        os.close(self.life)
        self.line.close()
        return self.process.wait(60)


@pytest.fixture
def partner(resources: Path) -> Iterator[Partner]:
    found = Partner(resources)
    yield found
    if found.process.poll() is None:
        found.end()


START_IT, STEP = 0, 1


def asked(component: Component, resources: Path, inputs: dict[str, float], h: float, **others: float) -> list[float]:
    told = json.loads((resources / "lanes.json").read_text("utf-8"))
    values = starts(component, warm_up=1.0, **others)
    return [h, *(values[name] for name in told["parameters"]), *(inputs.get(name, 0.0) for name in told["inputs"])]


def test_a_sumo_that_dies_is_told_and_the_next_run_is_made(
    component: Component, resources: Path, path: RoadPath, partner: Partner
) -> None:
    (inputs,) = driven(path, np.full(1, 20.0))
    begin, step = (asked(component, resources, inputs, h) for h in (0.0, H))
    whole = partner.ask(START_IT, *begin), partner.ask(STEP, *step)
    assert all(isinstance(each, list) and len(each) == 8 * len(NAMES) for each in whole)
    newest = max(psutil.Process(partner.process.pid).children(recursive=True), key=lambda each: each.pid)
    newest.kill()
    assert partner.ask(STEP, *step) == "SUMO has crashed (SIGKILL)"
    again = partner.ask(START_IT, *begin), partner.ask(STEP, *step)
    assert again == whole


@pytest.mark.thorough
def test_a_sumo_that_hangs_ends_with_the_process_that_started_it(
    component: Component, resources: Path, path: RoadPath, partner: Partner
) -> None:
    (inputs,) = driven(path, np.full(1, 20.0))
    partner.ask(START_IT, *asked(component, resources, inputs, 0.0))
    all_of_them = psutil.Process(partner.process.pid).children(recursive=True)
    assert len(all_of_them) == 2
    all_of_them[-1].suspend()
    all_of_them[-1].resume()
    assert partner.end() == -signal.SIGIO
    _, left = psutil.wait_procs(all_of_them, timeout=60)
    assert left == []


@pytest.mark.thorough
def test_what_sumo_says_of_a_demand_is_what_a_run_says(component: Component, tmp_path: Path, path: RoadPath) -> None:
    demand = tmp_path / "mine.rou.xml"
    demand.write_text('<routes><flow id="f" begin="0" end="9" number="3" from="nowhere" to="else"/></routes>')
    model = open_fmu(build(replace(component, source=replace(component.source, demand=demand))))
    begun = Partner(model.folder / "resources")
    (inputs,) = driven(path, np.full(1, 20.0))
    told = begun.ask(START_IT, *asked(component, model.folder / "resources", inputs, 0.0))
    begun.end()
    assert isinstance(told, str)
    assert "nowhere" in told


def test_a_demand_with_entities_or_of_another_kind_is_refused(component: Component, tmp_path: Path) -> None:
    demand = tmp_path / "mine.rou.xml"
    source = replace(component.source, demand=demand)
    demand.write_text('<!DOCTYPE routes [<!ENTITY a "b">]><routes>&a;</routes>')
    with pytest.raises(DseError, match=r"mine\.rou\.xml"):
        KIND.check(component, source)
    demand.write_text("<configuration/>")
    with pytest.raises(DseError, match="is not a demand of SUMO"):
        KIND.check(component, source)


def test_lights_are_refused_as_sumo_would_not_know_what_they_show(component: Component) -> None:
    source = replace(component.source, file=ROOT / "roads" / "intersection.yaml", inside=ROOT)
    with pytest.raises(DseError, match="the road has traffic lights"):
        build(replace(component, source=source))


def test_what_netconvert_cannot_read_is_told(tmp_path: Path) -> None:
    with pytest.raises(DseError, match="SUMO's netconvert cannot read the road: "):
        sumo_network(b"<OpenDRIVE><road", None, tmp_path)


def test_parameters_that_are_missing_or_unknown_are_named(component: Component) -> None:
    first, *others = component.parameters
    with pytest.raises(DseError, match=f"also needs '{first.name}'"):
        KIND.check(replace(component, parameters=tuple(others)), component.source)
    with pytest.raises(DseError, match="has no parameter 'speeed'"):
        KIND.check(
            replace(component, parameters=(*component.parameters, replace(first, name="speeed"))), component.source
        )


def test_without_sumo_the_extra_is_named_and_a_check_goes_on(
    component: Component, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> str:
        raise PackageNotFoundError(name)

    monkeypatch.setattr("importlib.metadata.version", missing)
    with pytest.raises(DseError, match="needs the package 'eclipse-sumo', which is not installed") as caught:
        sumo_version(None)
    assert caught.value.problems[0].hint == "run: pip install 'dse-workbench[traffic]'"
    assert [problem.hint for problem in KIND.check(component, component.source)] == [caught.value.problems[0].hint]


BENCH = """\
testbench: among_others
title: A car that keeps its lane in SUMO's traffic
design: among_others
test_components:
  traffic: {component: sumo_traffic, parameters: {warm_up: 30 s, flow: 3000}}
connections:
  - traffic.movers -> road.movers
  - road.lane -> traffic.lane
  - car.motion -> traffic.motion
parameters:
  road.start_station: 300 m
  car.initial_speed: 100 km/h
  car.wheels.front: 150 N.m
  car.wheels.rear: 0 N.m
  car.brake.front: 0 N.m
  car.brake.rear: 0 N.m
simulation: {stop: 5 s, step: 10 ms, algorithm: gauss_seidel, record: [road.actors]}
metrics:
  first: {title: Where the first is at last, expression: "final(road.actors[1].ahead)", unit: m}
  last: {title: How fast the last is in the mean, expression: "mean(road.actors[8].speed)", unit: m/s}
"""
DESIGN = """\
design: among_others
title: Cars that are not told of the others
root:
  compound:
    car: {alternatives: [single_track]}
    lateral: {alternatives: [pure_pursuit]}
    eye: {alternatives: [object_radar_long, object_lidar]}
    road: {alternatives: [road_motorway]}
  connections:
    - road.ground -> car.ground
    - road.start -> car.start
    - car.motion -> road.motion
    - car.contacts -> road.contacts
    - car.motion -> lateral.motion
    - road.lane -> lateral.lane
    - road.preview -> lateral.preview
    - lateral.steering -> car.steering
    - car.motion -> eye.motion
    - road.actors -> eye.actors
"""
STUDY = """\
study: seeds
title: The same traffic for all
testbench: among_others
conditions:
  traffic.seed: {values: [1, 2, 3]}
"""


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("sumo")
    for name in ("components", "roads"):
        shutil.copytree(ROOT / name, folder / name)
    for name, text in {"designs/among_others.yaml": DESIGN, "testbenches/among_others.yaml": BENCH,
                       "testbenches/seeds.pet.yaml": STUDY}.items():  # fmt: skip
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    return folder


@pytest.mark.thorough
def test_a_bench_that_fuses_refuses_it_by_name(workspace: Path) -> None:
    bench = dse.open(workspace).benches["among_others"]
    with pytest.raises(DseError, match=r"traffic: .* has a process of its own do its work"):
        bench.simulate(bench.design.list(1)[0], fuse=True)


def actors(run: Any) -> np.ndarray:
    return np.column_stack([run.waveforms[name] for name in sorted(run.waveforms) if name.startswith("road.actors")])


@pytest.mark.thorough
def test_the_bits_are_the_same_whoever_makes_the_runs(workspace: Path, tmp_path: Path) -> None:
    """In any worker, one after the other or two at once, in a sandbox, and whoever else takes part."""
    study = dse.open(workspace).studies["seeds"]
    tables = [
        study.explore(tmp_path / str(number), workers=number, fresh=True, sandbox=number == 2).to_pandas()
        for number in (1, 2)
    ]
    for name in ("first", "last"):
        assert tables[0][name].to_numpy().tobytes() == tables[1][name].to_numpy().tobytes()
        assert np.isfinite(tables[0][name]).all()
    ends = tables[0].groupby("configuration")["first"].apply(lambda values: values.to_numpy().tobytes())
    assert len(ends) == 2, "there are two sensors to choose"
    assert len(set(ends)) == 1, "the sensor has changed the traffic"
    assert len(set(tables[0]["first"])) == 3, "seeds change nothing"
