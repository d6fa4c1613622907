"""Generated code, Modelica, a stranger's FMU and C in one car: imported, probed, explored, reported, by the CLI."""

from __future__ import annotations

import csv
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess

import fmpy
import numpy as np
import pytest
from acc_texts import STEP, Acc, AccReplica, acc_files, sampled
from chromium import started_chromium
from coded_texts import scheduled, uncommented_rates
from command_line import run_dse
from reference_fmus.build import build as build_reference
from workspaces import written

from dse.kinds import SimulinkSource

_EXAMPLE = Path(__file__).parents[2] / "components"
_FOLDERS = (
    "AdasPowertrain",
    "brakes/friction_brake",
    "brakes/hydraulic_booster",
    "controllers/acc",
    "controllers/pd_acc",
    "powertrains/bev_single_speed",
    "powertrains/combustion_ideal",
    "powertrains/torque_source",
    "traffic/profile",
    "worlds/straight_road",
)

CODE = "AccControl_ert_rtw"
STRANGER = "ray_sensor"
"""Of the example, what is needed; generated code and an existing FMU lie beside it until they are imported."""

_DESIGN = """\
design: mixed
title: Cruise control, each part from another tool
root:
  compound:
    sensor: {alternatives: [ray_sensor, clean_sensor]}
    controller: {alternatives: [coded_acc, pd_acc]}
    brake: hydraulic_booster
    powertrain: {alternatives: [bev_single_speed, combustion_ideal]}
  connections:
    - sensor.target -> controller.target
    - controller.demand.drive_torque -> powertrain.torque_demand
    - controller.demand.brake_torque -> brake.torque_demand
"""
_BENCH = """\
testbench: following
title: Reach 70 km/h behind a car at 50 km/h
design: mixed
test_components:
  world:
    component: straight_road
    parameters: {initial_speed: 60 km/h, lead_speed: 50 km/h, initial_gap: 100 m}
connections:
  - world.scene.range -> sensor.scene.range
  - world.scene.closing_speed -> sensor.scene.closing_speed
  - world.scene.hit -> sensor.scene.hit
  - world.speed -> controller.speed
  - world.wheel_speed -> powertrain.wheel_speed
  - world.wheel_speed -> brake.wheel_speed
  - powertrain.wheels -> world.wheels
  - brake.torque -> world.brake
  - controller.mode -> world.status.mode
parameters:
  controller.set_speed: 70 km/h
  controller.set_gap: 40 m
simulation:
  stop: 21 s
  step: 10 ms
  record: [sensor.target, world.speed, controller.demand, controller.mode, controller.reference, world.gap]
metrics:
  gap_undershoot: {title: Gap undershoot, expression: "undershoot(world.gap, target = controller.set_gap)", unit: "%"}
  final_speed: {title: Speed at the end, expression: final(world.speed), unit: km/h}
requirements:
  R1: {title: gap kept, metric: gap_undershoot, at_most: 1 %}
figures:
  gap: {title: Distance, current: world.gap, target: controller.reference.gap, unit: m}
"""
_STUDY = """\
study: gains
title: Gains of the coded controller
testbench: following
configurations:
  where: controller is coded_acc and sensor is ray_sensor and powertrain is bev_single_speed
design_variables:
  controller.kp_speed: {range: [0.4, 2.4], levels: 3, title: speed P gain}
  controller.kp_gap: {range: [0.05, 0.3], levels: 3}
sampler: full_factorial
keep_waveforms: all
"""
# What a user writes who reads the FMU's list of variables.
_READER = """\
component: ray_sensor
implements: ray_reader
source: {kind: fmu, file: ray_sensor.fmu}
map:
  scene.range: Float64_continuous_input
  scene.closing_speed: Float64_discrete_input
  scene.hit: Boolean_input
  target.gap: Float64_continuous_output
  target.closing_speed: Float64_discrete_output
  target.detected: Boolean_output
"""
_CLEAN = {
    "interfaces.yaml": """\
interfaces:
  ray_reader:
    inputs: {scene: {range: m, closing_speed: m/s, hit: bool}}
    outputs: {target: {gap: m, closing_speed: m/s, detected: bool}}
""",
    "component.yaml": """\
component: clean_sensor
implements: ray_reader
source: {kind: c, files: [clean_sensor.c], header: clean_sensor.h, step: 10 ms}
""",
    "clean_sensor.h": """\
#pragma once
#include <stdbool.h>
typedef struct {
    struct { struct { double range, closing_speed; bool hit; } scene; } in;
    struct { struct { double gap, closing_speed; bool detected; } target; } out;
} clean_sensor;
void clean_sensor_init(clean_sensor *self);
void clean_sensor_step(clean_sensor *self);
""",
    "clean_sensor.c": """\
#include "clean_sensor.h"
void clean_sensor_init(clean_sensor *self) { clean_sensor_step(self); }
void clean_sensor_step(clean_sensor *self) {
    self->out.target.gap = self->in.scene.range;
    self->out.target.closing_speed = self->in.scene.closing_speed;
    self->out.target.detected = self->in.scene.hit;
}
""",
}


def lay_out(folder: Path) -> Path:
    """The workspace, without what is to be imported: the code lies in CODE, the design has its place already."""
    for name in _FOLDERS:
        shutil.copytree(_EXAMPLE / name, folder / "components" / name)
    shutil.copy(_EXAMPLE / "interfaces.yaml", folder / "components")
    texts = {
        "designs/mixed.yaml": _DESIGN,
        "testbenches/following.yaml": _BENCH,
        "testbenches/gains.pet.yaml": _STUDY,
        **{f"components/clean_sensor/{name}": text for name, text in _CLEAN.items()},
        **{f"{CODE}/{name}": text for name, text in acc_files().items()},
    }
    return written(folder, texts)


def map_the_stranger(folder: Path) -> None:
    """Write what its variables mean, in place of what its import has written."""
    imported = folder / "components" / STRANGER
    (imported / "interfaces.yaml").unlink()
    (imported / "component.yaml").write_text(_READER, encoding="utf-8")


def bench_with(folder: Path, name: str, simulation: str) -> None:
    """The same bench with another line for its step."""
    text = (folder / "testbenches" / "following.yaml").read_text(encoding="utf-8")
    text = text.replace("testbench: following", f"testbench: {name}").replace("step: 10 ms", simulation)
    (folder / "testbenches" / f"{name}.yaml").write_text(text, encoding="utf-8")


pytest.importorskip("clang.cindex")

Dse = Callable[..., CompletedProcess[str]]
CODED = {"controller": "coded_acc", "sensor": "clean_sensor", "powertrain": "combustion_ideal"}
STUDIED = {"controller": "coded_acc", "sensor": "ray_sensor", "powertrain": "bev_single_speed"}
SET_SPEED, SET_GAP = 70 / 3.6, 40.0
INPUTS = ("sensor.target.gap", "sensor.target.closing_speed", "sensor.target.detected", "world.speed")
OUTPUTS = ("demand.drive_torque", "demand.brake_torque", "mode", "reference.speed", "reference.gap")


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory, built_before: Callable[[Path], Path]) -> Path:
    """With the code and the FMU imported as a user imports them."""
    folder = tmp_path_factory.mktemp("mixed")
    built_before(folder / "cache")
    lay_out(folder / "work")
    stranger = build_reference("Feedthrough", 2, "CoSimulation", folder)
    stranger.rename(folder / "work" / f"{STRANGER}.fmu")
    for arguments, said in (
        (
            ("simulink", CODE, "--name", "coded_acc", "--step", "20 ms"),
            "implements acc_controller, an interface of the workspace",
        ),
        (("fmu", f"{STRANGER}.fmu"), "an interface of its own"),
    ):
        done = run_dse(folder / "work", "import", *arguments, cache=folder / "cache")
        assert done.returncode == 0, done.stderr
        assert said in done.stdout
    map_the_stranger(folder / "work")
    return folder / "work"


@pytest.fixture
def dse(workspace: Path) -> Dse:
    def run(*arguments: str, fails: bool = False) -> CompletedProcess[str]:
        done = run_dse(workspace, *arguments, cache=workspace.parent / "cache")
        assert bool(done.returncode) == fails, done.stderr
        assert "Traceback" not in done.stderr
        return done

    return run


@pytest.fixture
def identity(dse: Dse) -> Callable[[dict[str, str]], str]:
    def find(choices: dict[str, str]) -> str:
        found = json.loads(dse("enumerate", "mixed", "--format", "json").stdout)
        (one,) = (each for each in found if choices.items() <= each["choices"].items())
        return str(one["id"])

    return find


def columns(path: Path) -> dict[str, np.ndarray]:
    """Waveforms by name, units left out."""
    with path.open(encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    values = np.array(rows, dtype=float).T
    return {name.partition(" [")[0]: column for name, column in zip(head, values, strict=True)}


def assert_is_its_replica(waves: dict[str, np.ndarray], replica: AccReplica, h: float) -> None:
    """The controller's recorded outputs are what the replica makes of its recorded inputs."""
    told = [(*now, SET_SPEED, SET_GAP) for now in zip(*(waves[name] for name in INPUTS), strict=True)]
    told = [(gap, closing, bool(seen), speed, a, b) for gap, closing, seen, speed, a, b in told]
    expected = np.array([vector(each) for each in sampled(replica, told, h)])
    found = np.array([waves[f"controller.{name}"] for name in OUTPUTS]).T
    assert len(found) > 100
    assert {0.0, 1.0} == set(found[1:, 2])  # it drives in both modes
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-12)


def vector(acc: Acc) -> tuple[float, ...]:
    return (acc.drive_torque, acc.brake_torque, acc.mode, acc.reference_speed, acc.reference_gap)


def test_gains_are_parameters_that_begin_with_what_the_code_has(workspace: Path) -> None:
    text = (workspace / "components/coded_acc/component.yaml").read_text(encoding="utf-8")
    assert 'kp_gap: {start: 0.12, unit: "1", title: kp_gap (AccControl/Gap Control/Gap P)}' in text
    assert "gap_setting: {start: fixed, enum: [fixed, long, short]" in text


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("simulation", "h", "every"),
    [
        ("step: 10 ms", 0.01, 1),
        pytest.param("step: 5 ms", 0.005, 1, marks=pytest.mark.thorough),
        pytest.param("step: 10 ms\n  steps: {controller: 20 ms}", 0.02, 2, marks=pytest.mark.thorough),
    ],
)
def test_in_the_loop_the_code_does_what_its_equations_say(
    simulation: str,
    h: float,
    every: int,
    workspace: Path,
    dse: Dse,
    identity: Callable[[dict[str, str]], str],
    tmp_path: Path,
) -> None:
    bench_with(workspace, "stepped", simulation)
    file = tmp_path / "waves.csv"
    dse("simulate", "stepped", "-c", identity(CODED), "--set", "controller.kp_gap=0.2", "-o", str(file))
    waves = {name: column[::every] for name, column in columns(file).items()}
    assert_is_its_replica(waves, AccReplica(kp_gap=0.2), h)


@pytest.mark.parametrize("simulation", ["step: 30 ms", "step: 10 ms\n  steps: {controller: 40 ms}"])
def test_a_step_the_code_does_not_fit_is_refused_by_its_name(
    simulation: str, workspace: Path, dse: Dse, identity: Callable[[dict[str, str]], str]
) -> None:
    bench_with(workspace, "uneven", simulation)
    said = dse("simulate", "uneven", "-c", identity(CODED), fails=True).stderr
    (workspace / "testbenches/uneven.yaml").unlink()
    assert "controller (coded_acc) samples every 0.02 s, no multiple of the step" in said


@pytest.mark.thorough
@pytest.mark.parametrize("h", [0.005, STEP, 0.03, 0.06])
def test_another_program_runs_the_code_at_its_own_hits_whatever_its_steps(h: float, dse: Dse, tmp_path: Path) -> None:
    fmu = dse("build", "coded_acc", "-o", str(tmp_path)).stdout
    assert "coded_acc" in fmu
    times = np.arange(200) * h
    kinds = [("target.gap", float), ("target.closing_speed", float), ("target.detected", bool)]
    kinds += [("speed", float), ("set_speed", float), ("set_gap", float)]
    rows = np.zeros(len(times), dtype=[("time", float), *kinds])
    rows["time"], rows["speed"] = times, 15 + 3 * np.sin(times)
    rows["target.gap"], rows["target.closing_speed"] = 50 - 2 * times, np.cos(times)
    rows["target.detected"] = times % 1.0 < 0.6
    rows["set_speed"], rows["set_gap"] = SET_SPEED, SET_GAP
    (file,) = tmp_path.glob("*.fmu")
    description = fmpy.read_model_description(file)
    known = {variable.name: variable.valueReference for variable in description.modelVariables}
    slave = fmpy.instantiate_fmu(fmpy.extract(str(file)), description, "CoSimulation")
    slave.setupExperiment(startTime=0.0)
    slave.enterInitializationMode()

    def tell(row: np.void) -> None:
        for name, kind in kinds:
            put = slave.setBoolean if kind is bool else slave.setReal
            put([known[name]], [row[name].item()])

    def outputs() -> tuple[float, ...]:
        reals = slave.getReal([known[name] for name in OUTPUTS if name != "mode"])
        (mode,) = slave.getInteger([known["mode"]])
        return (*reals[:2], float(mode), *reals[2:])

    tell(rows[0])
    slave.exitInitializationMode()
    found = [outputs()]
    for row in rows[:-1]:
        tell(row)
        slave.doStep(row["time"].item(), h)
        found.append(outputs())
    slave.terminate()
    slave.freeInstance()
    told = [tuple(row.item()[1:]) for row in rows]
    expected = np.array([vector(each) for each in sampled(AccReplica(), told, h)])
    np.testing.assert_allclose(np.array(found), expected, rtol=1e-12, atol=1e-12)


@pytest.mark.thorough
def test_every_part_is_checked_and_probed(dse: Dse) -> None:
    assert "ok: " in dse("check").stdout
    for told in json.loads(dse("probe", "coded_acc", STRANGER, "--format", "json").stdout):
        answers = told["answers"]
        assert {answers[each] for each in ("runs", "repeats", "resets", "renews", "coexists", "threads")} == {"yes"}


@pytest.mark.thorough
def test_fused_or_not_the_code_gives_the_same_bits(
    dse: Dse, identity: Callable[[dict[str, str]], str], tmp_path: Path
) -> None:
    mine = identity({**CODED, "powertrain": "bev_single_speed"})
    for name, more in (("plain", []), ("fused", ["--fuse"])):
        dse("simulate", "following", "-c", mine, "-o", str(tmp_path / f"{name}.csv"), *more)
    assert (tmp_path / "plain.csv").read_bytes() == (tmp_path / "fused.csv").read_bytes()


@pytest.mark.thorough
def test_what_cannot_be_fused_is_named(dse: Dse, identity: Callable[[dict[str, str]], str]) -> None:
    said = dse("simulate", "following", "-c", identity(STUDIED), "--fuse", fails=True).stderr
    assert "ray_sensor is an existing FMU, which cannot be fused" in said


@pytest.mark.thorough
def test_gains_of_the_code_are_explored_alike_by_one_worker_and_two_and_found_in_the_report(
    dse: Dse, tmp_path: Path
) -> None:
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder, workers in zip(folders, ("1", "2"), strict=True):
        dse("explore", "gains", "-o", str(folder), "--workers", workers)
    one, two = (dse("results", str(folder), "--format", "json").stdout for folder in folders)
    assert one == two
    runs = json.loads(one)["runs"]
    assert len(runs) == 9
    found = {tuple(run["point"].values()): run["metrics"]["gap_undershoot"] for run in runs}
    for place in (0, 1):  # each gain does something
        assert any(
            found[a] != found[b] for a in found for b in found if a[place] != b[place] and a[1 - place] == b[1 - place]
        )
    waves = [{p.name: p.read_bytes() for p in (folder / "waveforms").rglob("*") if p.is_file()} for folder in folders]
    assert waves[0] == waves[1]
    assert waves[0]
    dse("report", str(folders[0]))
    with started_chromium() as browser:
        page = browser.new_page()
        page.goto((folders[0] / "report.html").as_uri())
        page.wait_for_selector("select", state="attached")
        axes = page.locator("select option").all_text_contents()
        assert any("speed P gain" in axis for axis in axes)
        assert "kp_gap (AccControl/Gap Control/Gap P) [–]" in axes


def test_a_bench_knows_the_step_that_the_code_tells(tmp_path: Path) -> None:
    for name, text in scheduled().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert SimulinkSource(tmp_path).sample_time == 0.1
    for name, text in uncommented_rates().items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    assert SimulinkSource(tmp_path).sample_time is None
    steps = (("lag_step0", 0.02), ("lag_step1", 0.05))
    assert SimulinkSource(tmp_path, steps=steps).sample_time == 0.01
    (tmp_path / "lag.h").unlink()  # its build will say what is wrong
    assert SimulinkSource(tmp_path).sample_time is None
