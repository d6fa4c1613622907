from __future__ import annotations

from dataclasses import replace
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from linear_fmus import Linear, system

from dse.cosim.dependency import Loop, Read, Write, order_of
from dse.cosim.reference import run_reference
from dse.cosim.simulator import RunFailed, Simulator
from dse.cosim.wiring import wire_up
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
    assert not any(isinstance(step, Loop) for step in order_of(wire_up(made), initially=True))
    assert first_row(made, [f"{name}.y0" for name in "abcd"]).tolist() == [1, 3, 7, 15]


def test_two_paths_through_one_element_are_no_loop_if_the_description_says_so(folder):
    # a.u0 -> a.y0 and a.u1 -> a.y1 go past each other; b takes the first and gives the second.
    crossing = Linear(d=[[2.0, 0.0], [0.0, 5.0]])
    elements = {"source": gain(0.0, 3.0), "a": crossing, "b": gain(1.0, 1.0)}
    wires = ["source.y0 -> a.u0", "a.y0 -> b.u0", "b.y0 -> a.u1"]
    told, untold = (system({**elements, "a": replace(crossing, tells=tells)}, wires, folder) for tells in (True, False))
    steps = order_of(wire_up(told), initially=True)
    assert not any(isinstance(step, Loop) for step in steps)
    assert [type(step) for step in steps if step.element == 1] == [Write, Read, Write]
    assert any(isinstance(step, Loop) for step in order_of(wire_up(untold), initially=True))
    for made in (told, untold):
        assert first_row(made, ["a.y0", "b.y0", "a.y1"]).tolist() == [6, 7, 35]


def test_a_loop_is_solved(folder):
    # a = 3 b + 1, b = 0.5 a - 2: walking round would grow by half every time.
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
    assert any(isinstance(step, Loop) for step in order_of(wire_up(made), initially=True))
    assert first_row(made, [f"{name}.y0" for name in names]).tolist() == [0.1 * i for i in range(6)]


def test_few_outputs_are_torn(folder):
    # A ring of eight needs one unknown, not eight.
    names = [f"e{i}" for i in range(8)]
    wires = [f"{a}.y0 -> {b}.u0" for a, b in zip(names, names[1:] + names[:1], strict=True)]
    (loop,) = (
        step
        for step in order_of(wire_up(system(dict.fromkeys(names, gain(0.5)), wires, folder)), initially=True)
        if isinstance(step, Loop)
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
        "initialization did not settle: the algebraic loop a.y -> b.u, b.y -> a.u goes on changing"
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
    (loop,) = (step for step in order_of(wire_up(made), initially=True) if isinstance(step, Loop))
    assert (len(loop.reals), len(loop.others)) == (1, 1)
    # b = 4 b + 0.5 b - 2 + 1
    assert first_row(made, ["b.y", "a.y", "d.y"]) == pytest.approx([2 / 7, 4 / 7, 1 / 14 - 1], rel=1e-9)


def _wired(element):
    return replace(element, inputs=(element.model.variables["u"],))
