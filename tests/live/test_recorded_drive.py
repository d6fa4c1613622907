"""A drive made again from a table gives the bits of the run that somebody drove."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from port_workspaces import c_part, write

from dse.domain.bench import TestBench
from dse.domain.component import Causality, Component, CSource, Interface, Kind, Port, Type
from dse.domain.design import Configuration, Connection
from dse.domain.drive import Drive, Pace
from dse.domain.run import Run, RunRequest, Waveforms
from dse.errors import DseError
from dse.live.driver_in_the_loop import DriverInTheLoop, driver_of, prepare_driver, tunables_of, with_driver
from dse.live.recorded_drive import bench_of_drive
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.prepare import prepare_bench
from dse.testbench.prepared_bench import PreparedBench
from dse.testbench.runner import Runner
from dse.units import parse_unit

INTERFACES = """\
interfaces:
  driver: {outputs: {accelerator: "1", steering: rad, cruise: bool, gap: "enum[long, short]"}}
  sink:
    inputs: {accelerator: "1", steering: rad, cruise: bool, gap: "enum[long, short]"}
    outputs: {speed: m/s, heading: rad}
  echo: {inputs: {speed: m/s}, outputs: {speed_before: m/s}}
"""
CONTROLS = "double accelerator, steering; bool cruise; int32_t gap;"
HANDS = {
    name: text.replace("implements: hands", "implements: driver")
    for name, text in c_part("hands", f"struct {{ {CONTROLS} }} out;", "").items()
}
CAR = c_part(
    "sink",
    f"struct {{ {CONTROLS} }} in;"
    "struct { double speed, heading; } out; struct { double gain; double lags[2]; } par;",
    """
    s->out.speed += 0.1 * s->par.gain * s->in.accelerator - (s->in.cruise ? 0.013 : 0.2 / (1 + s->in.gap));
    s->out.heading = 0.9 * s->out.heading + s->in.steering / (1 + s->par.lags[0] + s->par.lags[1]);
    """,
    parameters="parameters: {gain: {start: 1 1/s}, lags: {start: [1, 2], unit: s}}\n",
)
ECHO = c_part(
    "echo", "struct { double speed; } in; struct { double speed_before; } out;", "s->out.speed_before = s->in.speed;"
)
BENCH = """\
testbench: see
design: one
test_components: {{hands: {{component: hands}}, echo: {{component: echo}}}}
connections:
  - hands.accelerator -> sink.accelerator
  - hands.steering -> sink.steering
  - hands.cruise -> sink.cruise
  - hands.gap -> sink.gap
  - sink.speed -> echo.speed
parameters: {{sink.gain: 3, "sink.lags[2]": 0.125}}
simulation:
  {{stop: 2 s, step: 10 ms, algorithm: {algorithm}, record: [sink.speed, sink.heading, echo.speed_before]}}
metrics: {{way: mean(sink.speed)}}
"""
SCRIPT = """\
    double seen = s->in.speed;
    s->out.accelerator = seen < 1 ? 1.0 : 0.1 * (s->k % 7) / 3;
    s->out.steering = s->k % 11 < 6 ? -0.0 : 0.01 * s->k - seen / 7;
    s->out.cruise = s->k / 13 % 2;
    s->out.gap = s->k > 50;
    s->out.tune.sink.gain = 3 + (s->k > 100 ? seen / 3 : 0);
    s->out.tune.sink.lags[0] = 1; s->out.tune.sink.lags[1] = s->k < 77 ? 0.125 : 0.3;
"""


@pytest.fixture(params=["jacobi", "gauss_seidel"])
def bench(tmp_path: Path, request: pytest.FixtureRequest) -> TestBench:
    one = "design: one\nroot: {compound: {sink: sink}}\n"
    text = BENCH.format(algorithm=request.param)
    files = {"components/interfaces.yaml": INTERFACES, "designs/one.yaml": one, "testbenches/see.yaml": text}
    return Workspace(write(tmp_path, {**files, **HANDS, **CAR, **ECHO})).bench("see")


def only(bench: TestBench) -> Configuration:
    (configuration,) = open_space(bench.design).configurations()
    return configuration


def simulated(prepared: PreparedBench) -> Run:
    with Runner(prepared) as runner:
        return runner.run(RunRequest(0, prepared.configuration.id, {}), keep=True)


def columns(run: Run) -> Waveforms:
    assert run.waveforms is not None, run.problem
    return run.waveforms


def scripted(folder: Path, bench: TestBench) -> tuple[Component, list[str]]:
    """Somebody at the wheel who sees the car's speed, and what they tune."""
    tuned = list(tunables_of(bench, only(bench)))
    tune = "struct { struct { double gain, lags[2]; } sink; } tune;"
    part = c_part("seat", f"struct {{ double speed; }} in; struct {{ {CONTROLS} {tune} }} out;", SCRIPT)
    write(folder, part)
    here = folder / "components/seat"
    given = [Port(f"tune.{name}", Causality.OUTPUT, p.type) for name, p in tunables_of(bench, only(bench)).items()]
    seen = Port("speed", Causality.INPUT, Type(Kind.REAL, parse_unit("m/s")))
    interface = Interface("seat", (seen, *driver_of(bench).component.interface.ports, *given))
    source = CSource((here / "seat.c",), here / "seat.h", "seat", "seat_init", "seat_step", 0.01)
    return Component("seat", interface, source=source), tuned


def driven(folder: Path, bench: TestBench) -> tuple[Drive, Run]:
    """A live run without somebody outside, and what its seat put out."""
    component, tuned = scripted(folder, bench)
    seated = with_driver(bench, component, tuned)
    seated = replace(seated, direct=(*seated.direct, Connection("sink.speed", "hands.speed")))
    names = [port.name for port in component.interface.ports if port.causality is Causality.OUTPUT]
    record = (*bench.simulation.record, *(f"hands.{name}" for name in names))
    seated = replace(seated, simulation=replace(bench.simulation, record=record))
    ports = driver_of(bench).component.interface.ports
    driver_in_loop = DriverInTheLoop(
        seated, only(bench), "hands", ports, tunables_of(bench, only(bench)), ("sink.speed",)
    )
    run = simulated(prepare_driver(driver_in_loop))
    found = columns(run)
    inputs = {name: found.values[f"hands.{name}"] for name in names}
    pace = Pace(len(found.time) - 1, 0, 0.0, 0.0)
    return Drive("see", only(bench).id, "me", 0.01, found.time, inputs, pace), run


def again(drive: Drive, bench: TestBench, folder: Path) -> Run:
    made = bench_of_drive(drive, bench, only(bench), folder)
    return simulated(prepare_bench(made, [only(bench)])[only(bench).id])


@pytest.mark.thorough
def test_a_drive_made_again_gives_the_same_bits_with_all_that_was_tuned(bench: TestBench, tmp_path: Path) -> None:
    drive, live = driven(tmp_path, bench)
    offline = again(drive, bench, tmp_path / "tables")
    assert len(np.unique(drive.inputs["tune.sink.gain"])) > 20
    assert np.signbit(drive.inputs["steering"]).any()
    for name in bench.simulation.record:
        assert columns(offline).values[name].tobytes() == columns(live).values[name].tobytes(), name
    assert offline.metrics == live.metrics


def test_a_drive_that_ended_early_is_made_again_as_far_as_it_went(bench: TestBench, tmp_path: Path) -> None:
    drive, live = driven(tmp_path, bench)
    short = replace(drive, time=drive.time[:124], inputs={name: values[:124] for name, values in drive.inputs.items()})
    offline = columns(again(short, bench, tmp_path / "tables"))
    assert len(offline.time) == 124
    for name in bench.simulation.record:
        assert offline.values[name].tobytes() == columns(live).values[name][:124].tobytes(), name


def test_a_table_holds_what_changes_and_has_the_same_name_for_the_same_drive(bench: TestBench, tmp_path: Path) -> None:
    drive, _ = driven(tmp_path, bench)
    for _ in range(2):
        bench_of_drive(drive, bench, only(bench), tmp_path / "tables")
    (file,) = (tmp_path / "tables").iterdir()
    assert file.stat().st_size < 16_000


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda d: replace(d, bench="other"), "the drive was on the bench 'other', not on 'see'"),
        (lambda d: replace(d, configuration="abc"), "the drive was with abc, not with"),
        (lambda d: replace(d, step=0.02), r"the drive was made in steps of 0.02 s, not of 0.01 s"),
        (lambda d: replace(d, time=d.time[:1]), "has no step, or columns of different lengths"),
        (lambda d: replace(d, inputs={**d.inputs, "tune.sink.age": d.time}), "without a receiver, tune.sink.age"),
        (lambda d: replace(d, inputs={"cruise": d.inputs["cruise"]}), "does not give accelerator, gap, steering"),
    ],
)
def test_a_drive_of_something_else_is_refused(bench: TestBench, tmp_path: Path, change, what: str) -> None:
    time = np.arange(3) * 0.01
    inputs = {name: np.zeros(3) for name in ("accelerator", "steering", "cruise", "gap")}
    drive = Drive("see", only(bench).id, "me", 0.01, time, inputs, Pace(2, 0, 0.0, 0.0))
    with pytest.raises(DseError, match=what):
        bench_of_drive(change(drive), bench, only(bench), tmp_path / "tables")
