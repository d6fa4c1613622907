from __future__ import annotations

import numpy as np
import pytest
from modelica.structure.interpreter import Building, Machine, check_order, symbol
from scipy.integrate import solve_ivp

from dse.errors import DseError
from dse.modelica.flat_model import Reinitialization, Trigger
from dse.modelica.structure.solve import solve


def geared_inertias(**second: object) -> Building:
    """Two inertias joined by a gear: w1 = 3 w2 (index 3 in the angles)."""
    b = Building()
    j1, j2, ratio = b.parameter("j1", 0.5), b.parameter("j2", 4.0), b.parameter("ratio", 3.0)
    phi1, phi2, w1, w2, a1, a2, t1, t2 = b.reals("phi1 phi2 w1 w2 a1 a2 t1 t2")
    b.variables["phi2"] = type(b.variables["phi2"])(
        **{**{f: getattr(b.variables["phi2"], f) for f in b.variables["phi2"].__slots__}, **second}
    )
    b.equal(b.der("phi1"), w1)
    b.equal(b.der("w1"), a1)
    b.equal(b.der("phi2"), w2)
    b.equal(b.der("w2"), a2)
    b.equal(j1 * a1, 2.0 - 0.1 * w1 - t1)
    b.equal(j2 * a2, t2)
    b.equal(phi1, ratio * phi2)
    b.equal(t2, ratio * t1)
    return b


def test_inertias_joined_by_a_gear_move_as_one() -> None:
    solved = solve(geared_inertias().flat())
    check_order(solved)
    assert len(solved.states) == 2
    found = Machine(solved).simulate(5.0, ["w1", "w2", "phi1", "phi2"])
    times = np.linspace(0, 5, 21)
    inertia = 0.5 + 4.0 / 9
    w1 = 20 * (1 - np.exp(-0.1 / inertia * times))
    assert np.allclose(found[:, 0], w1, atol=1e-8)
    assert np.allclose(found[:, 1], w1 / 3, atol=1e-8)
    phi1 = 20 * (times - inertia / 0.1 * (1 - np.exp(-0.1 / inertia * times)))
    assert np.allclose(found[:, 2], phi1, atol=1e-7)
    assert np.allclose(found[:, 3], phi1 / 3, atol=1e-7)


def test_state_select_chooses_the_side_of_the_gear() -> None:
    b = geared_inertias(prefers_state=1)
    solved = solve(b.flat())
    assert symbol("phi2") in solved.states
    assert symbol("phi1") not in solved.states


def test_a_start_through_the_gear_reaches_the_state() -> None:
    b = geared_inertias(start=None)
    graph = b.graph
    old = b.variables["phi2"]
    fields = {name: getattr(old, name) for name in old.__slots__} | {"start": graph.constant(0.7), "is_fixed": True}
    b.variables["phi2"] = type(old)(**fields)
    machine = Machine(solve(b.flat()))
    machine.start()
    assert machine.value("phi1") == pytest.approx(2.1, rel=1e-14)


def test_states_that_cannot_all_be_states_are_refused() -> None:
    b = geared_inertias(prefers_state=2)
    old = b.variables["phi1"]
    b.variables["phi1"] = type(old)(**{name: getattr(old, name) for name in old.__slots__} | {"prefers_state": 2})
    with pytest.raises(DseError, match=r"stateSelect\.always"):
        solve(b.flat())


def test_a_loop_of_capacitors_has_one_state_less() -> None:
    """Source through R on C1; C2 and C3 in series parallel to C1: u1 = u2 + u3 (index 2)."""
    b = Building()
    u1, u2, u3, i1, i2, i = b.reals("u1 u2 u3 i1 i2 i")
    c1, c2, c3, r = b.parameter("c1", 1.0), b.parameter("c2", 2.0), b.parameter("c3", 3.0), b.parameter("r", 0.5)
    b.equal(c1 * b.der("u1"), i1)
    b.equal(c2 * b.der("u2"), i2)
    b.equal(c3 * b.der("u3"), i2)
    b.equal(u1, u2 + u3)
    b.equal(i, i1 + i2)
    b.equal(10.0 - u1, r * i)
    solved = solve(b.flat())
    check_order(solved)
    assert len(solved.states) == 2
    found = Machine(solved).simulate(2.0, ["u1", "u2", "u3"])
    times = np.linspace(0, 2, 21)
    whole = 1 + 1 / (1 / 2 + 1 / 3)
    u = 10 * (1 - np.exp(-times / (0.5 * whole)))
    assert np.allclose(found[:, 0], u, atol=1e-8)
    assert np.allclose(found[:, 1], u * 3 / 5, atol=1e-8)
    assert np.allclose(found[:, 2], u * 2 / 5, atol=1e-8)


def cartesian_pendulum(**more: object) -> Building:
    b = Building()
    x = b.real("x", start=0.6, is_fixed=True, **more)
    y, vx, vy, tension = b.real("y", start=-0.8), *b.reals("vx vy tension")
    b.equal(b.der("x"), vx)
    b.equal(b.der("y"), vy)
    b.equal(b.der("vx"), -(tension * x))
    b.equal(b.der("vy"), -(tension * y) - 9.81)
    b.equal(x * x + y * y, 1.0)
    return b


@pytest.mark.thorough
def test_a_pendulum_in_cartesian_coordinates_is_right_while_its_states_hold() -> None:
    solved = solve(cartesian_pendulum(prefers_state=2).flat())
    check_order(solved)
    assert len(solved.states) == 2
    found = Machine(solved).simulate(1.0, ["x", "y", "vx"])
    angle = solve_ivp(
        lambda _, s: [s[1], -9.81 * np.sin(s[0])],
        (0, 1),
        [np.arcsin(0.6), 0],
        rtol=1e-12,
        atol=1e-12,
        t_eval=np.linspace(0, 1, 21),
    ).y
    assert np.allclose(found[:, 0], np.sin(angle[0]), atol=1e-7)
    assert np.allclose(found[:, 1], -np.cos(angle[0]), atol=1e-7)


def test_a_pendulum_selects_one_of_two_states_during_the_run() -> None:
    solved = solve(cartesian_pendulum().flat())
    check_order(solved)
    (selection,) = solved.selections
    assert set(selection.candidates) == {symbol("x"), symbol("y")}
    assert (selection.rows, selection.levels, selection.never) == (1, 2, 0)
    (state,) = selection.states
    assert set(solved.states) == {symbol(state), symbol(state, 1)}


def test_a_state_that_must_be_one_and_one_that_must_not_are_not_selected() -> None:
    for wanted in ({"prefers_state": 2}, {"prefers_state": -2}):
        (selection,) = solve(cartesian_pendulum(**wanted).flat()).selections
        is_state = wanted["prefers_state"] == 2
        assert selection.candidates[: selection.rows] == ((symbol("y"),) if is_state else (symbol("x"),))
        assert selection.never == (0 if is_state else 1)
        assert len(selection.candidates) == (1 if is_state else 2)


def test_a_rate_that_is_set_anew_keeps_its_variable_as_a_state() -> None:
    b = cartesian_pendulum()
    b.more["triggers"] = (Trigger(at_start=True),)
    b.more["reinitializations"] = (Reinitialization("vx", b.graph.constant(1.0), 0),)
    solved = solve(b.flat())
    assert {symbol("x"), symbol("vx")} == set(solved.states)
    assert solved.selections[0].candidates == (symbol("y"),)


def test_what_never_vanishes_is_eliminated_before_states_are_selected() -> None:
    """A slider-crank: the joint's coordinates and the slider follow from the angles, which have one equation."""
    b = Building()
    phi, psi, s, x, y = b.real("phi", start=0.3), *b.reals("psi s x y")
    for name in ("phi", "psi", "s"):
        b.equal(b.der(name), b.real("w_" + name))
    sin, cos = (lambda one, operator=operator: b.graph.make(operator, one) for operator in ("sin", "cos"))
    f, g = b.reals("f g")
    b.equal(x, cos(phi))
    b.equal(y, sin(phi))
    b.equal(s, x + 3.0 * cos(psi))
    b.equal(y, 3.0 * sin(psi))
    b.equal(b.der("w_phi"), f * y)
    b.equal(b.der("w_psi"), g)
    b.equal(b.der("w_s"), f - 1.0)
    (selection,) = solve(b.flat()).selections
    assert selection.rows == 1
    assert {one.name for one in selection.candidates} == {"phi", "psi"}


def test_an_input_that_would_have_to_be_differentiated_is_refused_by_name() -> None:
    b = Building()
    speed = b.input("speed")
    w, torque = b.reals("w torque")
    b.equal(2.0 * b.der("w"), torque)
    b.equal(w + 0.0 * torque, 3.0 * speed)
    with pytest.raises(DseError, match="derivative of the input 'speed'"):
        solve(b.flat())


def test_a_prescribed_motion_is_differentiated() -> None:
    b = Building()
    s, v, a, f = b.reals("s v a f")
    b.equal(b.der("s"), v)
    b.equal(b.der("v"), a)
    b.equal(3.0 * a, f)
    b.equal(s, b.graph.make("sin", 2.0 * b.time))
    solved = solve(b.flat())
    assert solved.states == ()
    found = Machine(solved).simulate(2.0, ["f", "v"])
    times = np.linspace(0, 2, 21)
    assert np.allclose(found[:, 0], -12 * np.sin(2 * times), atol=1e-12)
    assert np.allclose(found[:, 1], 2 * np.cos(2 * times), atol=1e-12)


def test_masses_in_a_row_of_rigid_rods_have_one_motion() -> None:
    b = Building()
    count = 40
    b.real("s0", start=0.0, is_fixed=True)
    for k in range(count):
        b.reals(f"s{k} v{k} f{k}" if k else "v0 f0")
    b.equal(b.graph.variable("f0"), 5.0)
    for k in range(count):
        s, v, f = (b.graph.variable(f"{one}{k}") for one in "svf")
        b.equal(b.der(f"s{k}"), v)
        following = b.graph.variable(f"f{k + 1}") if k + 1 < count else b.graph.constant(0.0)
        b.equal(2.0 * b.der(f"v{k}"), f - following)
        if k + 1 < count:
            b.equal(b.graph.variable(f"s{k + 1}") - s, 0.5)
    solved = solve(b.flat())
    check_order(solved)
    assert len(solved.states) == 2
    found = Machine(solved).simulate(2.0, ["s0", f"s{count - 1}", f"f{count - 1}"], points=3)
    acceleration = 5.0 / (2 * count)
    assert np.allclose(found[-1], [acceleration * 2, acceleration * 2 + 0.5 * (count - 1), 2 * acceleration], rtol=1e-9)
