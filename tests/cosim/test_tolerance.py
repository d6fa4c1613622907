"""The tolerance that FMUs are told: their own default experiment's, or another in its place."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from cosim.exchange_models import model, system
from oracle.reference import run_reference

from dse.cosim.simulator import Simulator
from dse.domain.fmu import Experiment

TOLD = [(None, None, 0.0), (1e-3, None, 1e-3), (1e-3, 1e-8, 1e-8), (None, 1e-8, 1e-8)]
CASES = pytest.mark.parametrize(("own", "given", "expected"), TOLD)


@CASES
@pytest.mark.parametrize("version", [2, 3])
def test_a_slave_is_told_the_tolerance_that_is_given_else_its_own(shelf, version, own, given, expected):
    fmu = replace(shelf.fmu("told", version), experiment=Experiment(tolerance=own))
    simulated = shelf.system({"e": fmu}, record=["e.y"]).with_tolerance(given)
    with Simulator(simulated, ["e.y"]) as simulator:
        rows = [simulator.run(stop=0.2, step=0.1).tolist() for _ in range(3)]
    assert rows == [[[expected]] * 3] * 3  # fresh, proving the reset, after a reset
    assert run_reference(simulated, ["e.y"], stop=0.2, step=0.1).tolist() == rows[0]


@CASES
@pytest.mark.parametrize("version", [2, 3])
def test_so_is_a_model_that_we_integrate(shelf, version, own, given, expected):
    fmu = model("told", version, shelf.folder, tolerance=own)
    with Simulator(system({"e": fmu}, (), {}, ["e.x"]).with_tolerance(given), ["e.x"]) as simulator:
        assert simulator.run(stop=1.0, step=0.1)[-1, 0] == pytest.approx(expected, rel=1e-12)


def test_our_own_solver_keeps_it_too(shelf):
    errors = []
    for tolerance in (1e-3, 1e-9):
        simulated = system({"e": model("oscillator", 2, shelf.folder, tolerance=1e-5)}, (), {}, ["e.x"])
        with Simulator(simulated.with_tolerance(tolerance), ["e.x"]) as simulator:
            errors.append(abs(simulator.run(stop=50.0, step=1.0)[-1, 0] - math.cos(50.0)))
    assert errors[1] < 1e-6 < errors[0]
