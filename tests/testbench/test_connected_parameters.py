"""A connection may end at a tunable parameter: it is given its value in every step, as an input is."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from port_workspaces import bench, c_part, columns, run, write
from reference_fmus import build

from dse.api.studies.single_run import write_package
from dse.domain.run import RunRequest
from dse.errors import DseError
from dse.interchange.importing.component import import_component
from dse.loading.workspace import Workspace
from dse.space.space import open_space
from dse.testbench.check import check_workspace
from dse.testbench.runner import Runner
from dse.testbench.study import bench_study, prepare_study

INTERFACES = """\
interfaces:
  seat: {outputs: {gain: 1/s, rank: int, on: bool, gear: "enum[low, high]", gains: "1/s[2]", length: m, share: "1"}}
  sink: {outputs: {y: "1", z: "1"}}
"""
SEAT = c_part(
    "seat",
    "struct { double gain; int32_t rank; bool on; int32_t gear; double gains[2]; double length, share; } out;"
    "struct { double slope; } par;",
    """
    s->out.gain = 1.5 + s->par.slope * s->k; s->out.rank = 3; s->out.on = true; s->out.gear = 1;
    s->out.gains[0] = 0.25; s->out.gains[1] = 0.3; s->out.share = 0.25;
    """,
    parameters="parameters: {slope: {start: 0}}\n",
)
SINK_PARAMETERS = """\
parameters:
  gain: {start: 1 1/s, min: 0, max: 1000}
  rank: {start: 1, type: int}
  on: {start: false}
  gear: {start: low, enum: [low, high]}
  gains: {start: [1, 1], unit: 1/s}
  set_once: {start: 1 1/s, tunable: false}
"""
SINK = c_part(
    "sink",
    "struct { double y, z; } out;"
    "struct { double gain; int32_t rank; bool on; int32_t gear; double gains[2]; double set_once; } par; double first;",
    """
    s->out.y += 0.1 * s->par.gain * (s->par.on ? s->par.rank : -1) + 1e-3 * s->par.gear;
    s->out.z = s->par.gains[0] / 3 + s->par.gains[1] * s->par.gain;
    """,
    parameters=SINK_PARAMETERS,
)
ALL = ", ".join(f"seat.{name} -> sink.{name}" for name in ("gain", "rank", "on", "gear", "gains"))
VALUES = "parameters: {sink.gain: 1.5, sink.rank: 3, sink.on: true, sink.gear: high, sink.gains: [0.25, 0.3]}\n"
RECORD = "sink.y, sink.z"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    return write(tmp_path, {"components/interfaces.yaml": INTERFACES, **SEAT, **SINK, **wired(ALL)})


def wired(connections: str, more: str = "", parts: str = "seat: {component: seat}") -> dict[str, str]:
    return bench(connections, RECORD, parts=parts, more=more)


def told(root: Path) -> str:
    problems, _ = check_workspace(Workspace(root))
    return "\n".join(map(str, problems))


@pytest.mark.parametrize("version", [2, 3])
def test_a_constant_on_a_wire_gives_the_bits_of_the_same_start_value(root: Path, version: int) -> None:
    found = columns(root, version=version)
    write(root, wired("", VALUES))
    expected = columns(root, version=version)
    assert expected["sink.y"][-1] > 9
    assert {name: values.tobytes() for name, values in found.items()} == {
        name: values.tobytes() for name, values in expected.items()
    }


@pytest.mark.parametrize("version", [2, 3])
def test_a_parameter_follows_what_is_wired_to_it_a_step_behind(root: Path, version: int) -> None:
    write(root, wired("seat.gain -> sink.gain", "parameters: {seat.slope: 2, sink.gains: [0, 1]}\n"))
    found = columns(root, version=version)["sink.z"]
    assert np.array_equal(found, 1.5 + 2.0 * np.maximum(np.arange(21) - 1, 0))


def test_a_fused_loop_tunes_parameters_to_the_same_bits(root: Path) -> None:
    write(root, wired(ALL, "parameters: {seat.slope: 2}\n"))
    study = prepare_study(bench_study(Workspace(root).bench("see")), fuse=True)
    ((identity, prepared),) = study.benches.items()
    assert prepared.fused is not None
    with Runner(prepared) as runner:
        fused = runner.run(RunRequest(0, identity, {}), keep=True)
    assert fused.waveforms is not None
    plain = columns(root)
    assert all(np.array_equal(fused.waveforms.values[name], values) for name, values in plain.items())


@pytest.mark.parametrize(
    ("connection", "what", "hint"),
    [
        ("seat.length -> sink.gain", "units differ: m and 1/s", "connect seat.gain"),
        ("seat.rank -> sink.gain", "types differ: int and 1/s", "connect seat.gain"),
        ("seat.gain -> sink.set_once", "the parameter 'set_once' of sink is not tunable", "give this one a value"),
        ("sink.gain -> sink.gain", "sink (sink) has no port 'gain'", "it is a parameter: connections can end there"),
        ("seat.gain -> sink.gian", "sink (sink) has no port 'gian'", ""),
        ("seat.gain -> sink.gains", "shapes differ", ""),
        ("seat.gain -> sink.gain, seat.gain -> sink.gain", "sink.gain has a source already", "the other is"),
    ],
)
def test_what_cannot_end_at_a_parameter_is_told_where_it_stands(
    root: Path, connection: str, what: str, hint: str
) -> None:
    write(root, wired(connection))
    found = told(root)
    assert what in found
    assert hint in found
    assert "testbenches/see.yaml:4:" in found


def test_a_parameter_has_a_value_or_a_source(root: Path) -> None:
    write(root, wired(ALL, "parameters: {sink.gain: 2}\n"))
    assert "sink.gain is given a value and connected to seat.gain" in told(root)


def test_a_parameter_that_is_connected_is_no_setting_of_a_run(root: Path) -> None:
    tested = Workspace(root).bench("see")
    (prepared,) = prepare_study(bench_study(tested)).benches.values()
    assert "sink.set_once" in prepared.settings
    assert "sink.gain" not in prepared.settings


def test_a_design_wires_parameters_that_all_alternatives_have(root: Path) -> None:
    other = c_part(
        "other",
        "struct { double y, z; } out; struct { double rank; } par;",
        "",
        parameters="parameters: {rank: {start: 1}}\n",
    )
    other = {name: text.replace("implements: other", "implements: sink") for name, text in other.items()}
    design = "design: two\nroot:\n  compound: {sink: {alternatives: [sink, other]}, seat: seat}\n"
    design += "  connections: [seat.gain -> sink.gain]\n"
    write(root, {**other, "designs/two.yaml": design})
    assert "sink (sink) has no port 'gain'" in told(root)
    write(root, {"designs/two.yaml": design.replace("[sink, other]", "[sink]")})
    assert told(root) == ""


MODEL = """\
model Mixer
  parameter Real gain(unit = "1/s") = 1;
  parameter Real doubled = 2*gain;
  output Real y;
  output Real z(start = 0, fixed = true);
equation
  y = doubled;
  der(z) = gain;
end Mixer;
"""


@pytest.mark.parametrize("version", [2, 3])
def test_parameters_of_a_modelica_model_are_tuned_with_what_is_calculated_of_them(root: Path, version: int) -> None:
    files = {
        "components/sink/component.yaml": "component: sink\nimplements: sink\n"
        "source: {kind: modelica, model: Mixer, files: [Mixer.mo]}\nparameters: {gain: {start: 1 1/s}}\n",
        "components/sink/Mixer.mo": MODEL,
    }
    write(root, {**files, **wired("seat.gain -> sink.gain", "parameters: {seat.slope: 2}\n")})
    found = columns(root, version=version)
    k = np.maximum(np.arange(21) - 1, 0)
    assert np.allclose(found["sink.y"], 2 * (1.5 + 2 * k), rtol=1e-12)
    study = prepare_study(bench_study(Workspace(root).bench("see")), fuse=True)
    ((identity, prepared),) = study.benches.items()
    with Runner(prepared) as runner:
        fused = runner.run(RunRequest(0, identity, {}), keep=True)
    assert fused.waveforms is not None
    if version == 2:
        assert all(np.array_equal(fused.waveforms.values[name], values) for name, values in found.items())


@pytest.mark.parametrize(("version", "kind"), [(2, "CoSimulation"), (3, "CoSimulation"), (2, "ModelExchange")])
def test_a_tunable_parameter_of_an_fmu_of_others_is_given_its_value(
    root: Path, tmp_path: Path, version: int, kind: str
) -> None:
    import_component(build("BouncingBall", version, kind, tmp_path), root, "ball")
    parts = "seat: {component: seat}, ball: {component: ball}"
    several = "simulation: {stop: 1 s, step: 10 ms, record: [ball.h]}\n"

    def heights(connections: str, more: str = "") -> bytes:
        text = bench(connections, "ball.h", parts=parts, more=more)
        old = text["testbenches/see.yaml"]
        lines = [line for line in old.splitlines(keepends=True) if not line.startswith("simulation")]
        write(root, {**text, "testbenches/see.yaml": "".join(lines) + several})
        return columns(root)["ball.h"].tobytes()

    given = heights("", "parameters: {ball.e: 0.25}\n")
    assert heights("seat.share -> ball.e") == given
    assert heights("") != given


@pytest.mark.parametrize("version", [2, 3])
def test_a_fixed_parameter_of_an_fmu_of_others_is_refused_by_name(root: Path, tmp_path: Path, version: int) -> None:
    import_component(build("VanDerPol", version, None, tmp_path), root, "theirs")
    parts = "seat: {component: seat}, theirs: {component: theirs}"
    write(root, bench("seat.share -> theirs.mu", "theirs.x0", parts=parts))
    assert "the parameter 'mu' of theirs is not tunable" in told(root)
    yaml = root / "components/theirs/component.yaml"
    yaml.write_text(yaml.read_text(encoding="utf-8").replace("tunable: false", "tunable: true"), encoding="utf-8")
    with pytest.raises(DseError, match="'mu' in the FMU of theirs is fixed, not tunable"):
        run(root, version=version)


def test_no_package_holds_a_wire_to_a_parameter(root: Path, tmp_path: Path) -> None:
    tested = Workspace(root).bench("see")
    (configuration,) = open_space(tested.design).configurations()
    with pytest.raises(DseError, match=r"sink\.gain.*SSP"):
        write_package(tested, configuration.id, {}, tmp_path / "x.ssp")
