"""Systems of equations as compiled C: linear and by Newton's method, solved and not to be solved."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from emitted_model import Emitter
from model_maker import Maker, explicit

from dse.errors import DseError, Location
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.emit.model import emit
from dse.modelica.emit.variables import variables
from dse.modelica.flat_model import Clock, Role
from dse.modelica.solved_model import Explicit, Solved, System

_AT = Location("ball.mo", 7, 3)


def test_a_linear_system_is_solved_whatever_the_unknowns_were(emitted: Emitter) -> None:
    made = Maker()
    p, u = made.parameter("p", 2.0), made.variable("u", Role.INPUT)
    x, y, z = (made.variable(name) for name in "xyz")
    # z = x + y is inner; p x + y = u, x - z = 1  =>  y = -1, x = (u + 1) / p
    residuals = (p * x + y - u, x - z - 1)
    one, zero = made.graph.constant(1), made.graph.constant(0)
    system = System(
        (Symbol("x"), Symbol("y")),
        (explicit("z", x + y),),
        residuals,
        ((p, one), (zero, -one)),
        is_linear=True,
        where=(_AT,),
    )
    made.put("derivatives", system)
    model = emitted(made.solved())
    for before in (0.0, math.nan, 1e300):
        model.start()
        model.set({Symbol("u"): 5.0, Symbol("x"): before, Symbol("y"): before, Symbol("z"): before})
        assert model.call("derivatives") == 0
        assert [model.get(Symbol(name)) for name in "xyz"] == [3.0, -1.0, 2.0]
    model.start(p=0.0)
    code = model.call("derivatives")
    assert (
        model.text("failure", code) == "the equations at ball.mo:7 for x, y have no unique solution: they are singular"
    )


@pytest.mark.parametrize("size", [1, 2, 3, 7])
def test_linear_systems_of_every_size_are_solved(emitted: Emitter, size: int) -> None:
    made = Maker()
    unknowns = [made.variable(f"x{k}") for k in range(size)]
    entries = [[1.0 / (row + column + 1) + (row == column) for column in range(size)] for row in range(size)]
    graph = made.graph
    jacobian = tuple(tuple(graph.constant(entry) for entry in row) for row in entries)
    residuals = []
    for row in range(size):
        total = graph.constant(-float(row + 1))
        for column in range(size):
            total = total + unknowns[column] * entries[row][column]
        residuals.append(total)
    made.put("outputs", System(tuple(Symbol(f"x{k}") for k in range(size)), (), tuple(residuals), jacobian, True))
    model = emitted(made.solved())
    assert model.call("outputs") == 0
    found = [model.get(Symbol(f"x{k}")) for k in range(size)]
    for row in range(size):
        assert sum(e * x for e, x in zip(entries[row], found, strict=True)) == pytest.approx(row + 1, rel=1e-13)


def newton(made: Maker, residual: Expression, slope: Expression, *inner: Explicit) -> Solved:
    made.put("derivatives", System((Symbol("x"),), inner, (residual,), ((slope,),), False, (_AT,)))
    return made.solved()


def test_newton_finds_the_root_near_the_guess_and_computes_the_inner_variables_there(emitted: Emitter) -> None:
    made = Maker()
    u, x, q = made.variable("u", Role.INPUT), made.variable("x"), made.variable("q")
    # x^2 = u through the inner variable q = x x
    model = emitted(newton(made, q - u, 2.0 * x, explicit("q", x * x)))
    for guess, sign in ((1.0, 1.0), (-3.0, -1.0), (1e6, 1.0)):
        model.set({Symbol("u"): 2.0, Symbol("x"): guess})
        assert model.call("derivatives") == 0
        assert model.get(Symbol("x")) == pytest.approx(sign * math.sqrt(2.0), rel=1e-15)
        assert model.get(Symbol("q")) == model.get(Symbol("x")) ** 2


def test_newton_is_damped_where_the_full_step_would_leave_for_infinity(emitted: Emitter) -> None:
    made = Maker()
    x = made.variable("x")
    # From 3, the undamped iteration for atan x = 0 diverges; beyond 1.4 every full step is too long.
    slope = made.graph.constant(1.0) / (1.0 + x * x)
    model = emitted(newton(made, made.graph.make("atan", x), slope))
    for guess in (0.5, 3.0, -40.0, 1e4):
        model.set({Symbol("x"): guess})
        assert model.call("derivatives") == 0
        assert abs(model.get(Symbol("x"))) < 1e-15


def test_newton_follows_a_small_change_of_a_small_unknown(emitted: Emitter) -> None:
    made = Maker()
    u, x = made.variable("u", Role.INPUT), made.variable("x")
    # Far below the scale 1 of an unknown without nominal value.
    model = emitted(newton(made, x + x * x - u, 1.0 + 2.0 * x))
    for u_now in (1e-13, 1.1e-13, 0.0):
        model.set({Symbol("u"): u_now})
        assert model.call("derivatives") == 0
        assert model.get(Symbol("x")) == pytest.approx(u_now, rel=1e-9, abs=1e-25)


def test_a_system_without_solution_fails_by_name_and_leaves_the_unknowns(emitted: Emitter) -> None:
    made = Maker()
    x = made.variable("x")
    model = emitted(newton(made, x * x + 1.0, 2.0 * x))
    model.set({Symbol("x"): 0.7})
    code = model.call("derivatives")
    expected = "the equations at ball.mo:7 for x cannot be solved: Newton's method finds no solution"
    assert model.text("failure", code) == expected
    assert model.get(Symbol("x")) == 0.7


def test_a_system_too_large_and_a_clock_too_fine_are_refused() -> None:
    made = Maker()
    graph = made.graph
    unknowns = [made.variable(f"x{k}") for k in range(129)]
    jacobian = tuple(tuple(graph.constant(float(r == c)) for c in range(129)) for r in range(129))
    symbols = tuple(Symbol(f"x{k}") for k in range(129))
    made.put("outputs", System(symbols, (), tuple(unknowns), jacobian, True, (_AT,)))
    solved = made.solved()
    with pytest.raises(DseError, match="129 equations depend on each other"):
        emit(solved, variables(solved), "")
    fine = Maker()
    fine.flat = {"clocks": (Clock(Fraction(1, 3**30), Fraction(0)),)}
    solved = fine.solved()
    with pytest.raises(DseError, match="cannot be counted exactly"):
        emit(solved, variables(solved), "")
