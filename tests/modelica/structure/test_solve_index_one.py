from __future__ import annotations

import math

import numpy as np
import pytest
from modelica.structure.interpreter import Building, Machine, check_order, symbol

from dse.errors import DseError
from dse.modelica.solved_model import Explicit, System
from dse.modelica.structure.solve import solve


def oscillator() -> Building:
    b = Building()
    mass, stiffness = b.parameter("m", 2.0), b.parameter("c", 8.0)
    x, v, a, force = b.real("x", start=0.3, is_fixed=True), b.real("v", start=0.0, is_fixed=True), *b.reals("a f")
    b.equal(b.der("x"), v)
    b.equal(b.der("v"), a)
    b.equal(mass * a, force)
    b.equal(force, -(stiffness * x))
    return b


def test_a_mass_on_a_spring_swings_as_the_cosine_does() -> None:
    solved = solve(oscillator().flat())
    check_order(solved)
    assert solved.states == (symbol("x"), symbol("v"))
    found = Machine(solved).simulate(3.0, ["x", "v"])
    times = np.linspace(0, 3, 21)
    assert np.allclose(found[:, 0], 0.3 * np.cos(2 * times), atol=1e-8)
    assert np.allclose(found[:, 1], -0.6 * np.sin(2 * times), atol=1e-8)


def test_every_block_of_an_explicit_model_is_an_assignment() -> None:
    solved = solve(oscillator().flat())
    assert all(isinstance(block, Explicit) for block in (*solved.derivatives, *solved.outputs, *solved.initial))


def test_a_linear_loop_is_solved_in_one_torn_step() -> None:
    b = Building()
    x, y, z = b.reals("x y z")
    b.equal(x + 2.0 * y, z)
    b.equal(x - y, 3.0 + b.time)
    b.equal(y + 3.0 * z, 1.0)
    solved = solve(b.flat())
    (system,) = [block for block in solved.outputs if isinstance(block, System)]
    assert system.is_linear
    assert len(system.unknowns) == 1
    found = Machine(solved).simulate(1.0, ["x", "y", "z"], points=2)
    expected = np.linalg.solve([[1, 2, -1], [1, -1, 0], [0, 1, 3]], [0, 4, 1])
    assert np.allclose(found[-1], expected, rtol=1e-13)


def test_a_nonlinear_loop_is_solved_by_newton() -> None:
    b = Building()
    x, y = b.real("x", start=1.0), b.real("y", start=1.0)
    graph = b.graph
    b.equal(graph.make("exp", x) + y, 4.0)
    b.equal(x * y, 1.0)
    solved = solve(b.flat())
    machine = Machine(solved)
    machine.start()
    machine.run(solved.outputs)
    x_value, y_value = machine.value("x"), machine.value("y")
    assert math.isclose(math.exp(x_value) + y_value, 4.0, rel_tol=1e-12)
    assert math.isclose(x_value * y_value, 1.0, rel_tol=1e-12)


def test_what_only_an_output_needs_is_not_hot() -> None:
    b = oscillator()
    energy = b.real("energy", is_output=True)
    b.equal(energy, b.graph.variable("x") * b.graph.variable("f"))
    solved = solve(b.flat())
    assert [block.unknown for block in solved.outputs if isinstance(block, Explicit)] == [symbol("energy")]
    assert solved.dependencies["energy"] == {"x"}
    assert solved.dependencies["der(v)"] == {"x"}


def test_too_many_equations_are_refused_by_their_names() -> None:
    b = Building()
    x, y = b.reals("x y")
    b.equal(x, b.time)
    b.equal(2.0 * x, b.time * b.time)
    b.equal(y, x)
    with pytest.raises(DseError, match="one too many for x"):
        solve(b.flat())


def test_too_few_equations_are_refused_by_the_unknowns() -> None:
    b = Building()
    x, y = b.reals("x y")
    b.equal(x * y, b.time)
    with pytest.raises(DseError, match="one equation too few for"):
        solve(b.flat())


def test_equations_that_repeat_each_other_are_refused() -> None:
    b = Building()
    x, y = b.reals("x y")
    b.equal(x + 2.0 * y, b.time)
    b.equal(2.0 * x + 4.0 * y, 2.0 * b.time)
    with pytest.raises(DseError, match="do not determine"):
        solve(b.flat())
