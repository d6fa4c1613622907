"""A simulated part is fed with a series: known at every communication point, and coupled as any other output.

The speed of the ramp is 3 t in m/s for 2 s, so that the exact distance is 6 m. An input that is held over steps h gives
the left Riemann sum, 3 h^2 n (n - 1) / 2; one that is extrapolated misses the exact value by the first step alone, for
which only one value is known: 3 h^2 / 2.
"""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from series.workspace import lay_out

import dse
from dse.fmu.component_build import build
from dse.testing.kinds import the_component

RAMP = "t,v [m/s]\n0,0\n2,6\n"
H, N = 0.1, 20
HELD = 3 * H**2 * N * (N - 1) / 2
EXTRAPOLATED = 6 - 3 * H**2 / 2


def simulated(root: Path, **options) -> dse.Run:
    run = dse.open(root).benches["fed"].simulate(**options)
    assert run.is_done, run.problem
    return run


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("method", "distance"),
    [
        ("", HELD),
        pytest.param(", extrapolation: linear", EXTRAPOLATED, marks=pytest.mark.thorough),
        pytest.param(", algorithm: gauss_seidel", 3 * H**2 * N * (N + 1) / 2, marks=pytest.mark.thorough),
        pytest.param(", steps: {part: 25 ms}", HELD, marks=pytest.mark.thorough),
        pytest.param(", steps: {part: 400 ms}", 3 * 0.4**2 * 5 * 4 / 2, marks=pytest.mark.thorough),
        pytest.param(", steps: {inputs: 25 ms}", HELD, marks=pytest.mark.thorough),
        pytest.param(", coupling: propagate", HELD, marks=pytest.mark.thorough),
    ],
)
def test_a_ramp_is_integrated_as_the_coupling_says(tmp_path, method, distance):
    run = simulated(lay_out(tmp_path, "file: ramp.csv, column: v", method=method, ramp__csv=RAMP))
    assert run.metrics["distance"] == pytest.approx(distance, rel=1e-14)
    assert run.metrics["fed"] == pytest.approx(6, rel=1e-14)


@pytest.mark.thorough
def test_adaptive_steps_bring_the_integral_near_the_exact_one(tmp_path):
    method = ", adaptive: {tolerance: 1e-3, absolute: 1e-3}"
    run = simulated(lay_out(tmp_path, "file: ramp.csv, column: v", method=method, ramp__csv=RAMP))
    assert abs(run.metrics["distance"] - 6) < abs(HELD - 6) / 50


@pytest.mark.thorough
@pytest.mark.parametrize(("method", "distance"), [("", HELD), (", extrapolation: linear", EXTRAPOLATED)])
def test_a_model_that_our_solvers_integrate_is_fed_alike(tmp_path, method, distance):
    model = 'model M\n  input Real u(unit="m/s");\n  output Real y(unit="m", start=0, fixed=true);\n'
    source = tmp_path / "source"
    lay_out(source, "file: ramp.csv, column: v", ramp__csv=RAMP)
    (source / "components/part/m.mo").write_text(f"{model}equation\n  der(y) = u;\nend M;\n", encoding="utf-8")
    (source / "components/interfaces.yaml").write_text(
        "interfaces: {fed: {inputs: {u: m/s}, outputs: {y: m}}}\n", encoding="utf-8"
    )
    component = source / "components/part/component.yaml"
    component.write_text(
        "component: part\nimplements: fed\nsource: {kind: modelica, model: M, files: [m.mo]}\n", encoding="utf-8"
    )
    archive = build(the_component(source), version=3)
    (source / "components/part/part.fmu").write_bytes(archive.read_bytes())
    component.write_text(
        "component: part\nimplements: fed\nsource: {kind: fmu, file: part.fmu, interface: model_exchange}\n",
        encoding="utf-8",
    )
    bench = source / "testbenches/fed.yaml"
    text = bench.read_text(encoding="utf-8").replace(", part.seen]", f"], tolerance: 1e-10{method}")
    bench.write_text(text.replace("parameters: {part.gear: 0, part.on: false, part.mode: eco}\n", ""), encoding="utf-8")
    assert simulated(source).metrics["distance"] == pytest.approx(distance, rel=1e-9)


def previous(times: list[str], values: list[float], at: Fraction) -> float:
    return values[max(number for number, time in enumerate(times) if Fraction(time) <= at)]


@pytest.mark.thorough
def test_at_every_communication_point_the_part_sees_the_value_of_the_series_then(tmp_path):
    """A step shorter than any double of the times can hit: sums of 0.01 fall short of decimals now and then."""
    times = [f"{k * 7 / 100:.2f}" for k in range(30)]
    rows = "".join(f"{time},{k}\n" for k, time in enumerate(times))
    root = lay_out(tmp_path, "file: s.csv, column: v, interpolation: previous", s__csv=f"t,v [m/s]\n{rows}")
    bench = root / "testbenches/fed.yaml"
    bench.write_text(bench.read_text(encoding="utf-8").replace("100 ms", "10 ms"), encoding="utf-8")
    waveforms = simulated(root).waveforms
    expected = [previous(times, list(range(30)), Fraction(k, 100)) for k in range(201)]
    assert waveforms["inputs.part.u"].tolist() == expected
    assert waveforms["part.seen"].tolist() == [0, *expected[:-1]]  # what it was given at the beginning of its step


@pytest.mark.thorough
def test_between_samples_a_line_holds_and_outside_the_nearest_sample(tmp_path):
    run = simulated(lay_out(tmp_path, "file: lead.csv, column: v, offset: -0.25 s, gain: 2"))
    t = np.arange(21) * H
    expected = 2 * np.interp(t - 0.25, [0, 0.35, 1, 2], [0, 3.5, 2.5, 10])
    assert np.allclose(run.waveforms["inputs.part.u"], expected, rtol=1e-14, atol=0)


@pytest.mark.thorough
def test_a_run_is_given_another_offset_and_gain(tmp_path):
    root = lay_out(tmp_path)
    run = simulated(root, set={"inputs.part.u.offset": "500 ms", "inputs.part.u.gain": 3})
    t = np.arange(21) * H
    expected = 3 * np.interp(t + 0.5, [0, 0.35, 1, 2], [0, 3.5, 2.5, 10])
    assert np.allclose(run.waveforms["inputs.part.u"], expected, rtol=1e-14, atol=0)


@pytest.mark.thorough
def test_a_periodic_series_begins_anew_with_its_first_value(tmp_path):
    entry = "file: s.csv, column: v, interpolation: KIND, outside: periodic, offset: 0.3 s"
    sawtooth = "t,v [m/s]\n0.1,0\n0.4,3\n0.8,7\n"
    t = np.arange(21)
    inside = (t + 2) % 7 / 10  # after the first sample
    for kind, expected in (("linear", 10 * inside), ("previous", np.where(inside < 0.25, 0, 3))):
        root = lay_out(tmp_path / kind, entry.replace("KIND", kind), s__csv=sawtooth)
        got = simulated(root).waveforms["inputs.part.u"]
        assert np.allclose(got, expected, rtol=0, atol=1e-13), kind


@pytest.mark.thorough
def test_whole_numbers_truth_values_and_items_keep_their_last_sample(tmp_path):
    table = "t,gear,on,mode,level\n0,1,true,sport,0\n0.5,2,FALSE,eco,1\n1.2,-1,1,1,1\n"
    root = lay_out(tmp_path, "file: lead.csv, column: v", s__csv=table)
    bench = root / "testbenches/fed.yaml"
    text = bench.read_text(encoding="utf-8").replace("parameters: {part.gear: 0, part.on: false, part.mode: eco}\n", "")
    fed = "".join(f"  part.{name}: {{file: s.csv, column: {name}}}\n" for name in ("gear", "on", "mode"))
    shown = ", ".join(f"inputs.part.{name}" for name in ("gear", "on", "mode"))
    bench.write_text(text.replace("parameters:", "").replace("inputs:\n", f"inputs:\n{fed}").replace(
        "[inputs.part.u, part.y", f"[{shown}, part.y"), encoding="utf-8")  # fmt: skip
    waveforms = simulated(root).waveforms
    stretch = [5, 7, 9]  # rows: until 0.5 s, until 1.2 s, until 2 s
    assert waveforms["inputs.part.gear"].tolist() == np.repeat([1, 2, -1], stretch).tolist()
    assert waveforms["inputs.part.on"].tolist() == np.repeat([1, 0, 1], stretch).tolist()
    assert waveforms["inputs.part.mode"].tolist() == np.repeat([1, 0, 1], stretch).tolist()


@pytest.mark.thorough
def test_a_run_of_hours_sees_the_sample_that_is_due(tmp_path):
    """Steps are summed up in the component; a plain sum of 360,000 steps of 10 ms is off by more than a rounding."""
    rows = "".join(f"{k},{k}\n" for k in range(3601))
    root = lay_out(tmp_path, "file: s.csv, column: v, interpolation: previous", s__csv=f"t,v [m/s]\n{rows}")
    bench = root / "testbenches/fed.yaml"
    text = bench.read_text(encoding="utf-8").replace("100 ms", "10 ms, record_every: 1 s").replace("2 s,", "3600 s,")
    bench.write_text(text, encoding="utf-8")
    assert simulated(root).waveforms["inputs.part.u"].tolist() == list(range(3601))
