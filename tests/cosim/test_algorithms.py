from __future__ import annotations

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, event, given, settings, strategies as st
from linear_fmus import Linear, system
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.method import Adaptive, Algorithm, Bond, Coupling, Extrapolation, Method
from dse.errors import DseError


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("linear")


def outcome(run):
    try:
        return run().tobytes()
    except RunFailed as failure:
        return failure.what, failure.element, failure.time
    except DseError as refused:
        return str(refused)


def both(made, record, method, *, stop=0.8, step=0.1):
    """The waveforms, or what went wrong: the same from the kernel (fresh, reset proved, reset) and the reference."""
    slow = outcome(lambda: run_reference(made, record, stop=stop, step=step, method=method))
    if isinstance(slow, str):
        with pytest.raises(DseError) as refused:
            simulated(made, record, method, stop, step)
        assert str(refused.value) == slow
        return slow
    with Simulator(made, record, method=method) as simulator:
        for _ in range(3):
            assert outcome(lambda: simulator.run(stop=stop, step=step)) == slow
    return np.frombuffer(slow).reshape(-1, len(record)) if isinstance(slow, bytes) else slow


def simulated(made, record, method, stop, step):
    with Simulator(made, record, method=method) as simulator:
        return simulator.run(stop=stop, step=step)


NAMES = ("a", "b", "c")
numbers = st.sampled_from([-1.5, -1.0, -0.5, -0.25, 0.25, 0.5, 1.0, 2.0])
sparse = st.one_of(st.just(0.0), st.just(0.0), numbers)


def matrix(rows, columns, entries):
    return st.lists(st.lists(entries, min_size=columns, max_size=columns), min_size=rows, max_size=rows)


@st.composite
def linear_elements(draw):
    return Linear(
        draw(matrix(2, 2, sparse)),
        draw(matrix(2, 2, sparse)),
        draw(matrix(2, 2, numbers)),
        draw(matrix(2, 2, sparse)),
        draw(st.lists(numbers, min_size=2, max_size=2)),
        version=draw(st.sampled_from([2, 3])),
        tells=draw(st.booleans()),
        takes_slopes=draw(st.booleans()),
        parts=draw(st.integers(1, 2)),
    )


@st.composite
def systems(draw):
    elements = {name: draw(linear_elements()) for name in NAMES[: draw(st.integers(1, 3))]}
    outputs = [f"{name}.y{i}" for name in elements for i in range(2)]
    wires = []
    for name in elements:
        for i in range(2):
            source = draw(st.one_of(st.none(), st.sampled_from(outputs)))
            if source:
                wires.append(f"{source} -> {name}.u{i}")
    return elements, wires


def bonds_in(wires):
    """Pairs of outputs that are each an input of the other's element."""
    ends = [[end.split(".") for end in wire.split(" -> ")] for wire in wires]
    pairs = [(s, t) for s, u in product(ends, ends) for t in [u] if s[0][0] == u[1][0] and u[0][0] == s[1][0]]
    return sorted({(".".join(s[0]), ".".join(t[0])) for s, t in pairs})


@st.composite
def methods(draw, names, wires):
    steps = {}
    found = bonds_in(wires)
    chosen = draw(st.lists(st.sampled_from(found), max_size=2)) if found else []
    bonds = tuple(Bond(f"bond{i}", *pair) for i, pair in enumerate(chosen))
    adaptive = draw(st.one_of(st.none(), st.none(), st.builds(Adaptive, st.sampled_from([1e-1, 1e-2]), st.just(1e-2))))
    if not adaptive:
        steps = draw(st.dictionaries(st.sampled_from(names), st.sampled_from([0.1, 0.2, 0.4, 0.05, 0.1 / 3])))
    return Method(
        draw(st.sampled_from(Algorithm)),
        draw(st.sampled_from(Coupling)),
        draw(st.sampled_from(Extrapolation)),
        draw(st.dictionaries(st.sampled_from(names), st.sampled_from(Extrapolation))),
        steps,
        adaptive and replace(adaptive, smallest=0.005),
        bonds,
        tuple(names[: draw(st.sampled_from([0, 0, 0, 1, 2]))]),
    )


@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_any_method_on_any_system_gives_the_same_bits_or_the_same_failure(folder, data):
    elements, wires = data.draw(systems())
    method = data.draw(methods(sorted(elements), wires))
    factors = data.draw(st.dictionaries(st.sampled_from(wires), st.sampled_from([-1.0, 0.5]))) if wires else {}
    made = system(elements, wires, folder, factors)
    outputs = [f"{name}.y{i}" for name in elements for i in range(2)]
    found = both(made, [*outputs, *(f"bonds.{bond.name}" for bond in method.bonds)], method)
    event("simulated" if isinstance(found, np.ndarray) else "failed" if isinstance(found, tuple) else "refused")


# ---- what the algorithms mean, by hand ----


def adder(a: float, b: float, x: float, **options) -> Linear:
    """Over a step of length 1: x' = a x + b u, exactly, since its derivative does not depend on x (a must be 1)."""
    assert a == 1.0
    return Linear([[0.0]], [[b]], [[1.0]], (), [x], **options)


def rows(made, record, method, **times):
    found = both(made, record, method, **times)
    assert isinstance(found, np.ndarray), found
    return found.tolist()


RING = ["a.y0 -> b.u0", "b.y0 -> a.u0"]


def test_gauss_seidel_gives_the_second_element_what_the_first_has_just_found(folder):
    made = system({"a": adder(1, 1, 1.0), "b": adder(1, 1, 0.0)}, RING, folder)
    record = ["a.y0", "b.y0"]
    assert rows(made, record, Method(), stop=2, step=1) == [[1, 0], [1, 1], [2, 2]]
    assert rows(made, record, Method(Algorithm.GAUSS_SEIDEL), stop=2, step=1) == [[1, 0], [1, 1], [2, 3]]


def test_the_others_take_what_a_leading_element_shows_for_the_same_step(folder):
    ramp = Linear([[0.0, 1.0], [0.0, 0.0]], (), [[1.0, 0.0]], (), [0.0, 1.0])
    made = system({"r": ramp, "a": adder(1, 1, 0.0)}, ["r.y0 -> a.u0"], folder)
    record = ["r.y0", "a.y0"]
    assert rows(made, record, Method(), stop=3, step=1) == [[0, 0], [1, 0], [2, 1], [3, 3]]
    assert rows(made, record, Method(leading=("r",)), stop=3, step=1) == [[0, 0], [1, 1], [2, 3], [3, 6]]
    # What is shown at t = 0, 1, 2 is 1, 2, 3: over these steps the line through the last two adds half a step's rise.
    linear = Method(leading=("r",), extrapolation=Extrapolation.LINEAR)
    assert rows(made, record, linear, stop=3, step=1) == [[0, 0], [1, 1], [2, 3.5], [3, 7]]


def test_what_leads_comes_first_and_with_nothing_that_needs_values_between_two_steps(folder):
    made = system({"a": adder(1, 1, 1.0), "b": adder(1, 1, 0.0)}, RING, folder)
    refused = both(made, ["a.y0"], Method(leading=("b",)))
    assert "b: what leads is not what the system has first, a" in refused
    for other, what in (
        ({"coupling": Coupling.SOLVE}, "coupling"),
        ({"adaptive": Adaptive()}, "an adaptive step"),
        ({"steps": {"a": 0.2}}, "a step of its own"),
        ({"bonds": (Bond("swing", "a.y0", "b.y0"),)}, "a bond"),
    ):
        assert f"a: what leads does not go together with {what}" in both(made, [], Method(leading=("a",), **other))


def test_an_element_with_a_longer_step_holds_what_it_shows_and_takes_inputs_at_its_beginning(folder):
    made = system({"fast": adder(1, 1, 1.0), "slow": adder(1, 1, 0.0)}, ["fast.y0 -> slow.u0"], folder)
    made = replace(made, elements=tuple(replace(e, start={**e.start, "u0": 1.0}) for e in made.elements))
    found = rows(made, ["fast.y0", "slow.y0"], Method(steps={"slow": 2.0}), stop=4, step=1)
    # slow: at t = 0 it takes 1 and shows 0 + 2 * 1 at t = 2; there it takes 3 and shows 2 + 2 * 3 at t = 4
    assert found == [[1, 0], [2, 0], [3, 2], [4, 2], [5, 8]]
    with Simulator(made, [], method=Method(steps={"slow": 2.0})) as simulator:
        with pytest.raises(DseError, match=r"slow: the stop time of 3 s is not a whole number of its steps of 2 s"):
            simulator.run(stop=3, step=1)
        with pytest.raises(DseError, match=r"slow: its step of 2 s is neither a whole multiple nor a whole fraction"):
            simulator.run(stop=3, step=1.5)


def test_an_element_with_a_shorter_step_sees_its_input_move_within_the_run_s_step(folder):
    # The source is a ramp, y = t; from the second step on the line through the last two points is the ramp itself.
    ramp = Linear([[0.0]], [[0.0]], [[1.0]], (), [0.0])
    ramp = replace(ramp, a=[[0.0, 1.0], [0.0, 0.0]], c=[[1.0, 0.0]], x=[0.0, 1.0])
    for takes_slopes in (False, True):
        elements = {"ramp": ramp, "sum": adder(1, 1, 0.0, takes_slopes=takes_slopes)}
        made = system(elements, ["ramp.y0 -> sum.u0"], folder)
        for steps in ({}, {"sum": 0.25}):
            held = rows(made, ["sum.y0"], Method(steps=steps), stop=3, step=1)
            assert held == [[0], [0], [1], [3]]
            moved = rows(made, ["sum.y0"], Method(extrapolation=Extrapolation.LINEAR, steps=steps), stop=3, step=1)
            assert moved == [[0], [0], [1.5], [4]]  # 0, then the integral of t from 1 to 2, to 3: 3/2, 4


def test_single_elements_can_be_extrapolated_otherwise_than_the_rest(folder):
    ramp = Linear([[0.0, 1.0], [0.0, 0.0]], (), [[1.0, 0.0]], (), [0.0, 1.0])
    made = system({"r": ramp, "a": adder(1, 1, 0.0), "b": adder(1, 1, 0.0)}, ["r.y0 -> a.u0", "r.y0 -> b.u0"], folder)
    method = Method(extrapolations={"b": Extrapolation.LINEAR})
    assert rows(made, ["a.y0", "b.y0"], method, stop=2, step=1) == [[0, 0], [0, 0], [1, 1.5]]


def test_propagation_shows_outputs_that_follow_the_inputs_of_now(folder):
    made = system({"gain": Linear((), (), (), [[2.0]]), "a": adder(1, 0, 3.0)}, ["a.y0 -> gain.u0"], folder)
    made = replace(made, elements=tuple(replace(e, start={**e.start, "B0": 1.0, "u0": 1.0}) for e in made.elements))
    record = ["a.y0", "gain.y0"]
    assert rows(made, record, Method(), stop=2, step=1) == [[3, 6], [4, 6], [5, 8]]
    assert rows(made, record, Method(coupling=Coupling.PROPAGATE), stop=2, step=1) == [[3, 6], [4, 8], [5, 10]]


def test_a_loop_is_solved_at_every_communication_point(folder):
    # a = -b + t, b = a: without solving, each sees the other one step late and the two swing.
    ramp = Linear([[0.0, 1.0], [0.0, 0.0]], (), [[1.0, 0.0]], (), [0.0, 1.0])
    elements = {"t": ramp, "a": Linear((), (), (), [[-1.0, 1.0]]), "b": Linear((), (), (), [[1.0]])}
    made = system(elements, ["b.y0 -> a.u0", "t.y0 -> a.u1", "a.y0 -> b.u0"], folder)
    found = rows(made, ["a.y0", "b.y0"], Method(coupling=Coupling.SOLVE), stop=4, step=1)
    assert np.array(found) == pytest.approx(np.array([[k / 2, k / 2] for k in range(5)]), abs=1e-11)
    refused = both(made, ["a.y0"], Method(coupling=Coupling.PROPAGATE))
    assert "values cannot be propagated round an algebraic loop: a.y0 -> b.u0, b.y0 -> a.u0" in refused
    assert "use coupling: solve" in refused


def test_the_energy_of_a_bond_is_what_the_coupling_adds(folder):
    # Two integrators a' = b, b' = -a exchange power a b; by hand: h (a_used b - a b_used), outputs on average, summed.
    elements = {"a": adder(1, 1, 1.0), "b": adder(1, -1, 0.0)}
    made = system(elements, RING, folder)
    record = ["a.y0", "b.y0", "bonds.swing"]
    for algorithm in Algorithm:
        method = Method(algorithm, bonds=(Bond("swing", "a.y0", "b.y0"),))
        found = np.array(rows(made, record, method, stop=1, step=0.1))
        a, b, energy = found.T
        a_used, b_used = (a[:-1], b[:-1]) if algorithm is Algorithm.JACOBI else (a[1:], b[:-1])
        a_mean, b_mean = (a[1:] + a[:-1]) / 2, (b[1:] + b[:-1]) / 2
        by_hand = np.concatenate([[0.0], np.cumsum(0.1 * (a_used * b_mean - a_mean * b_used))])
        assert energy == pytest.approx(by_hand, abs=1e-15)


@pytest.mark.parametrize("extrapolation", Extrapolation)
@pytest.mark.parametrize("algorithm", Algorithm)
@pytest.mark.parametrize(
    "other",
    [{}, {"adaptive": Adaptive(1e-2, 1e-2)}, {"steps": {"mass": 0.1}}, {"steps": {"spring": 0.1, "mass": 0.025}}],
    ids=["fixed", "adaptive", "longer", "longer and shorter"],
)
def test_the_energy_of_a_bond_is_what_two_bodies_have_lost_by_being_coupled(folder, algorithm, extrapolation, other):
    # A spring (F = 4 x, x' = v) and a mass of 1 (v' = -F): energy F^2/8 + v^2/2 would stay. Over any step it changes by
    # the mean force times the integral of the speed used, less the mean speed times that of the force used: exactly.
    elements = {"spring": Linear([[0.0]], [[1.0]], [[4.0]], (), [1.0]), "mass": adder(1, -1, 0.0)}
    made = system(elements, ["spring.y0 -> mass.u0", "mass.y0 -> spring.u0"], folder)
    method = Method(
        algorithm,
        extrapolation=extrapolation,
        **other,
        bonds=(Bond("swing", "spring.y0", "mass.y0"),),
    )
    found = np.array(rows(made, ["spring.y0", "mass.y0", "bonds.swing"], method, stop=2, step=0.05))
    force, speed, energy = found.T
    total = force**2 / 8 + speed**2 / 2
    assert abs(total[-1] - total[0]) > 1e-5
    # In between, an element with a longer step shows its beginning. Rounding: 40 steps, values about 4.
    assert energy[::2] == pytest.approx(total[0] - total[::2], abs=1e-12)


def test_a_loop_is_solved_between_the_points_where_one_of_its_elements_shows_anything(folder):
    # p = q / 2 + s / 10 + t, q = 3 p, and a second circle in it: s = r / 2 + p / 10, r = s / 2 + q / 10. Where one of
    # them is in the middle of its step it is known, and the rest of the loop is solved.
    elements = {
        "p": Linear([[0.0, 1.0], [0.0, 0.0]], (), [[1.0, 0.0]], [[0.5, 0.1]], [0.0, 1.0]),
        "q": Linear((), (), (), [[3.0]]),
        "r": Linear((), (), (), [[0.5, 0.1]]),
        "s": Linear((), (), (), [[0.5, 0.1]]),
    }
    wires = ["q.y0 -> p.u0", "s.y0 -> p.u1", "p.y0 -> q.u0", "s.y0 -> r.u0", "q.y0 -> r.u1", "r.y0 -> s.u0"]
    made = system(elements, [*wires, "p.y0 -> s.u1"], folder)
    for own in "pqrs":
        method = Method(coupling=Coupling.SOLVE, steps={own: 0.2})
        found = both(made, [f"{name}.y0" for name in elements], method, stop=0.8, step=0.1)
        assert isinstance(found, np.ndarray), found
        p, q, r, s = found.T
        t = np.arange(9) * 0.1
        rests = {"p": q / 2 + s / 10 + t - p, "q": 3 * p - q, "r": s / 2 + q / 10 - r, "s": r / 2 + p / 10 - s}
        for name, rest in rests.items():
            assert rest[:: 2 if name == own else 1] == pytest.approx(0.0, abs=1e-10), (own, name)


@pytest.mark.parametrize(
    ("bonds", "what"),
    [
        ((Bond("x", "a.y9", "b.y0"),), "bond x: there is no output 'a.y9'"),
        ((Bond("x", "a.y1", "b.y0"),), "bond x: a.y1 is not wired to b"),
        ((Bond("x", "a.y0", "b.y0"), Bond("x", "b.y0", "a.y0")), "there are two bonds 'x'"),
    ],
)
def test_a_bond_that_is_none_is_refused(folder, bonds, what):
    made = system({"a": adder(1, 1, 1.0), "b": adder(1, 1, 0.0)}, RING, folder)
    assert what in both(made, ["a.y0"], Method(bonds=bonds))


def with_nominal(made, nominal):
    """The same FMUs with that nominal value declared for every variable."""
    named = {name: replace(v, nominal=nominal) for name, v in made.elements[0].model.variables.items()}
    elements = (
        replace(e, model=replace(e.model, variables=named), outputs=tuple(named[v.name] for v in e.outputs))
        for e in made.elements
    )
    return replace(made, elements=tuple(elements))


@pytest.mark.parametrize("method", [Method(), Method(Algorithm.GAUSS_SEIDEL)], ids=["plain", "by plan"])
def test_a_run_that_diverges_is_a_failure_and_no_result(folder, method):
    # Two masses of 1 coupled by their positions' differences over one step far too long: factor 1000 a step.
    made = with_nominal(system({"a": adder(1, 1000, 1.0), "b": adder(1, -1000, 0.0)}, RING, folder), 1.0)
    what, element, time = both(made, ["a.y0"], method, stop=10, step=1)
    assert (element, time) == ("a", 10)
    assert what.startswith("a.y0 diverged: it was ")
    assert "at t = 10 s, more than 2^53 times the nominal value that its FMU declares" in what
    finite = both(made, ["a.y0"], method, stop=3, step=1)
    assert isinstance(finite, np.ndarray)


def test_a_large_nominal_value_or_a_large_beginning_is_no_divergence(folder):
    made = system({"a": adder(1, 1000, 1.0), "b": adder(1, -1000, 0.0)}, RING, folder)
    assert isinstance(both(with_nominal(made, 1e30), ["a.y0"], Method(), stop=10, step=1), np.ndarray)
    begun = system({"a": adder(1, 1000, 1e30), "b": adder(1, -1000, 1e30)}, RING, folder)
    assert isinstance(both(with_nominal(begun, 1.0), ["a.y0"], Method(), stop=4, step=1), np.ndarray)


@pytest.mark.parametrize("method", [Method(), Method(Algorithm.GAUSS_SEIDEL)], ids=["plain", "by plan"])
def test_a_number_of_which_nobody_says_how_large_it_is_may_grow_as_long_as_it_is_finite(folder, method):
    # Particles per cubic metre: 1e18 a second, from none.
    made = system({"a": Linear([[0.0]], [[1.0]], [[1.0]], (), [0.0]), "b": adder(1, 0, 1e18)}, RING, folder)
    found = both(made, ["a.y0"], method, stop=4, step=1)
    assert found[:, 0].tolist() == [0, 1e18, 2e18, 3e18, 4e18]
    made = system({"a": adder(1, 1e200, 1.0), "b": adder(1, 1e200, 0.0)}, RING, folder)
    what, *_ = both(made, ["a.y0"], method, stop=4, step=1)
    assert "became" in what
