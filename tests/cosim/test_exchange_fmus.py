"""Model exchange of archives, reference models and our own Modelica components.

They are held against closed forms, SciPy, FMPy's CVode, and the same FMUs for co-simulation.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from cosim.exchange_models import simulated, system as system_of
from fmpy import simulate_fmu
from fmu.modelica_models.models import BALL, GRAZE, PULSE, RELAY, ROOT, SAMPLED
from reference_fmus import build
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from dse.cosim.simulator import Simulator
from dse.domain.fmu import Experiment, FmiInterface
from dse.fmu.unpack import open_fmu
from dse.system.assembly import resized

BOTH = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="session")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("archives")


def opened(archive, folder, tolerance=1e-9, interface=FmiInterface.MODEL_EXCHANGE):
    model = open_fmu(archive, cache=folder / "cache", interface=interface)
    return replace(model, experiment=Experiment(tolerance=tolerance))


def reference(name, version, folder, tolerance=1e-9):
    return opened(build(name, version, "ModelExchange", folder), folder, tolerance)


@BOTH
def test_the_test_equation_decays(folder, version):
    time, found = simulated(reference("Dahlquist", version, folder), ["x"], stop=10.0, step=0.1, start={"k": 0.7})
    # 100 steps, each with an error of at most 1e-9 of x, which decays as x does.
    assert np.abs(found["x"] / np.exp(-0.7 * time) - 1.0).max() < 1e-7


def bouncing(time, g=9.81, e=0.7, v_min=0.1):
    """Height of a ball let go at 1 m, which loses 1 - e of its speed at each bounce, and the number of bounces."""
    began, height, speed, bounces = 0.0, 1.0, 0.0, 0
    while True:
        meets = began + (speed + math.sqrt(speed**2 + 2 * g * height)) / g
        if time < meets:
            return height + speed * (time - began) - g * (time - began) ** 2 / 2, bounces
        speed, height, began, bounces = e * (g * (meets - began) - speed), 0.0, meets, bounces + 1
        if speed < v_min:
            return 0.0, bounces


@BOTH
@pytest.mark.parametrize("step", [0.01, 0.1, 1.0])
def test_a_ball_bounces_until_it_rests(folder, version, step):
    fmu = reference("BouncingBall", version, folder)
    time, found = simulated(fmu, ["h", "bounces", "resting"], stop=3.0, step=step)
    exact = np.array([bouncing(t) for t in time])
    # A parabola is no challenge to either solver; a bounce is located to 1e-13 of a step or rounding.
    assert np.abs(found["h"] - exact[:, 0]).max() < 1e-8
    assert found["bounces"].tolist() == exact[:, 1].tolist()
    assert found["resting"][-1] == 1


def _van_der_pol(_time, x, mu):
    return [x[1], mu * (1.0 - x[0] ** 2) * x[1] - x[0]]


@BOTH
@pytest.mark.parametrize("mu", [1.0, 50.0])
def test_the_oscillator_of_van_der_pol_is_what_scipy_finds(folder, version, mu):
    fmu = reference("VanDerPol", version, folder)
    time, found = simulated(fmu, ["x0", "x1"], stop=20.0, step=0.1, start={"mu": mu})
    method = "DOP853" if mu == 1.0 else "Radau"
    exact = solve_ivp(_van_der_pol, (0, 20), [2.0, 0.0], method, time, args=(mu,), rtol=1e-11, atol=1e-12)
    # The limit cycle draws states together but not phases: errors of some 1e4 steps add up in time, and the slopes at
    # mu = 1 are below 3. At mu = 50 there is no jump before 20 s.
    assert np.abs(found["x0"] - exact.y[0]).max() < 1e-5
    assert np.abs(found["x1"] - exact.y[1]).max() < 1e-5


@BOTH
def test_a_stair_has_its_steps_at_the_communication_points_they_fall_on(folder, version):
    time, found = simulated(reference("Stair", version, folder), ["counter"], stop=10.0, step=0.2)
    assert found["counter"].tolist() == [1.0 + math.floor(t + 1e-9) for t in time]


@BOTH
def test_a_stair_ends_the_simulation_by_itself(folder, version):
    system = system_of({"s": reference("Stair", version, folder)}, (), {}, ["s.counter"])
    with Simulator(system, ["s.counter"]) as simulator:
        rows = simulator.run(stop=20.0, step=0.2)
    assert (len(rows), rows[-1, 0]) == (56, 12.0)  # the twelfth stair, at 11 s
    assert "at t = 11 s asked to end the simulation" in simulator.ended


@pytest.mark.parametrize(("version", "size"), [(2, 3), (3, 3), (3, 2), (3, 5)])
def test_structural_parameters_set_the_number_of_states(folder, version, size):
    draw = np.random.default_rng(size)
    a = draw.normal(size=(size, size)) - 2.0 * np.eye(size)
    u, x0 = draw.normal(size=size), draw.normal(size=size)
    given = {"A": a, "B": np.eye(size), "C": 2.0 * np.eye(size), "D": np.zeros((size, size)), "x0": x0, "u": u}
    start = {
        f"{name}[{','.join(str(k + 1) for k in at)}]": float(value)
        for name, values in given.items()
        for at, value in np.ndenumerate(values)
    }
    sizes = dict.fromkeys(("m", "n", "r"), float(size)) if version == 3 else {}
    fmu = resized(reference("StateSpace", version, folder), sizes)
    outputs = [f"y[{k + 1}]" for k in range(size)]
    time, found = simulated(fmu, outputs, stop=2.0, step=0.1, start={**start, **sizes})
    for k, t in enumerate(time):
        # x = e^At x0 + A^-1 (e^At - 1) u, and y = 2 x.
        power = expm(a * t)
        exact = 2.0 * (power @ x0 + np.linalg.solve(a, (power - np.eye(size)) @ u))
        # Some hundred steps of 1e-9 each; no mode grows faster than e^t.
        assert np.abs([found[name][k] for name in outputs] - exact).max() < 1e-6


@pytest.mark.thorough
@pytest.mark.sampled(2)
@BOTH
def test_a_stiff_oscillator_of_van_der_pol_takes_its_jacobian_from_the_fmu(folder, version):
    fmu = reference("VanDerPol", version, folder, tolerance=1e-6)
    assert fmu.capabilities.provides_directional_derivatives
    time, found = simulated(fmu, ["x0"], stop=2000.0, step=20.0, start={"mu": 1000.0})
    exact = solve_ivp(_van_der_pol, (0, 2000), [2.0, 0.0], "Radau", time, args=(1000.0,), rtol=1e-9, atol=1e-11)
    # Between the jumps x0 moves by some 1e-3 a second; the jump's time is as accurate as some hundred steps of 1e-6.
    calm = np.abs(np.gradient(exact.y[0])) < 0.1
    assert calm.sum() > 90
    assert np.abs(found["x0"] - exact.y[0])[calm].max() < 1e-3


MODELS = pytest.mark.parametrize(
    ("model", "stop", "outputs"),
    [
        (BALL, 1.4, ["h", "bounces"]),
        (RELAY, 3.0, ["x", "on", "switches"]),
        (SAMPLED, 1.0, ["x"]),
        (PULSE, 1.0, ["x", "count"]),
        (GRAZE, 30.0, ["x", "passed"]),
        (ROOT, 0.9, ["x", "y"]),
    ],
    ids=lambda value: getattr(value, "name", None),
)


# One FMI version each: compiling takes longer than simulating, and the archives differ by their outermost layer only.
@pytest.mark.thorough
@MODELS
def test_a_modelica_component_does_the_same_in_model_exchange_and_co_simulation(folder, model, stop, outputs):
    archive = model.fmu(folder, 3)
    # Not a divisor of the periods of clocks, which co-simulation lets tick in the step after a communication point.
    step = stop / 97
    one, other = (
        simulated(opened(archive, folder, interface=interface), outputs, stop=stop, step=step)[1]
        for interface in FmiInterface
    )
    for name in outputs:
        # Our solver inside and our solver outside, both to 1e-6 or better; errors add up over some hundred steps.
        assert np.abs(one[name] - other[name]).max() < 1e-4


@pytest.mark.sampled(3)
@MODELS
def test_a_modelica_component_does_what_cvode_finds(folder, model, stop, outputs):
    archive = model.fmu(folder, 2)
    step = 0.05
    time, found = simulated(opened(archive, folder), outputs, stop=stop, step=step)
    theirs = simulate_fmu(
        str(archive),
        validate=False,
        fmi_type="ModelExchange",
        stop_time=stop,
        output_interval=step,
        step_size=step,
        relative_tolerance=1e-9,
        output=outputs,
    )
    at = {round(t, 9): k for k, t in enumerate(theirs["time"])}  # the last row of a time is after its events
    common = [(k, at[round(t, 9)]) for k, t in enumerate(time) if round(t, 9) in at]
    assert len(common) > 0.9 * len(time)
    for name in outputs:
        # CVode's own error, which grows over the run.
        assert max(abs(found[name][ours] - float(theirs[name][row])) for ours, row in common) < 2e-6
