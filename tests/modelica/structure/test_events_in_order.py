from __future__ import annotations

import math
from fractions import Fraction

import numpy as np
import pytest
from modelica.structure.interpreter import Building, Machine, check_order

from dse.errors import DseError
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flat_model import Assignment, Clock, Reinitialization, Relation, Trigger
from dse.modelica.structure.solve import solve


def pre(b: Building, name: str):
    return b.graph.symbol(Symbol(name, referent=Referent.PRE))


def test_a_bouncing_ball_bounces_when_it_should() -> None:
    b = Building()
    h, v = b.real("h", start=1.0, is_fixed=True), b.real("v", start=0.0, is_fixed=True)
    count = b.discrete("count")
    b.equal(b.der("h"), v)
    b.equal(b.der("v"), -9.81)
    b.relations = [Relation(b.graph.make("less", h, b.graph.constant(0.0)))]
    b.more = {
        "triggers": (Trigger((b.held(0),)),),
        "assignments": (Assignment("count", pre(b, "count") + 1.0, 0),),
        "reinitializations": (Reinitialization("v", -0.8 * pre(b, "v"), 0),),
    }
    del count
    solved = solve(b.flat())
    check_order(solved)
    found = Machine(solved).simulate(1.0, ["h", "count"], points=11)
    first = math.sqrt(2 / 9.81)
    speed = 0.8 * math.sqrt(2 * 9.81)
    late = np.linspace(0, 1, 11)[-1] - first
    assert found[-1, 1] == 1
    assert found[-1, 0] == pytest.approx(speed * late - 9.81 * late**2 / 2, abs=1e-8)


def test_discrete_and_continuous_equations_are_sorted_together() -> None:
    """The controller's output reads the sampled value, which reads the plant's output of the same instant."""
    b = Building()
    x, y, u = b.real("x", start=1.0, is_fixed=True), b.real("y"), b.real("u")
    sampled, drive = b.discrete("sampled"), b.discrete("drive")
    b.equal(u, drive + 1.0)
    b.equal(y, 2.0 * x)
    b.equal(b.der("x"), u)
    b.more = {
        "clocks": (Clock(Fraction(1, 10), Fraction(0)),),
        "triggers": (Trigger(clocks=(0,)),),
        "assignments": (Assignment("drive", -3.0 * sampled, 0), Assignment("sampled", y, 0)),
    }
    solved = solve(b.flat())
    check_order(solved)
    found = Machine(solved).simulate(0.5, ["x"], points=6)[:, 0]
    expected = [1.0]
    for _ in range(5):
        expected.append(expected[-1] + 0.1 * (1 - 6 * expected[-1]))
    assert np.allclose(found, expected, rtol=1e-12)


def test_a_loop_through_discrete_equations_is_refused() -> None:
    b = Building()
    p, q = b.discrete("p"), b.discrete("q")
    b.more = {"assignments": (Assignment("p", q + 1.0), Assignment("q", p * 2.0))}
    with pytest.raises(DseError, match=r"depend on themselves: p, q\n.*break the loop with pre"):
        solve(b.flat())


def test_a_loop_broken_by_a_held_relation_is_none() -> None:
    b = Building()
    x = b.real("x", start=0.0, is_fixed=True)
    on = b.discrete("on", start=1.0)
    b.equal(b.der("x"), b.graph.make("if", on, b.graph.constant(1.0), b.graph.constant(-1.0)))
    graph = b.graph
    b.relations = [
        Relation(graph.make("less", x, graph.constant(0.5))),
        Relation(graph.make("greater", x, graph.constant(1.0))),
    ]
    stay = graph.make("and", pre(b, "on"), graph.make("not", b.held(1)))
    b.more = {"assignments": (Assignment("on", graph.make("or", b.held(0), stay)),)}
    found = Machine(solve(b.flat())).simulate(2.0, ["x", "on"], points=9)
    expected = [0, 0.25, 0.5, 0.75, 1, 0.75, 0.5, 0.75, 1]
    assert np.allclose(found[:, 0], expected, atol=1e-9)


def test_a_reinit_of_what_is_no_state_is_refused() -> None:
    b = Building()
    x, y = b.real("x", start=1.0, is_fixed=True), b.real("y")
    b.equal(b.der("x"), -x)
    b.equal(y, 2.0 * x + 1.0)
    b.relations = [Relation(b.graph.make("less", x, b.graph.constant(0.5)))]
    b.more = {
        "triggers": (Trigger((b.held(0),)),),
        "reinitializations": (Reinitialization("y", b.graph.constant(1.0), 0),),
    }
    with pytest.raises(DseError, match="reinit of 'y', which is not a state"):
        solve(b.flat())


def test_what_is_set_anew_becomes_the_state() -> None:
    b = Building()
    x, y, t = b.real("x", start=1.0), b.real("y", start=2.0), b.real("t")
    b.equal(b.der("x"), t)
    b.equal(b.der("y"), 3.0 * t - y)
    b.equal(y, 2.0 * x)
    b.relations = [Relation(b.graph.make("less", x, b.graph.constant(0.5)))]
    for name in ("x", "y"):
        b.more = {
            "triggers": (Trigger((b.held(0),)),),
            "reinitializations": (Reinitialization(name, b.graph.constant(1.0), 0),),
        }
        assert [state.name for state in solve(b.flat()).states] == [name]


def two_states(value_of_x: str, assigned: str | None = None) -> Building:
    b = Building()
    x, w = b.real("x", start=1.0, is_fixed=True), b.real("w", start=2.0, is_fixed=True)
    double = b.real("double")
    b.equal(b.der("x"), -w)
    b.equal(b.der("w"), -x)
    b.equal(double, 2.0 * w)
    seen = b.discrete("seen")
    del seen
    b.relations = [Relation(b.graph.make("less", x, b.graph.constant(0.5)))]
    value = pre(b, "w") if value_of_x == "pre" else b.graph.variable(value_of_x)
    b.more = {
        "triggers": (Trigger((b.held(0),)),),
        "reinitializations": (Reinitialization("x", value, 0), Reinitialization("w", -(b.graph.variable("w")), 0)),
        "assignments": (Assignment("seen", b.graph.variable(assigned), 0),) if assigned else (),
    }
    return b


@pytest.mark.parametrize("read", ["w", "double"])
def test_a_reinit_that_reads_another_state_set_anew_is_refused(read: str) -> None:
    with pytest.raises(DseError, match=r"the new value of 'x' is read from 'w'.*\n.*write pre\(w\)"):
        solve(two_states(read).flat())


def test_a_when_that_reads_a_state_set_anew_is_refused() -> None:
    with pytest.raises(DseError, match="'seen' is read from 'w', which is set anew"):
        solve(two_states("pre", "double").flat())


def test_pre_values_of_states_may_be_read_in_a_reinit() -> None:
    assert solve(two_states("pre").flat()).states


def test_dependencies_reach_through_discrete_variables() -> None:
    b = Building()
    u, other = b.input("u"), b.input("other")
    del other
    x, y = b.real("x", start=0.0, is_fixed=True), b.real("y", is_output=True)
    gear = b.discrete("gear", is_output=True)
    b.equal(b.der("x"), -x)
    b.equal(y, 2.0 * gear)
    b.relations = [Relation(b.graph.make("less", u, b.graph.constant(0.5)))]
    b.more = {"assignments": (Assignment("gear", b.held(0)),)}
    solved = solve(b.flat())
    assert solved.dependencies == {"y": {"u"}, "gear": {"u"}, "der(x)": {"x"}}
