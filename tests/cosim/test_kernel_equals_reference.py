from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings, strategies as st
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import Variable

BOTH = pytest.mark.parametrize("version", [2, 3])


def same_bits(system, record, *, stop=1.0, step=0.1, start=None):
    with Simulator(system, record) as simulator:
        fast = simulator.run(stop=stop, step=step, start=start or {})
    slow = run_reference(system, record, stop=stop, step=step, start=start or {})
    assert fast.shape == slow.shape == (round(stop / step) + 1, len(record))
    assert fast.flags.c_contiguous
    assert fast.tobytes() == slow.tobytes()
    return fast


@BOTH
def test_two_coupled_elements_follow_their_jacobi_recursion_exactly(shelf, version):
    model = shelf.fmu("linear", version)
    start = {"p.a": 0.9, "p.b": 0.3, "p.y0": 1.0, "q.a": 0.7, "q.b": -0.2, "q.y0": 2.0}
    system = shelf.system({"p": model, "q": model}, ["p.y -> q.u", "q.y -> p.u"], start)
    found = same_bits(system, ["p.y", "q.y"], stop=2.0, step=0.01)
    p, q = 1.0, 2.0
    for k in range(201):
        assert found[k].tolist() == [p, q]
        p, q = 0.9 * p + 0.3 * q, 0.7 * q + -0.2 * p  # both from the old values: that is Jacobi


def test_elements_of_both_fmi_versions_work_in_one_system(shelf):
    elements = {"a": shelf.fmu("linear", 2), "b": shelf.fmu("gain", 3), "c": shelf.fmu("linear", 3)}
    start = {"a.y0": 1.0, "a.a": 0.5, "a.b": 0.25, "b.k": 3.0, "c.a": 0.1, "c.b": 1.0}
    system = shelf.system(elements, ["a.y -> b.u", "b.y -> c.u", "c.y -> a.u"], start, ["c.y"])
    found = same_bits(system, ["a.y", "b.y", "c.y"])
    assert found[0].tolist() == [1.0, 3.0, 0.0]
    assert found[1].tolist() == [0.5, 3.0, 3.0]


@BOTH
def test_integers_and_booleans_travel_along_wires(shelf, version):
    model = shelf.fmu("counter", version)
    wires = ["a.odd -> b.enable", "a.count -> b.increment"]
    start = {"a.enable": 1, "a.increment": 3}
    record = ["a.count", "a.odd", "b.count", "b.odd"]
    system = shelf.system({"a": model, "b": model}, wires, start, record)
    found = same_bits(system, record, stop=0.4)
    assert found.tolist() == [[0, 0, 0, 0], [3, 1, 0, 0], [6, 0, 3, 1], [9, 1, 3, 1], [12, 0, 12, 0]]


@pytest.mark.parametrize("version", [2, 3])
def test_every_type_of_number_is_relayed(shelf, version):
    model = shelf.fmu("relay", version)
    types = [v.name.removeprefix("to_") for v in model.variables.values() if v.causality == "output"]
    values = {
        "Real": 0.1,
        "Integer": -(2**31),
        "Float64": -0.0,
        "Float32": 0.1,
        "Int8": -128,
        "UInt8": 255,
        "Int16": -32768,
        "UInt16": 65535,
        "Int32": 2**31 - 1,
        "UInt32": 2**32 - 1,
        "Int64": -(2**53),
        "UInt64": 2**53,
        "Boolean": 1,
    }
    wires = [f"a.to_{t} -> b.from_{t}" for t in types]
    start = {f"a.from_{t}": values[t] for t in types}
    record = [f"b.to_{t}" for t in types]
    found = same_bits(shelf.system({"a": model, "b": model}, wires, start, record), record)
    expected = [float(np.float32(values[t])) if t == "Float32" else float(values[t]) for t in types]
    assert np.array([expected] * 11).tobytes() == found.tobytes()


def crossing(shelf, version, **variables):
    """A relay under other names: name = (reference, type); references from 16 on are outputs."""
    named = {
        name: Variable(name, reference, fmi_type, "output" if reference >= 16 else "input", None)
        for name, (reference, fmi_type) in variables.items()
    }
    return replace(shelf.fmu("relay", version), variables=named)


@BOTH
@pytest.mark.parametrize("kind", ["whole", "truth"])
def test_what_travels_unconverted_arrives_in_any_order(shelf, version, kind):
    fmi_type = "Boolean" if kind == "truth" else ("Integer" if version == 2 else "Int32")
    p, q = (1, 0) if kind == "truth" else (-7, 2**31 - 1)
    model = crossing(shelf, version, p=(0, fmi_type), q=(1, fmi_type), x=(16, fmi_type), y=(17, fmi_type))
    ends = {"straight": ("x", "y"), "crossed": ("y", "x"), "forked": ("y", "y")}
    wires = [f"a.{source} -> {name}.{target}" for name in ends for source, target in zip(ends[name], "pq", strict=True)]
    record = [f"{name}.{output}" for name in ends for output in "xy"]
    system = shelf.system(dict.fromkeys(["a", *ends], model), wires, {"a.p": p, "a.q": q}, record)
    assert same_bits(system, record)[-1].tolist() == [p, q, q, p, q, q]


def test_whole_numbers_travel_between_the_versions(shelf):
    two = crossing(shelf, 2, p=(0, "Integer"), q=(1, "Boolean"), x=(16, "Integer"), y=(17, "Boolean"))
    three = crossing(shelf, 3, p=(0, "Int32"), q=(1, "Boolean"), x=(16, "Int32"), y=(17, "Boolean"))
    wires = ["a.x -> b.p", "a.y -> b.q", "b.x -> c.p", "b.y -> c.q"]
    system = shelf.system({"a": two, "b": three, "c": two}, wires, {"a.p": -3, "a.q": 1}, ["c.x", "c.y"])
    assert same_bits(system, ["c.x", "c.y"])[-1].tolist() == [-3, 1]


def test_a_true_other_than_one_is_passed_on_as_one(shelf):
    source = crossing(shelf, 2, n=(0, "Integer"), truth=(16, "Boolean"))
    target = crossing(shelf, 2, truth=(0, "Boolean"), n=(16, "Integer"))
    record = ["a.truth", "b.n"]
    system = shelf.system({"a": source, "b": target}, ["a.truth -> b.truth"], {"a.n": 5}, record)
    assert same_bits(system, record).tolist() == [[1, 1]] * 11


def test_more_elements_than_the_loop_takes_at_once_all_step(shelf):
    names = [f"e{i}" for i in range(11)]
    for versions in ([2] * 11, [2] * 6 + [3] + [2] * 4, [3] + [2] * 10):
        models = {name: shelf.fmu("linear", version) for name, version in zip(names, versions, strict=True)}
        start = {f"{name}.{key}": value for i, name in enumerate(names) for key, value in (("a", 2.0), ("y0", i + 1.0))}
        record = [f"{name}.y" for name in names]
        found = same_bits(shelf.system(models, (), start, record), record, stop=0.3)
        assert found[-1].tolist() == [8.0 * (i + 1) for i in range(11)]


@BOTH
@pytest.mark.parametrize("reverse", [False, True])
def test_a_feed_through_chain_is_consistent_at_time_zero_in_any_order(shelf, version, reverse):
    names = [f"g{i}" for i in range(7)]
    elements = {name: shelf.fmu("gain", version) for name in (reversed(names) if reverse else names)}
    start = {f"{name}.c": 1.0 for name in names}
    wires = [f"{a}.y -> {b}.u" for a, b in pairwise(names)]
    found = same_bits(shelf.system(elements, wires, start, ["g6.y"]), [f"{name}.y" for name in names])
    assert found[0].tolist() == [1, 2, 3, 4, 5, 6, 7]


def test_an_algebraic_loop_that_contracts_to_a_fixed_point_settles(shelf):
    model = shelf.fmu("gain")
    system = shelf.system({"a": model, "b": model}, ["a.y -> b.u", "b.y -> a.u"], {"a.k": 0.0, "a.c": 4.0})
    assert same_bits(system, ["b.y"])[0] == [4.0]


@BOTH
def test_values_given_to_a_run_come_before_those_of_the_system(shelf, version):
    system = shelf.system({"a": shelf.fmu("linear", version)}, (), {"a.y0": 1.0}, ["a.y"])
    assert same_bits(system, ["a.y"], start={"a.y0": 5.0, "a.a": 2.0}, stop=0.2)[:, 0].tolist() == [5, 10, 20]
    with Simulator(system, ["a.y"]) as simulator:
        rows = [
            simulator.run(stop=0.2, step=0.1, start=start)[:, 0].tolist()
            for start in ({}, {"a.y0": 5.0}, {"a.a": 2.0}, {"a.y0": 3.0, "a.a": 2.0}, {"a.a": 3.0}, {})
        ]
    assert rows == [[1, 1, 1], [5, 5, 5], [1, 2, 4], [3, 6, 12], [1, 3, 9], [1, 1, 1]]


def test_a_run_fills_the_array_it_is_given(shelf):
    system = shelf.system({"a": shelf.fmu("linear")}, (), {"a.y0": 1.0, "a.a": 2.0}, ["a.y"])
    rows = np.full((3, 1), np.nan)
    with Simulator(system, ["a.y"]) as simulator:
        assert simulator.run(stop=0.2, step=0.1, out=rows) is rows
        assert rows.tolist() == [[1], [2], [4]]
        for unfit in (np.empty((4, 1)), np.empty((3, 1), np.float32), np.empty((3, 2))[:, :1]):
            with pytest.raises(ValueError, match="out must be"):
                simulator.run(stop=0.2, step=0.1, out=unfit)


@BOTH
def test_the_time_of_a_step_is_never_accumulated(shelf, version):
    system = shelf.system({"clock": shelf.fmu("faulty", version)}, (), {}, ["clock.y"])
    found = same_bits(system, ["clock.y"], stop=60.0, step=0.01)
    assert found.shape == (6001, 1)
    assert found[1:, 0].tolist() == [k * 0.01 + 0.01 for k in range(6000)]


def outcome(run):
    try:
        return run().tobytes()
    except RunFailed as failure:
        return str(failure), failure.element, failure.time


NAMES = ("a", "b", "c", "d")
numbers = st.floats(-2, 2, allow_nan=False)


@st.composite
def random_systems(draw):
    kinds = {
        name: (draw(st.sampled_from(["linear", "gain"])), draw(st.sampled_from([2, 3])))
        for name in NAMES[: draw(st.integers(1, 4))]
    }
    sources = {name: draw(st.one_of(st.none(), st.sampled_from(sorted(kinds)))) for name in kinds}
    wires = [f"{source}.y -> {name}.u" for name, source in sources.items() if source]
    parameters = {"linear": ("a", "b", "y0"), "gain": ("k", "c")}
    start = {f"{name}.{p}": draw(numbers) for name, (kind, _) in kinds.items() for p in parameters[kind]}
    return kinds, wires, start


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(random_systems())
def test_any_wiring_gives_the_same_bits_or_the_same_failure(shelf, drawn):
    kinds, wires, start = drawn
    record = [f"{name}.y" for name in kinds]
    system = shelf.system({name: shelf.fmu(*kind) for name, kind in kinds.items()}, wires, start, record)
    slow = outcome(lambda: run_reference(system, record, stop=1.0, step=0.1))
    with Simulator(system, record) as simulator:
        for _ in range(3):  # fresh, proving the reset, after a reset
            assert outcome(lambda: simulator.run(stop=1.0, step=0.1)) == slow
        assert simulator.reset_is_trusted is (True if isinstance(slow, bytes) else None)
