"""Model exchange: the kernel integrates. Closed forms; every model as FMI 2.0 and as FMI 3.0."""

from __future__ import annotations

import numpy as np
import pytest
from cosim.exchange_models import model, rod_of_arrays, simulated, system

from dse.cosim.simulator import Simulator

BOTH = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="session")
def folder(shelf):
    return shelf.folder


@BOTH
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-9])
def test_an_undamped_oscillation_stays_within_its_tolerance(folder, version, tolerance):
    fmu = model("oscillator", version, folder, tolerance=tolerance)
    time, found = simulated(fmu, ["x", "v"], stop=10.0, step=0.1, start={"w": 3.0})
    # Nothing damps the errors of the steps, each at most the tolerance: they add up over at most 1000 steps. The
    # velocity is three times as large as x and its nominal.
    assert np.abs(found["x"] - np.cos(3.0 * time)).max() < 1000 * tolerance
    assert np.abs(found["v"] + 3.0 * np.sin(3.0 * time)).max() < 3000 * tolerance


@BOTH
def test_a_smaller_tolerance_is_a_smaller_error(folder, version):
    errors = []
    for tolerance in (1e-3, 1e-6, 1e-9):
        fmu = model("oscillator", version, folder, tolerance=tolerance)
        # One step for the whole run: the solver alone chooses its steps.
        time, found = simulated(fmu, ["x"], stop=20.0, step=20.0, start={"w": 3.0})
        errors.append(abs(found["x"][-1] - np.cos(3.0 * time[-1])))
    # A thousandth of the tolerance would be a thousandth of the error; a hundredth leaves room for luck.
    assert errors[1] < errors[0] / 100
    assert errors[2] < errors[1] / 100


@BOTH
def test_without_a_tolerance_of_its_own_an_fmu_is_integrated_to_a_millionth(folder, version):
    told = simulated(model("oscillator", version, folder, tolerance=1e-6), ["x"], stop=5.0, step=0.5)[1]["x"]
    untold = simulated(model("oscillator", version, folder), ["x"], stop=5.0, step=0.5)[1]["x"]
    assert told.tobytes() == untold.tobytes()


@BOTH
@pytest.mark.parametrize("rate", [1e3, 1e6, 1e9])
def test_a_stiff_system_is_solved_in_few_evaluations(folder, version, rate):
    fmu = model("stiff", version, folder, tolerance=1e-6)
    time, found = simulated(fmu, ["x", "y", "evaluations"], stop=10.0, step=0.1, start={"k": rate})
    # x is drawn to cos t faster than any error can grow; y adds up the errors of some hundred steps.
    assert np.abs(found["x"] - np.cos(time)).max() < 1e-5
    assert np.abs(found["y"] - np.exp(-time)).max() < 1e-4
    # An explicit solver would need rate / 3.25 steps a second, with six evaluations each.
    assert found["evaluations"][-1] < 3000


@BOTH
def test_the_jacobian_comes_from_the_fmu_if_it_has_one(folder, version):
    fmu = model("stiff", version, folder, "-DDIRECTIONAL", tolerance=1e-6)
    time, found = simulated(fmu, ["x", "directions"], stop=10.0, step=0.1)
    assert np.abs(found["x"] - np.cos(time)).max() < 1e-5
    assert found["directions"][-1] > 100


@pytest.mark.parametrize("flags", [(), ("-DDIRECTIONAL",)], ids=["differences", "told"])
@pytest.mark.parametrize("kind", ["scalars", "array"])
def test_many_states_are_one_array_or_many_variables(folder, kind, flags):
    fmu = (
        model("rod", 2, folder, *flags, tolerance=1e-7)
        if kind == "scalars"
        else rod_of_arrays(folder, *flags, tolerance=1e-7)
    )
    record = [f"x[{i + 1}]" for i in range(40)]
    time, found = simulated(fmu, [*record, "directions"], stop=1.0, step=0.1, start={"k": 1000.0})
    # The first mode of the chain decays at 4 k sin^2(pi / 2 / 41), the fastest one at almost 4 k: a stiff system.
    rate = 4000.0 * np.sin(np.pi / 82) ** 2
    shape = np.sin(np.arange(1, 41) * np.pi / 41)
    rows = np.array([found[name] for name in record])
    # All modes are damped; each step's error is 1e-7, of at most some hundred steps.
    assert np.abs(rows - shape[:, None] * np.exp(-rate * time)).max() < 1e-5
    assert bool(found["directions"][-1]) is bool(flags)


@BOTH
def test_states_of_any_size_are_as_accurate_as_their_nominals_say(folder, version):
    time, found = simulated(model("scales", version, folder, tolerance=1e-6), ["x", "y"], stop=2.0, step=0.5)
    # A millionth of the value or a hundredth of that of the nominal is allowed in each of at most 200 steps. Were the
    # nominal of x 1, it would be left to itself, and grow: the steps that suit y are too long for it.
    for name, size, rate in (("x", 1e-9, 50.0), ("y", 1e9, 1.0)):
        assert np.abs(found[name] / size - np.exp(-rate * time)).max() < 2e-4


@BOTH
def test_an_fmu_without_states_has_its_events_all_the_same(folder, version):
    start = {"on_from": 0.32, "on_until": 0.78}
    time, found = simulated(
        model("stateless", version, folder), ["now", "on", "ticks"], stop=2.0, step=0.1, start=start
    )
    assert found["now"].tolist() == pytest.approx(time.tolist(), abs=1e-12)
    assert found["on"].tolist() == [float(0.32 <= t < 0.78) for t in time]
    # Ticks are at k * 0.3, some of them on a communication point, where they are seen at once.
    assert found["ticks"].tolist() == [float(int(t / 0.3 + 1e-9)) for t in time]


@BOTH
def test_an_fmu_without_states_and_indicators_is_only_told_the_time(folder, version):
    fmu = model("stateless", version, folder, "-DINDICATORS=0")
    time, found = simulated(fmu, ["now", "ticks"], stop=3.0, step=0.25, start={"period": 0.25})
    assert found["now"].tolist() == time.tolist()
    assert found["ticks"].tolist() == list(range(13))


@BOTH
def test_time_is_never_accumulated(folder, version):
    fmu = model("stateless", version, folder)
    start = {"on_from": 1e9, "on_until": 1e9, "period": 1e9}
    _, found = simulated(fmu, ["now"], stop=60.0, step=0.01, start=start)
    assert found["now"][1:].tolist() == [k * 0.01 + 0.01 for k in range(6000)]


@BOTH
def test_the_same_run_gives_the_same_bits_fresh_reset_and_again(folder, version):
    fmu = model("clocks", version, folder)
    names = ["e.x", "e.ticks", "e.last"]
    with Simulator(system({"e": fmu}, (), {}, names), names) as simulator:
        runs = [simulator.run(stop=2.0, step=0.1).copy() for _ in range(4)]
        assert simulator.reset_is_trusted
    assert len({run.tobytes() for run in runs}) == 1
