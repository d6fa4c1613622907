"""Communication steps that are not made in one go: discarded, asynchronous, along slopes; FMI 1.0 besides 2.0."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.method import Algorithm, Coupling, Extrapolation, Method
from dse.domain.system import Conversion

BOTH = pytest.mark.parametrize("version", [1, 2])
WHOLE, IN_PART, STUCK, WANTS_TO_END, ASKED_FOR, CALLS_BACK, FAILS_LATE, ALWAYS_CALLS_BACK, BEYOND = range(9)
RECORD = ["s.y", "s.steps", "s.sum"]


def same_bits(system, record, method=None, **run):
    run = {"stop": 1.0, "step": 0.1} | run
    method = method or Method()
    with Simulator(system, record, method=method) as simulator:
        fast = simulator.run(**run)
        assert simulator.run(**run).tobytes() == fast.tobytes()
    assert run_reference(system, record, method=method, **run).tobytes() == fast.tobytes()
    return fast


def same_failure(system, record, method=None, **run):
    run = {"stop": 1.0, "step": 0.1} | run
    method = method or Method()
    with Simulator(system, record, method=method) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(**run)
    with pytest.raises(RunFailed) as slow:
        run_reference(system, record, method=method, **run)
    assert str(slow.value) == str(fast.value)
    assert (slow.value.element, slow.value.time) == (fast.value.element, fast.value.time)
    return fast.value


def stepper(shelf, version, mode, *, most=1.0):
    return shelf.system({"s": shelf.fmu("stepper", version)}, (), {"s.mode": mode, "s.most": most}, RECORD)


@BOTH
def test_what_a_discarded_step_left_is_made_up_for(shelf, version):
    # Each step of 1/8 s is made in steps of 1/32 s: binary fractions, so that every time is exact.
    rows = same_bits(stepper(shelf, version, IN_PART, most=1 / 32), RECORD, step=1 / 8)
    assert rows[:, 0].tolist() == [k / 8 for k in range(9)]
    assert rows[:, 1].tolist() == [4 * k for k in range(9)]


@BOTH
def test_a_discarded_step_that_got_nowhere_fails(shelf, version):
    for mode in (STUCK, BEYOND):  # beyond the end it cannot have got either
        failure = same_failure(stepper(shelf, version, mode, most=0.05), RECORD)
        name = "fmiDoStep" if version == 1 else "fmi2DoStep"
        assert str(failure) == f"s: {name} at t = 0 s returned discard"


@pytest.mark.parametrize(("version", "mode"), [(1, ASKED_FOR), (2, ASKED_FOR), (2, CALLS_BACK)])
def test_an_asynchronous_step_is_waited_for(shelf, version, mode):
    rows = same_bits(stepper(shelf, version, mode, most=0.05), RECORD, step=0.25)
    assert rows[:, 0].tolist() == [0, 0.25, 0.5, 0.75, 1]
    assert rows[:, 1].tolist() == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("method", [Method(), Method(Algorithm.GAUSS_SEIDEL)], ids=["plain", "by plan"])
def test_a_call_back_for_a_step_that_was_over_already_does_not_end_the_next_one(shelf, method):
    # The first step of three is made at once, the two after it take a millisecond each: read too early, y stands still.
    rows = same_bits(stepper(shelf, 2, ALWAYS_CALLS_BACK, most=0.05), RECORD, method, step=0.125)
    assert rows[:, 0].tolist() == [k / 8 for k in range(9)]


def test_an_asynchronous_step_may_fail_when_it_is_over(shelf):
    failure = same_failure(stepper(shelf, 2, FAILS_LATE, most=0.05), RECORD)
    assert str(failure) == "s: fmi2DoStep at t = 0 s returned error"


def ramp_into_stepper(shelf, version, *, conversions=None):
    """s.u is the output of a gain whose input is another stepper's time: a straight line of slope 1 in t."""
    clock, model = shelf.fmu("stepper", 2), shelf.fmu("stepper", version)
    able = replace(model.capabilities, can_interpolate_inputs=True)
    system = shelf.system({"t": clock, "s": replace(model, capabilities=able)}, ["t.y -> s.u"], {}, ["s.sum"])
    first, second = system.elements
    return replace(system, elements=(first, replace(second, conversions=conversions or {})))


@BOTH
def test_an_input_follows_its_slope_where_the_fmu_takes_one(shelf, version):
    system = ramp_into_stepper(shelf, version)
    held = same_bits(system, ["s.sum"], step=1 / 8)
    assert held[-1, 0] == 7 / 16  # the left sum of t from 0 to 1 in eighths
    linear = same_bits(system, ["s.sum"], Method(extrapolation=Extrapolation.LINEAR), step=1 / 8)
    # The slope is known from the second point on; the first step is held: it misses 1/128 of the integral 1/2.
    assert linear[-1, 0] == 1 / 2 - 1 / 128


def test_slopes_are_converted_like_values(shelf):
    # Inside, u is half of what it is outside, plus 1: its integral over 1 s is 1/2 * 1/2 + 1 = 5/4.
    system = ramp_into_stepper(shelf, 2, conversions={"u": Conversion(2.0, -2.0)})
    linear = same_bits(system, ["s.sum"], Method(extrapolation=Extrapolation.LINEAR), step=1 / 8)
    assert linear[-1, 0] == 5 / 4 - 1 / 256


def test_wires_scale_and_shift_and_translate(shelf):
    clock = shelf.fmu("stepper", 2)
    gain = shelf.fmu("gain", 3)
    system = shelf.system({"t": clock, "g": gain, "h": gain}, ["t.y -> g.u", "t.steps -> h.u"], {}, ["g.y", "h.y"])
    scaled = replace(system.wires[0], factor=3.0, offset=-1.0)
    translated = replace(system.wires[1], items=((0.0, 5.0), (1.0, 7.0)))
    rows = same_bits(replace(system, wires=(scaled, translated)), ["g.y", "h.y"], step=0.25)
    assert rows[:, 0].tolist() == [-1, -1, -0.25, 0.5, 1.25]  # 3 t - 1, one step late
    assert rows[:, 1].tolist() == [5, 5, 7, 2, 3]  # what has no item is passed on as it is


@BOTH
def test_an_fmu_of_fmi_1_works_beside_those_of_others(shelf, version):
    elements = {"a": shelf.fmu("linear", 1), "b": shelf.fmu("linear", version), "c": shelf.fmu("counter", 1)}
    start = {"a.a": 0.9, "a.b": 0.3, "a.y0": 1.0, "b.a": 0.7, "b.b": -0.2, "b.y0": 2.0, "c.enable": 1, "c.increment": 3}
    record = ["a.y", "b.y", "c.count", "c.odd"]
    rows = same_bits(shelf.system(elements, ["a.y -> b.u", "b.y -> a.u"], start, record), record)
    a, b = 1.0, 2.0
    for k in range(11):
        assert rows[k].tolist() == [a, b, 3 * k, k % 2]
        a, b = 0.9 * a + 0.3 * b, 0.7 * b - 0.2 * a


@pytest.mark.parametrize("reverse", [False, True])
def test_an_fmu_of_fmi_1_is_given_its_inputs_before_it_is_initialized(shelf, reverse):
    names = ["a", "b", "c"]
    elements = {name: shelf.fmu("gain", 1) for name in (reversed(names) if reverse else names)}
    system = shelf.system(elements, ["a.y -> b.u", "b.y -> c.u"], {f"{name}.c": 1.0 for name in names}, ["c.y"])
    assert same_bits(system, ["a.y", "b.y", "c.y"])[0].tolist() == [1, 2, 3]


def test_an_fmu_of_fmi_1_logs_without_being_told_where_to(shelf):
    system = shelf.system({"world": shelf.fmu("faulty", 1)}, (), {"world.mode": 1, "world.at": 0.5}, ["world.y"])
    with Simulator(system, ["world.y"]) as simulator, pytest.raises(RunFailed) as failed:
        simulator.run(stop=1.0, step=0.1)
    assert str(failed.value) == "world: fmiDoStep at t = 0.5 s returned error: tyre left the road 42"


@pytest.mark.parametrize(("item", "inside"), [(0.0, 10.0), (1.0, 20.0), (2.0, 15.0)])
def test_items_of_an_enumeration_are_translated_both_ways(shelf, item, inside):
    model = shelf.fmu("relay", 3)
    named = {n: model.variables[n] for n in ("from_Int64", "to_Int64", "from_Int32", "to_Int32")}
    items = Conversion(items=((10.0, 0.0), (20.0, 1.0), (15.0, 2.0)))
    system = shelf.system({"a": model, "b": model}, ["a.to_Int64 -> b.from_Int64"], {}, ["b.to_Int64"])
    a, b = system.elements
    a = replace(a, start={"from_Int64": item}, conversions={"from_Int64": items, "to_Int64": items})
    translated = replace(system, elements=(a, replace(b, conversions={"from_Int64": items})))
    assert set(named) <= set(model.variables)
    assert same_bits(translated, ["a.to_Int64", "b.to_Int64"])[-1].tolist() == [item, inside]


def test_a_value_that_is_no_item_is_named(shelf):
    model = shelf.fmu("relay", 3)
    items = Conversion(items=((10.0, 0.0), (20.0, 1.0)))
    system = shelf.system(
        {"a": model, "b": model}, ["a.to_Int64 -> b.from_Int64"], {"a.from_Int64": 10}, ["b.to_Int64"]
    )
    a, b = system.elements
    wrong_start = replace(
        system, elements=(replace(a, start={"from_Int64": 4.0}, conversions={"from_Int64": items}), b)
    )
    failure = same_failure(wrong_start, ["b.to_Int64"])
    assert str(failure) == "a.from_Int64 cannot take the value 4: it is none of the enumeration's items"
    assert failure.call == "fmi3SetInt64"
    wrong_output = replace(system, elements=(replace(a, start={"from_Int64": 7.0}, conversions={"to_Int64": items}), b))
    failure = same_failure(wrong_output, ["b.to_Int64"])
    assert str(failure) == "a.to_Int64 became 7, which is none of the enumeration's items"
    wrong_input = replace(system, elements=(a, replace(b, conversions={"from_Int64": items})))
    failure = same_failure(wrong_input, ["b.to_Int64"])
    assert str(failure) == "b.from_Int64 cannot take the value 10: it is none of the enumeration's items"


@pytest.mark.parametrize("method", [Method(), Method(coupling=Coupling.PROPAGATE)], ids=["plain", "by plan"])
def test_a_value_that_is_too_large_when_it_arrives_is_no_infinity_but_a_failure(shelf, method):
    model = shelf.fmu("gain", 3)
    built = shelf.system({"a": model, "b": model}, ["a.y -> b.u"], {"a.c": 1e300, "b.k": 0.0}, ["b.y"])
    a, b = built.elements
    by_wire = replace(built, wires=(replace(built.wires[0], factor=-1e10),))
    by_unit = replace(built, elements=(a, replace(b, conversions={"u": Conversion(1e-10)})))
    for system, what in ((by_wire, "-inf"), (by_unit, "inf")):
        failure = same_failure(system, ["b.y"], method=method)
        assert (
            str(failure)
            == f"b.u would become {what}: the factor of its wire or its unit makes it too large for a number"
        )
    assert same_bits(built, ["b.y"], method)[-1, 0] == 0


def test_a_number_that_is_too_large_for_a_float_is_no_infinity_but_a_failure(shelf):
    model = shelf.fmu("relay", 3)
    wires = ["a.to_Float64 -> b.from_Float32"]
    system = shelf.system({"a": model, "b": model}, wires, {"a.from_Float64": 1e39}, ["b.to_Float32"])
    failure = same_failure(system, ["b.to_Float32"])
    assert str(failure) == "b.from_Float32 cannot take the value 9.9999999999999994e+38: it is of type Float32"
    large = shelf.system({"a": model, "b": model}, wires, {"a.from_Float64": 3e38}, ["b.to_Float32"])
    assert same_bits(large, ["b.to_Float32"])[-1, 0] == np.float32(3e38)
    start = shelf.system({"a": model}, (), {"a.from_Float32": 1e39}, ["a.to_Float32"])
    failure = same_failure(start, ["a.to_Float32"])
    assert str(failure) == "a.from_Float32 cannot take the value 9.9999999999999994e+38: it is of type Float32"
    # A parameter that is infinite from the start is meant to be.
    endless = shelf.system({"a": model}, (), {"a.from_Float32": np.inf}, ["a.to_Float32"])
    assert same_bits(endless, ["a.to_Float32"])[-1, 0] == np.inf


def test_units_are_converted_at_the_border(shelf):
    model = shelf.fmu("gain", 2)
    celsius, percent = Conversion(1.0, 273.15), Conversion(0.01)
    system = shelf.system({"a": model, "b": model}, ["a.y -> b.u"], {"a.c": 300.0, "b.k": 0.5}, ["b.y"])
    a, b = system.elements
    a = replace(a, conversions={"c": celsius, "y": celsius})
    b = replace(b, conversions={"k": percent, "u": celsius, "y": percent})
    rows = same_bits(replace(system, elements=(a, b)), ["a.y", "b.y"])
    assert rows[-1, 0] == (300.0 - 273.15) + 273.15
    inner = (0.5 - 0.0) / 0.01 * ((rows[-1, 0] - 273.15) / 1.0)
    assert rows[-1, 1] == 0.01 * inner
    assert np.isclose(rows[-1, 1], 0.5 * 26.85)
