"""Two masses, each with a spring and a damper to the ground, and a spring and a damper between them.

The left element is the first mass and takes the force; the right one is the second mass and the coupling, so that its
force follows the left one's position and speed directly. Elements integrate with four Runge-Kutta steps per
communication step: their own error is of order four and far below the master's.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from linear_fmus import Linear, closed_form, system

from dse.cosim.simulator import Simulator
from dse.domain.method import PLAIN, Adaptive, Algorithm, Coupling, Extrapolation, Method
from dse.errors import DseError

JACOBI, SEIDEL = Algorithm
HOLD, LINEAR = Extrapolation
NONE, PROPAGATE, SOLVE = Coupling
WIRES = ["right.y0 -> left.u0", "left.y0 -> right.u0", "left.y1 -> right.u1"]
RECORD = ["left.y0", "left.y1", "right.y1", "right.y2"]
STOP = 4.0


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("masses")


def two_masses(**options) -> dict[str, Linear]:
    m1, c1, d1, m2, c2, d2, stiffness, damping = 1.0, 1.0, 0.1, 0.5, 2.0, 0.05, 3.0, 0.2
    return {
        "left": Linear(
            [[0, 1], [-c1 / m1, -d1 / m1]], [[0], [1 / m1]], [[1, 0], [0, 1]], (), [1.0, 0.0], parts=4, **options
        ),
        "right": Linear(
            [[0, 1], [-(c2 + stiffness) / m2, -(d2 + damping) / m2]],
            [[0, 0], [stiffness / m2, damping / m2]],
            [[stiffness, damping], [1, 0], [0, 1]],
            [[-stiffness, -damping]],
            [0.0, 0.5],
            parts=4,
            **options,
        ),
    }


def error(elements, folder, method, step, wires=WIRES) -> float:
    """Largest error of any position or speed at any communication point."""
    made = system(elements, wires, folder)
    with Simulator(made, RECORD, method=method) as simulator:
        found = simulator.run(stop=STOP, step=step)
    right = closed_form(elements, wires, step, len(found))
    return max(float(np.abs(found[:, i] - right[name]).max()) for i, name in enumerate(RECORD))


def order(elements, folder, method) -> float:
    """Observed order between two steps that are small enough for the leading term to rule (0.02 and 0.01 s)."""
    return float(np.log2(error(elements, folder, method, 0.02) / error(elements, folder, method, 0.01)))


@pytest.mark.parametrize("takes_slopes", [False, True], ids=["", "slopes"])
@pytest.mark.parametrize("coupling", Coupling)
@pytest.mark.parametrize("algorithm", Algorithm)
def test_inputs_that_are_held_give_first_order(folder, algorithm, coupling, takes_slopes):
    found = order(two_masses(takes_slopes=takes_slopes), folder, Method(algorithm, coupling, HOLD))
    assert found == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("algorithm", Algorithm)
@pytest.mark.parametrize(
    ("coupling", "takes_slopes"), [(NONE, True), (PROPAGATE, False), (PROPAGATE, True), (SOLVE, False), (SOLVE, True)]
)
def test_inputs_that_go_on_along_a_line_give_second_order(folder, algorithm, coupling, takes_slopes):
    found = order(two_masses(takes_slopes=takes_slopes), folder, Method(algorithm, coupling, LINEAR))
    assert found == pytest.approx(2.0, abs=0.1)


def test_an_output_that_follows_a_mid_step_input_lags_half_a_step_unless_it_is_propagated(folder):
    elements = two_masses(takes_slopes=False)
    assert order(elements, folder, Method(JACOBI, NONE, LINEAR)) == pytest.approx(1.0, abs=0.1)
    assert order(elements, folder, Method(JACOBI, PROPAGATE, LINEAR)) == pytest.approx(2.0, abs=0.1)


def test_gauss_seidel_is_better_than_jacobi_and_a_line_better_than_holding(folder):
    elements = two_masses(takes_slopes=True)
    errors = [
        error(elements, folder, Method(algorithm, NONE, extrapolation), 0.01)
        for algorithm, extrapolation in ((JACOBI, HOLD), (SEIDEL, HOLD), (JACOBI, LINEAR), (SEIDEL, LINEAR))
    ]
    assert errors == sorted(errors, reverse=True)


def test_substeps_of_both_elements_do_not_raise_the_order(folder):
    # The stiffer of two elements may want shorter steps; what they exchange is still one value per step.
    steps = {"right": 0.01 / 4}
    with_parts = error(two_masses(), folder, Method(steps=steps), 0.01)
    without = error(two_masses(), folder, PLAIN, 0.01)
    assert with_parts == pytest.approx(without, rel=0.2)


@pytest.mark.parametrize("algorithm", Algorithm)
@pytest.mark.parametrize("extrapolation", Extrapolation)
def test_an_adaptive_step_keeps_an_error_that_falls_with_its_tolerance(folder, algorithm, extrapolation):
    elements = two_masses(takes_slopes=True)
    errors = [
        error(elements, folder, Method(algorithm, NONE, extrapolation, adaptive=Adaptive(tolerance, tolerance)), 0.1)
        for tolerance in (1e-2, 1e-3, 1e-4)
    ]
    # Error per step is what is controlled; the step goes with its root or third root. So the error falls by 10**0.5
    # at least for every tenth of the tolerance.
    assert errors[0] > 2.5 * errors[1] > 2.5 * 2.5 * errors[2]
    assert errors[2] < 0.02


@pytest.mark.parametrize(("extrapolation", "wanted"), [(HOLD, 1.0), (LINEAR, 2.0)])
@pytest.mark.parametrize("algorithm", Algorithm)
def test_a_true_algebraic_loop_keeps_the_order_if_it_is_solved(folder, algorithm, extrapolation, wanted):
    # The right element carries a part of the first mass: its force follows the left one's acceleration, which follows
    # the force.
    elements = two_masses()
    left, right = elements["left"], elements["right"]
    loop = {
        "left": replace(left, c=[*left.c, left.a[1]], d=[[0.0], [0.0], left.b[1]]),
        "right": replace(right, d=[[*right.d[0], -0.3]]),
    }
    wires = [*WIRES, "left.y2 -> right.u2"]
    method = Method(algorithm, SOLVE, extrapolation)
    found = np.log2(error(loop, folder, method, 0.02, wires) / error(loop, folder, method, 0.01, wires))
    assert found == pytest.approx(wanted, abs=0.1)
    with pytest.raises(DseError, match=r"algebraic loop: left\.y2 -> right\.u2, right\.y0 -> left\.u0"):
        error(loop, folder, Method(algorithm, PROPAGATE, extrapolation), 0.02, wires)
