from __future__ import annotations

import math

import pytest
from modelica.structure.interpreter import Building, Machine, check_order, symbol

from dse.errors import DseError
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.flat_model import Assignment, Trigger
from dse.modelica.structure.solve import solve


def started(b: Building) -> Machine:
    solved = solve(b.flat())
    check_order(solved)
    machine = Machine(solved)
    machine.start()
    machine.run(solved.outputs)
    return machine


def test_steady_state_equations_find_the_resting_point() -> None:
    b = Building()
    x, y = b.real("x", start=1.0), b.real("y", start=1.0)
    b.equal(b.der("x"), 3.0 - x - y)
    b.equal(b.der("y"), x - y * y)
    b.at_start(b.der("x"), 0.0)
    b.at_start(b.der("y"), 0.0)
    machine = started(b)
    expected = (math.sqrt(13) - 1) / 2
    assert machine.value("y") == pytest.approx(expected, rel=1e-12)
    assert machine.value("x") == pytest.approx(3 - expected, rel=1e-12)


def test_a_parameter_that_is_not_fixed_follows_from_an_initial_equation() -> None:
    b = Building()
    gain = b.real("unused")
    b.equal(gain, 0.0)
    gain = b.parameter("gain", 1.0, is_fixed=False)
    double = b.parameter("double", 0.0, binding=None)
    b.variables["double"] = type(b.variables["double"])(
        "double", b.variables["double"].kind, b.variables["double"].role, binding=2.0 * gain, is_fixed=True
    )
    x = b.real("x", start=2.0, is_fixed=True)
    b.equal(b.der("x"), double - x)
    b.at_start(b.der("x"), 0.0)
    machine = started(b)
    assert machine.value("gain") == pytest.approx(1.0, rel=1e-14)
    assert machine.value("double") == pytest.approx(2.0, rel=1e-14)


def test_what_is_missing_is_taken_from_the_states_starts_and_noted() -> None:
    b = Building()
    x = b.real("x", start=4.0)
    b.equal(b.der("x"), -x)
    machine = started(b)
    assert machine.value("x") == 4.0
    assert machine.solved.notes == ("x starts at 4: nothing else determines it at the start",)


def test_a_start_of_what_is_no_state_is_used_before_a_state_without_one() -> None:
    b = Building()
    x, y, t = b.real("x"), b.real("y", start=6.0), b.real("t")
    b.equal(b.der("x"), t)
    b.equal(b.der("y"), 3.0 * t - 0.1 * y)
    b.equal(y, 2.0 * x + b.time)
    machine = started(b)
    assert machine.value("x") == pytest.approx(3.0)


def test_a_fixed_start_of_an_eliminated_variable_is_kept() -> None:
    b = Building()
    x, y = b.real("x", start=1.0), b.real("y", start=-7.0, is_fixed=True)
    b.equal(b.der("x"), -x)
    b.equal(x + y, 0.0)
    machine = started(b)
    assert machine.solved.aliases == {"y": (symbol("x"), -1)}
    assert machine.value("x") == 7.0
    assert machine.value("y") == -7.0


def test_two_fixed_starts_of_one_quantity_are_refused() -> None:
    b = Building()
    x, y = b.real("x", start=1.0, is_fixed=True), b.real("y", start=2.0, is_fixed=True)
    b.equal(b.der("x"), -x)
    b.equal(x, y)
    with pytest.raises(DseError, match="one quantity, but both have a fixed start"):
        solve(b.flat())


def test_a_superfluous_condition_becomes_a_check() -> None:
    b = Building()
    ratio = b.parameter("ratio", 3.0)
    x, y = b.real("x", start=1.0, is_fixed=True), b.real("y", start=3.0, is_fixed=True)
    t = b.real("t")
    b.equal(b.der("x"), t)
    b.equal(b.der("y"), 2.0 * t - x)
    b.equal(y, ratio * x)
    machine = started(b)
    (check,) = machine.solved.flat.checks
    assert check.trigger == 0
    assert machine.solved.flat.triggers == (Trigger(at_start=True),)
    assert evaluate([check.condition], machine.of) == [1.0]
    machine.values[symbol("ratio")] = 3.01
    machine.start()
    assert evaluate([check.condition], machine.of) == [0.0]


def test_a_discrete_variable_takes_the_value_of_its_initial_equation() -> None:
    b = Building()
    mode, x = b.discrete("mode", start=1.0), b.real("x", start=5.0, is_fixed=True)
    b.equal(b.der("x"), -(mode * x))
    b.at_start(mode, 2.0 * x)
    b.more = {"triggers": (Trigger(),), "assignments": (Assignment("mode", b.graph.constant(3.0), 0),)}
    machine = started(b)
    assert machine.value("mode") == 10.0


def test_a_discrete_variable_that_only_appears_in_an_initial_equation_keeps_its_start() -> None:
    b = Building()
    level, x = b.discrete("level", start=3.0), b.real("x", start=5.0)
    b.equal(b.der("x"), -x)
    b.at_start(x, level)
    machine = started(b)
    assert machine.value("x") == 3.0


def test_initial_is_true_at_the_start_only() -> None:
    from dse.modelica.algebra.symbol import Referent, Symbol

    b = Building()
    x, y = b.real("x", start=0.0, is_fixed=True), b.real("y")
    b.equal(b.der("x"), 1.0)
    b.equal(y, b.graph.make("if", b.graph.symbol(Symbol(referent=Referent.INITIAL)), b.graph.constant(7.0), x))
    solved = solve(b.flat())
    machine = Machine(solved)
    assert machine.simulate(1.0, ["y"], points=2)[-1, 0] == pytest.approx(1.0)
    assert any(getattr(block, "value", None) is b.graph.constant(7.0) for block in solved.initial)


def test_parameters_that_depend_on_each_other_are_refused() -> None:
    b = Building()
    graph = b.graph
    b.parameter("p", 0.0)
    b.parameter("q", 0.0)
    for name, other in (("p", "q"), ("q", "p")):
        old = b.variables[name]
        b.variables[name] = type(old)(name, old.kind, old.role, binding=graph.variable(other) + 1.0, is_fixed=True)
    with pytest.raises(DseError, match="parameters depend on themselves: p, q"):
        solve(b.flat())


def test_dependent_parameters_are_computed_in_order() -> None:
    b = Building()
    graph = b.graph
    for name, binding in (("c", graph.variable("b") * 2.0), ("b", graph.variable("a") + 1.0)):
        b.parameter(name, 0.0)
        old = b.variables[name]
        b.variables[name] = type(old)(name, old.kind, old.role, binding=binding, is_fixed=True)
    b.parameter("a", 4.0)
    x = b.real("x")
    b.equal(x, 3.0 * b.graph.variable("c"))
    assert started(b).value("x") == 30.0
