"""Inputs of model exchange elements: held or sloped while integrating, discrete ones set in event mode only."""

from __future__ import annotations

import math

import numpy as np
import pytest
from cosim.exchange_models import model, system

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.method import Adaptive, Extrapolation, Method

BOTH = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="session")
def folder(shelf):
    return shelf.folder


def run(built, record, *, stop, step, method=None):
    keywords = {} if method is None else {"method": method}
    with Simulator(built, record, **keywords) as simulator:
        rows = simulator.run(stop=stop, step=step)
    return np.arange(len(rows)) * step, dict(zip(record, rows.T, strict=True))


@BOTH
def test_an_input_is_held_from_one_communication_point_to_the_next(folder, version):
    # A clock counts 0.1 s; what it shows at the beginning of a step is the input over all of it.
    elements = {"clock": model("clocks", version, folder), "e": model("sampler", version, folder)}
    start = {"clock.period": 0.1, "clock.other_period": 1e9, "clock.event": 1e9}
    built = system(elements, ["clock.x -> e.u"], start, ["e.x", "clock.x"])
    _, found = run(built, ["clock.x", "e.x"], stop=2.0, step=0.1)
    held = np.concatenate([[0.0], np.cumsum(0.1 * found["clock.x"])[:-1]])
    assert np.abs(found["e.x"] - held).max() < 1e-12


@BOTH
def test_discrete_inputs_are_set_in_event_mode(folder, version):
    elements = {"clock": model("clocks", version, folder), "e": model("sampler", version, folder)}
    start = {"clock.period": 0.2, "clock.other_period": 1e9, "clock.event": 1e9}
    # The sampler refuses a discrete input outside event mode, and counts the changes its events see.
    built = system(elements, ["clock.ticks -> e.n"], start, ["clock.ticks", "e.n", "e.changes", "e.x"])
    _, found = run(built, ["clock.ticks", "e.n", "e.changes", "e.x"], stop=2.0, step=0.1)
    assert found["e.n"].tolist() == [0.0, *found["clock.ticks"][:-1].tolist()]
    assert found["e.changes"].tolist() == found["e.n"].tolist()
    held = np.concatenate([[0.0], np.cumsum(0.1 * found["clock.ticks"])[:-1]])
    assert np.abs(found["e.x"] - held).max() < 1e-12


@BOTH
def test_an_input_that_cannot_be_taken_by_its_type_fails_as_ever(folder, version):
    elements = {"clock": model("clocks", version, folder), "e": model("sampler", version, folder)}
    built = system(elements, ["clock.x -> e.n"], {}, ["e.x"])
    with Simulator(built, ["e.x"]) as simulator, pytest.raises(RunFailed, match=r"e\.n cannot take the value"):
        simulator.run(stop=2.0, step=0.1)


@BOTH
def test_elements_of_both_kinds_work_in_one_system(shelf, folder, version):
    elements = {"e": model("oscillator", version, folder, tolerance=1e-9), "gain": shelf.fmu("gain", 5 - version)}
    # u = -3 x through an FMU for co-simulation, late by steps of 0.1 ms: x'' = -(1 + 3) x but for the delay.
    built = system(elements, ["e.x -> gain.u", "gain.y -> e.u"], {"gain.k": -3.0}, ["e.x", "gain.y"])
    time, found = run(built, ["e.x", "gain.y"], stop=2.0, step=1e-4)
    # The delay of at most two steps acts like a negative damping of 3 * 2e-4 / 2 a second.
    assert np.abs(found["e.x"] - np.cos(2.0 * time)).max() < 3 * 2e-4 * 2.0


def coupled(folder, version, method, step):
    """Two oscillators in a ring, x1'' = -x1 + x2 and x2'' = -x2 + x1, of which x1 + x2 and x1 - x2 are known."""
    fmu = model("oscillator", version, folder, tolerance=1e-10)
    built = system({"a": fmu, "b": fmu}, ["a.x -> b.u", "b.x -> a.u"], {"b.x": 0.0}, ["a.x", "b.x"])
    time, found = run(built, ["a.x", "b.x"], stop=2.0, step=step, method=method)
    exact = 0.5 + 0.5 * np.cos(math.sqrt(2.0) * time)
    return np.abs(found["a.x"] - exact).max()


@BOTH
def test_slopes_of_inputs_raise_the_order_by_one(folder, version):
    errors = {
        extrapolation: [
            coupled(folder, version, Method(extrapolation=extrapolation), step) for step in (0.1, 0.05, 0.025)
        ]
        for extrapolation in Extrapolation
    }
    # Held inputs are off by h, those on a line by h^2: halving the step shows it. A fifth for the higher orders.
    for extrapolation, order in ((Extrapolation.HOLD, 1), (Extrapolation.LINEAR, 2)):
        first, second, third = errors[extrapolation]
        assert math.log2(first / second) == pytest.approx(order, abs=0.25)
        assert math.log2(second / third) == pytest.approx(order, abs=0.2)
    assert errors[Extrapolation.LINEAR][-1] < errors[Extrapolation.HOLD][-1] / 5


@BOTH
def test_going_back_to_a_saved_state_leaves_no_trace(folder, version):
    ring = model("oscillator", version, folder)
    elements = {"a": ring, "b": ring, "saw": model("sawtooth", version, folder), "e": model("sampler", version, folder)}
    wires = ["a.x -> b.u", "b.x -> a.u", "saw.resets -> e.n", "saw.x -> e.u"]
    record = ["a.x", "b.x", "saw.x", "saw.resets", "e.x", "e.changes"]
    built = system(elements, wires, {"b.x": 0.0, "saw.rate": 1.7}, record)
    # Everything is accurate enough, so each step is made once, taken back, and made again as two halves.
    doubling = Method(adaptive=Adaptive(tolerance=1e9, absolute=1e9))
    _, tried = run(built, record, stop=8.0, step=0.25, method=doubling)
    _, plain = run(built, record, stop=8.0, step=0.125)
    for name in record:
        assert tried[name].tobytes() == plain[name][::2].tobytes()
