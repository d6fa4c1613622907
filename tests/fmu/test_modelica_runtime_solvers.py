"""The solvers of the Modelica runtime against closed forms, published solutions and their own theory."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu.modelica_models.drive import instances
from fmu.modelica_models.models import BLOW_UP, FORCED, LAG, OSCILLATOR, ROBERTSON, ROOT, VAN_DER_POL


@pytest.fixture
def version():
    return 2  # the solvers know nothing of an FMI version


@pytest.fixture
def new(cache, version):
    with instances(cache, version) as make:
        yield make


@pytest.mark.parametrize("solver", ["EXPLICIT", "STIFF"])
@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10])
def test_the_error_of_an_oscillation_follows_the_tolerance(new, solver, tolerance):
    oscillator = new(replace(OSCILLATOR, name=f"oscillator_{solver.lower()}", solver=solver))
    oscillator.ready(tolerance=tolerance)
    error = 0.0
    for k in range(200):
        oscillator.fmu.doStep(k * 0.05, 0.05)
        error = max(error, abs(oscillator.get("x") - math.cos(2.0 * (k + 1) * 0.05)))
    # 20 radians: the errors of some hundred steps add up, none is amplified
    assert error < 100 * tolerance


def _nudged(solver):
    values = {**FORCED.values, "nudge": 0.0}
    return replace(FORCED, name=f"nudged_{solver.lower()}", values=values, roles={"nudge": "INPUT"}, solver=solver)


@pytest.mark.parametrize("solver", ["EXPLICIT", "STIFF"])
def test_both_solvers_are_of_order_five(new, solver):
    # An input that changes ends each step at the communication point; at so loose a tolerance it is one step.
    def at_two(count):
        made = new(_nudged(solver)).ready(tolerance=0.9)
        for k in range(count):
            made.set("nudge", (k + 1) % 2)
            made.fmu.doStep(k * 2.0 / count, 2.0 / count)
        return np.array([made.get("x"), made.get("v")])

    exact = at_two(4096)
    errors = [np.abs(at_two(count) - exact).max() for count in (32, 64, 128)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders.min() > 4.6
    assert errors[-1] < 1e-8


@pytest.mark.parametrize("solver", ["EXPLICIT", "STIFF"])
def test_one_evaluation_that_is_not_finite_costs_a_shorter_step_and_no_more(new, solver):
    model = replace(
        OSCILLATOR,
        name=f"hiccup_{solver.lower()}",
        values={**OSCILLATOR.values, "calls": 0.0, "wrong": 0.0},
        roles={**OSCILLATOR.roles, "wrong": "TUNABLE"},
        code={
            **OSCILLATOR.code,
            "derivatives": "V(a) = -V(stiffness) * V(x); V(calls) += 1; if (V(calls) == V(wrong)) { V(a) = NAN; }",
        },
        solver=solver,
    )
    first = int(new(model).ready(tolerance=1e-8).get("calls")) + 1
    # Somewhere in the first steps: at each of their stages, in their Jacobians and at their ends.
    for wrong in range(first, first + 24):
        made = new(model).ready(tolerance=1e-8, wrong=wrong)
        made.fmu.doStep(0.0, 1.0)
        assert made.get("calls") > wrong
        assert abs(made.get("x") - math.cos(2.0)) < 1e-6


@pytest.mark.parametrize("solver", ["EXPLICIT", "STIFF"])
def test_the_dense_output_is_as_good_as_the_steps(new, solver):
    model = replace(FORCED, name=f"forced_{solver.lower()}", solver=solver)
    exact = new(model).ready(tolerance=1e-13)
    dense = new(model).ready(tolerance=1e-7)
    error = 0.0
    for k in range(500):
        exact.fmu.doStep(k * 0.01, 0.01)
        dense.fmu.doStep(k * 0.01, 0.01)
        error = max(error, abs(exact.get("x") - dense.get("x")))
    assert error < 2e-6


@pytest.mark.parametrize("solver", ["AUTO", "STIFF"])
def test_a_stiff_van_der_pol_oscillator_ends_at_the_published_point(new, solver):
    made = new(replace(VAN_DER_POL, name=f"vdp_{solver.lower()}", solver=solver)).ready(tolerance=1e-8)
    made.step(2000.0)
    # Mazzia and Magherini: Test Set for Initial Value Problem Solvers, II.24 (time scaled by mu)
    assert made.get("x") == pytest.approx(1.706167732170469, abs=1e-6)
    assert made.get("v") == pytest.approx(-0.8928097010248125e-3, rel=1e-5)


@pytest.mark.thorough
def test_an_explicit_solver_that_is_asked_for_too_much_says_so(new):
    made = new(replace(VAN_DER_POL, name="vdp_explicit", solver="EXPLICIT")).ready(tolerance=1e-6)
    with pytest.raises(FMICallException):
        made.step(2000.0)
    assert "more than 1000000 internal steps in one step; the stiff solver may be needed" in made.messages[-1]


def test_robertsons_reaction_has_the_published_concentrations(new):
    made = new(ROBERTSON).ready(tolerance=1e-8)
    made.step(40.0)
    # Hairer, Wanner: Solving Ordinary Differential Equations II, IV.1 and its codes
    assert made.get("y1") == pytest.approx(0.7158270687, abs=1e-7)
    assert made.get("y2") == pytest.approx(0.9185534764e-5, rel=1e-5)
    made.fmu.doStep(40.0, 4e6)
    assert made.get("y1") + made.get("y2") + made.get("y3") == pytest.approx(1.0, abs=1e-9)


def test_an_input_is_held_over_the_step_and_seen_at_its_beginning(new):
    lag = new(LAG).ready(tolerance=1e-9, u=1.0)
    x = 0.0
    for k in range(50):
        value = math.sin(0.3 * k)
        lag.set("u", value)
        lag.step(0.1)
        x = value + (x - value) * math.exp(-0.1 / 0.5)
        assert lag.get("x") == pytest.approx(x, abs=1e-7)
        assert lag.get("y") == pytest.approx(3.0 * x, abs=1e-6)
        assert lag.get("through") == pytest.approx(value + x, abs=1e-6)


def test_an_input_set_to_what_it_was_changes_nothing_to_the_last_bit(new):
    quiet, busy = new(LAG).ready(u=1.0), new(LAG).ready(u=1.0)
    for _ in range(20):
        busy.set("u", 5.0)
        busy.set("u", 1.0)
        quiet.step(0.01)
        busy.step(0.01)
        assert busy.get("x") == quiet.get("x")


def test_the_step_size_does_not_matter_beyond_the_tolerance(new):
    coarse, fine = new(OSCILLATOR).ready(tolerance=1e-8), new(OSCILLATOR).ready(tolerance=1e-8)
    coarse.run(10.0, 2.5)
    fine.run(10.0, 0.001)
    assert coarse.get("x") == pytest.approx(fine.get("x"), abs=1e-7)


def test_the_importers_tolerance_counts_and_else_the_models_own(new):
    def error(model, **settings):
        made = new(model).ready(**settings)
        made.step(10.0)
        return abs(made.get("x") - math.cos(20.0))

    own = replace(OSCILLATOR, name="loose_oscillator", tolerance=1e-3)
    assert error(own) > 1e-5
    assert error(own, tolerance=1e-9) < 1e-7
    assert error(own, tolerance=1e-3) == error(own)


def test_reading_outputs_does_not_change_what_comes_after(new):
    silent, watched = new(ROOT).ready(), new(ROOT).ready()
    for k in range(90):
        silent.fmu.doStep(k * 0.01, 0.01)
        watched.fmu.doStep(k * 0.01, 0.01)
        assert watched.get("y") == pytest.approx(math.sqrt(1.0 - (k + 1) * 0.01), abs=1e-6)
    assert silent.get("y") == watched.get("y")
    assert silent.saved() == watched.saved()


def test_an_equation_that_cannot_be_solved_any_more_is_named_with_the_time(new):
    made = new(ROOT).ready()
    made.step(0.9)
    with pytest.raises(FMICallException):
        made.step(0.2)
    assert "DoStep: at 1 s: model.mo:7:3: y ^ 2 = x has no solution" in made.messages[-1]
    with pytest.raises(FMICallException):
        made.fmu.doStep(1.0, 0.1)
    assert "the simulation has failed at 1 s" in made.messages[-1]


def test_a_solution_that_grows_without_bound_ends_with_a_message_and_no_number(new):
    made = new(BLOW_UP).ready()
    made.step(0.5)
    assert made.get("x") == pytest.approx(2.0, rel=1e-5)
    with pytest.raises(FMICallException):
        made.step(1.0)
    assert "DoStep: at 1" in made.messages[-1] or "DoStep: at 0.99999" in made.messages[-1]
