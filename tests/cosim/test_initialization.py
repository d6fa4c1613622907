from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings, strategies as st
from linear_fmus import Linear, system
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.cosim.wiring.border import ElementPort
from dse.cosim.wiring.dependency import AlgebraicLoop, Read, Write, doubtful_reads, order_of
from dse.cosim.wiring.wiring import wire_up
from dse.domain.method import Coupling, Method
from dse.domain.system import Wire


@pytest.fixture(scope="session")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("linear")


def gain(factor: float, offset: float = 0.0, **options) -> Linear:
    """y0 = factor u0 + offset, the offset being a state that stays."""
    return Linear((), (), [[1.0]], [[factor]], [offset], **options)


def first_row(made, record):
    with Simulator(made, record) as simulator:
        found = simulator.run(stop=0.1, step=0.1)
    assert found.tobytes() == run_reference(made, record, stop=0.1, step=0.1).tobytes()
    return found[0]


@pytest.mark.parametrize("version", [2, 3])
@pytest.mark.parametrize("names", [*permutations("abcd")][::4])
def test_a_chain_is_carried_through_in_one_go_whatever_the_order_of_its_elements(folder, names, version):
    elements = {name: gain(2.0, 1.0, version=version) for name in names}
    made = system(elements, ["a.y0 -> b.u0", "b.y0 -> c.u0", "c.y0 -> d.u0"], folder)
    assert not any(isinstance(step, AlgebraicLoop) for step in order_of(wire_up(made), initially=True))
    assert first_row(made, [f"{name}.y0" for name in "abcd"]).tolist() == [1, 3, 7, 15]


def test_two_paths_through_one_element_are_no_loop_if_the_description_says_so(folder):
    # a.u0 -> a.y0 and a.u1 -> a.y1 go past each other; b takes the first and gives the second.
    crossing = Linear(d=[[2.0, 0.0], [0.0, 5.0]])
    elements = {"source": gain(0.0, 3.0), "a": crossing, "b": gain(1.0, 1.0)}
    wires = ["source.y0 -> a.u0", "a.y0 -> b.u0", "b.y0 -> a.u1"]
    told, untold = (system({**elements, "a": replace(crossing, tells=tells)}, wires, folder) for tells in (True, False))
    steps = order_of(wire_up(told), initially=True)
    assert not any(isinstance(step, AlgebraicLoop) for step in steps)
    assert [type(step) for step in steps if step.element == 1] == [Write, Read, Write]
    assert any(isinstance(step, AlgebraicLoop) for step in order_of(wire_up(untold), initially=True))
    for made in (told, untold):
        assert first_row(made, ["a.y0", "b.y0", "a.y1"]).tolist() == [6, 7, 35]


def test_a_loop_is_solved(folder):
    # a = 3 b + 1, b = 0.5 a - 2: sweeping round would grow by half every time.
    elements = {"a": gain(3.0, 1.0), "b": gain(0.5, -2.0)}
    found = first_row(system(elements, ["a.y0 -> b.u0", "b.y0 -> a.u0"], folder), ["a.y0", "b.y0"])
    assert found == pytest.approx([10.0, 3.0], rel=1e-11)


def test_what_comes_after_a_loop_follows_its_solution(folder):
    elements = {"after": gain(10.0), "a": gain(-1.0, 1.0), "b": gain(1.0)}
    made = system(elements, ["a.y0 -> b.u0", "b.y0 -> a.u0", "b.y0 -> after.u0"], folder)
    assert first_row(made, ["a.y0", "after.y0"]) == pytest.approx([0.5, 5.0], rel=1e-11)


def test_a_loop_that_is_none_in_truth_is_found_exactly(folder):
    # Nobody tells that outputs do not follow inputs, so all of it looks like one loop.
    names = [f"e{i}" for i in range(6)]
    elements = {name: gain(0.0, 0.1 * i, tells=False) for i, name in enumerate(names)}
    wires = [f"{a}.y0 -> {b}.u0" for a, b in zip(names, names[1:] + names[:1], strict=True)]
    made = system(elements, wires, folder)
    assert any(isinstance(step, AlgebraicLoop) for step in order_of(wire_up(made), initially=True))
    assert first_row(made, [f"{name}.y0" for name in names]).tolist() == [0.1 * i for i in range(6)]


def test_a_loop_without_a_solution_or_with_any_is_not_answered(folder):
    wires = ["a.y0 -> b.u0", "b.y0 -> a.u0"]
    loop = "a.y0 -> b.u0, b.y0 -> a.u0"
    # a = k a + c: without a solution, and so near to that that rounding decides on the fifth digit.
    for k, c in ((1.0, 1e-10), (1.0 - 1e-11, 5e-10)):
        made = system({"a": gain(k, c), "b": gain(1.0)}, wires, folder)
        with Simulator(made, ["a.y0"]) as simulator, pytest.raises(RunFailed) as fast:
            simulator.run(stop=0.1, step=0.1)
        with pytest.raises(RunFailed) as slow:
            run_reference(made, ["a.y0"], stop=0.1, step=0.1)
        assert str(slow.value) == str(fast.value)
        assert str(fast.value).startswith(
            f"initialization found no solution of the algebraic loop {loop}: it is nearly singular, the last step of "
            f"Newton's method "
        )
    # What can be solved is: to 1e-6, which is what may be left to go, and a little, as the slope is known to 1e-8 only.
    near = system({"a": gain(1.0 - 1e-8, 1e-5), "b": gain(1.0)}, wires, folder)
    assert first_row(near, ["a.y0"]) == pytest.approx([1e-5 / (1.0 - (1.0 - 1e-8))], rel=3e-6)


def test_a_value_that_an_fmu_discards_is_no_solution_of_a_loop_but_no_failure_either(shelf):
    # y = sqrt(u), u = 10 - 10 y: sweeping round, u is 10, then -21.6.
    elements = {"root": shelf.fmu("gain", 2, "-DROOT"), "line": shelf.fmu("gain", 3)}
    wires = ["root.y -> line.u", "line.y -> root.u"]
    made = shelf.system(elements, wires, {"line.k": -10.0, "line.c": 10.0}, ["root.y"])
    assert first_row(made, ["root.y"]) == pytest.approx([np.sqrt(35.0) - 5.0], rel=1e-9)  # y^2 + 10 y - 10 = 0
    never = shelf.system(elements, wires, {"line.k": 1.0, "line.c": -10.0}, ["root.y"])
    with Simulator(never, ["root.y"]) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=0.1, step=0.1)
    with pytest.raises(RunFailed) as slow:
        run_reference(never, ["root.y"], stop=0.1, step=0.1)
    assert str(slow.value) == str(fast.value)
    assert "found no solution of the algebraic loop" in str(fast.value)


@pytest.mark.parametrize("version", [2, 3])
def test_what_is_not_finite_is_not_passed_on_in_the_initialization(shelf, version):
    model = shelf.fmu("gain", version)
    made = shelf.system({"a": model, "b": model}, ["a.y -> b.u"], {"a.c": np.nan, "b.k": 0.0}, ["b.y"])
    with Simulator(made, ["b.y"]) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=0.1, step=0.1)
    with pytest.raises(RunFailed) as slow:
        run_reference(made, ["b.y"], stop=0.1, step=0.1)
    assert (str(slow.value), slow.value.time) == (str(fast.value), fast.value.time)
    assert str(fast.value) == "a.y became nan at t = 0 s"
    assert fast.value.time is None  # before the first communication point


def lying(made, *names):
    """The same FMUs, of which those with these names say that their outputs depend on nothing."""
    nothing = {f"y{i}": () for i in range(3)}
    return replace(
        made,
        elements=tuple(
            replace(e, model=replace(e.model, initially_depends=nothing, depends=nothing)) if e.name in names else e
            for e in made.elements
        ),
    )


@pytest.mark.parametrize("names", [("b",), ("b", "c"), ("a", "b", "c", "d")])
@pytest.mark.parametrize("method", [Method(), Method(coupling=Coupling.SOLVE)], ids=["plain", "by plan"])
def test_an_fmu_that_denies_its_dependencies_is_not_believed(folder, names, method):
    # Nobody waits for a where b is believed: d would begin with what b shows before it has been given anything.
    elements = {"d": gain(2.0), "c": gain(2.0), "b": gain(2.0), "a": gain(0.0, 7.0)}
    wires = ["a.y0 -> b.u0", "b.y0 -> c.u0", "c.y0 -> d.u0"]
    made = lying(system(elements, wires, folder), *names)
    record = [f"{name}.y0" for name in "abcd"]
    slow = run_reference(made, record, stop=0.2, step=0.1, method=method)
    assert slow[0].tolist() == [7, 14, 28, 56]
    with Simulator(made, record, method=method) as simulator:
        for trusted in (None, None, True):
            assert simulator.run(stop=0.2, step=0.1).tobytes() == slow.tobytes()
            assert simulator.reset_is_trusted is trusted or trusted is None


def test_an_fmu_that_denies_its_part_in_a_loop_is_not_believed(folder):
    elements = {"a": gain(3.0, 1.0), "b": gain(0.5, -2.0)}
    made = lying(system(elements, ["a.y0 -> b.u0", "b.y0 -> a.u0"], folder), "a")
    assert not any(isinstance(step, AlgebraicLoop) for step in order_of(wire_up(made), initially=True))
    assert first_row(made, ["a.y0", "b.y0"]) == pytest.approx([10.0, 3.0], rel=1e-11)


def test_who_tells_the_truth_is_asked_once(folder):
    elements = {"a": gain(0.0, 7.0), "b": Linear(d=[[2.0, 0.0], [0.0, 5.0]]), "c": gain(1.0)}
    wires = ["a.y0 -> b.u0", "a.y1 -> b.u1", "b.y0 -> c.u0"]
    whole = system({"a": gain(0.0, 7.0), "c": gain(1.0)}, ["a.y0 -> c.u0", "c.y0 -> a.u0"], folder)
    assert doubtful_reads(wire_up(whole)) == (Read(0, (ElementPort(0, True, 0),)),)  # a says that it depends on nothing
    # b.y0 may be read before b.u1 is there: that is looked at again.
    assert doubtful_reads(wire_up(system(elements, wires, folder))) == (Read(1, (ElementPort(1, True, 0),)),)
    single = system({"a": gain(0.0, 7.0), "c": gain(1.0)}, ["a.y0 -> c.u0"], folder)
    assert doubtful_reads(wire_up(single)) == ()


def test_few_outputs_are_torn(folder):
    # A ring of eight needs one unknown, not eight.
    names = [f"e{i}" for i in range(8)]
    wires = [f"{a}.y0 -> {b}.u0" for a, b in zip(names, names[1:] + names[:1], strict=True)]
    (loop,) = (
        step
        for step in order_of(wire_up(system(dict.fromkeys(names, gain(0.5)), wires, folder)), initially=True)
        if isinstance(step, AlgebraicLoop)
    )
    assert (len(loop.reals), len(loop.others), len(loop.wires)) == (1, 0, 8)


numbers = st.floats(-3, 3, allow_nan=False).map(lambda x: round(x, 2))


@st.composite
def coupled(draw):
    count = draw(st.integers(2, 4))
    names = [f"e{i}" for i in range(count)]
    entries = st.lists(st.lists(numbers, min_size=2, max_size=2), min_size=2, max_size=2)
    elements = {
        name: Linear((), (), [[1.0, 0.0], [0.0, 1.0]], draw(entries), draw(st.tuples(numbers, numbers)))
        for name in names
    }
    outputs = [f"{name}.y{i}" for name in names for i in range(2)]
    wires = [f"{draw(st.sampled_from(outputs))} -> {name}.u{i}" for name in names for i in range(2)]
    return elements, wires


@settings(max_examples=50, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(coupled())
def test_any_linear_loop_has_the_solution_of_its_equations(folder, drawn):
    elements, wires = drawn
    names = list(elements)
    at = {f"{name}.{{}}{i}": 2 * e + i for e, name in enumerate(names) for i in range(2)}
    gains = np.zeros((2 * len(names), 2 * len(names)))
    for e, element in enumerate(elements.values()):
        gains[2 * e : 2 * e + 2, 2 * e : 2 * e + 2] = element.d
    wired = np.zeros_like(gains)
    for wire in wires:
        source, target = wire.split(" -> ")
        wired[at[target.replace(".u", ".{}")], at[source.replace(".y", ".{}")]] = 1.0
    whole = np.eye(len(gains)) - gains @ wired
    assume(np.linalg.cond(whole) < 1e4)
    right = np.linalg.solve(whole, np.concatenate([element.x for element in elements.values()]))
    found = first_row(system(elements, wires, folder), [f"{name}.y{i}" for name in names for i in range(2)])
    # Newton stops at a residual of 1e-12 of each value; the condition number carries it into the solution.
    assert found == pytest.approx(right, rel=1e-7, abs=1e-7)


def test_a_discrete_loop_that_settles_is_followed_until_it_does(shelf):
    # Two relays that pass a number round: whatever it is at first, it stays.
    model = shelf.fmu("relay", 3)
    made = shelf.system(
        {"a": model, "b": model},
        ["a.to_Int32 -> b.from_Int32", "b.to_Int32 -> a.from_Int32"],
        {},
        ["a.to_Int32"],
    )
    assert first_row(made, ["a.to_Int32"]).tolist() == [0]


def discrete(model):
    """The same FMU, its variables called discrete: no equations to solve, values that settle or do not."""
    return replace(model, variables={n: replace(v, variability="discrete") for n, v in model.variables.items()})


def test_a_discrete_loop_that_never_settles_is_named(shelf):
    # y = 1 - y: 0, 1, 0, 1, …; as a continuous variable it would be 0.5
    model = discrete(shelf.fmu("gain", 2))
    start = {"a.k": -1.0, "a.c": 1.0}
    made = shelf.system({"a": model, "b": model}, ["a.y -> b.u", "b.y -> a.u"], start, ["a.y"])
    with Simulator(made, ["a.y"]) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=1, step=0.5)
    assert str(fast.value) == (
        "initialization did not settle: the algebraic loop a.y -> b.u, b.y -> a.u keeps changing"
    )
    with pytest.raises(RunFailed) as slow:
        run_reference(made, ["a.y"], stop=1, step=0.5)
    assert str(slow.value) == str(fast.value)


def test_a_loop_of_both_kinds_is_solved_for_its_real_numbers_and_followed_for_the_others(shelf, folder):
    # b = 2 (a + d) + 1, a = 2 b, and d = 0.25 b - 1, which is discrete.
    real, held = shelf.fmu("gain", 2), discrete(shelf.fmu("gain", 3))
    start = {"a.k": 2.0, "b.k": 2.0, "b.c": 1.0, "d.k": 0.25, "d.c": -1.0}
    adder = system({"sum": Linear((), (), (), [[1.0, 1.0]])}, [], folder).elements[0]
    built = shelf.system({"a": real, "b": real, "d": held}, ["a.y -> b.u", "b.y -> d.u"], start, ["a.y", "d.y"])
    inputs = tuple(adder.model.variables[name] for name in ("u0", "u1"))
    wires = [("a", "y", "sum", "u0"), ("d", "y", "sum", "u1"), ("sum", "y0", "b", "u"), ("b", "y", "a", "u")]
    made = replace(
        built,
        elements=(
            *[e for e in built.elements if e.name != "a"],
            _wired(built.element("a")),
            replace(adder, inputs=inputs),
        ),
        wires=(*[w for w in built.wires if w.target == "d"], *[Wire(*wire) for wire in wires]),
    )
    (loop,) = (step for step in order_of(wire_up(made), initially=True) if isinstance(step, AlgebraicLoop))
    assert (len(loop.reals), len(loop.others)) == (1, 1)
    # b = 4 b + 0.5 b - 2 + 1
    assert first_row(made, ["b.y", "a.y", "d.y"]) == pytest.approx([2 / 7, 4 / 7, 1 / 14 - 1], rel=1e-9)


def _wired(element):
    return replace(element, inputs=(element.model.variables["u"],))
