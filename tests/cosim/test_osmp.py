"""Binaries of FMI 2 (OSMP): copied by the master between FMUs of any version, and not followed to nowhere."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import Variable

OWN, FORWARD, NOWHERE, LESS_THAN_NONE, TOO_LARGE = range(5)


def osmp(shelf):
    model = shelf.fmu("osmp", 2)
    binaries = {
        name: Variable(
            name,
            first,
            "Binary",
            causality,
            None,
            variability="discrete",
            integers=tuple((f"{name}.{role}", first + n) for n, role in enumerate(("base.lo", "base.hi", "size"))),
        )
        for name, first, causality in (("in", 2, "input"), ("out", 5, "output"))
    }
    return replace(model, variables={**model.variables, **binaries})


def expected(size: int, k: int) -> int:
    """The sum of the bytes that were shown at point *k*."""
    return sum((k + i) % 256 for i in range(size * k))


def test_bytes_travel_from_osmp_to_osmp(shelf):
    model = osmp(shelf)
    system = shelf.system({"a": model, "b": model}, ["a.out -> b.in"], {"a.size": 100.0}, ["b.y"])
    with Simulator(system, ["b.y"]) as simulator:
        found = simulator.run(stop=0.5, step=0.1)
    assert found[:, 0].tolist() == [0, 0, *(expected(100, k) for k in range(1, 5))]
    assert np.array_equal(found, run_reference(system, ["b.y"], stop=0.5, step=0.1))


@pytest.mark.parametrize("order", [("a", "b", "c"), ("c", "b", "a")])
def test_who_hands_on_the_address_it_was_given_hands_on_what_was_there(shelf, order):
    model = osmp(shelf)
    start = {"a.size": 100.0, "b.mode": float(FORWARD)}
    system = shelf.system(dict.fromkeys(order, model), ["a.out -> b.in", "b.out -> c.in"], start, ["c.y"])
    with Simulator(system, ["c.y"]) as simulator:
        found = simulator.run(stop=0.8, step=0.1)
    assert found[:, 0].tolist() == [0, 0, 0, *(expected(100, k) for k in range(1, 7))]


def test_a_binary_of_fmi_2_reaches_fmi_3_and_one_of_fmi_3_reaches_fmi_2(shelf):
    speaker = shelf.fmu("speaker", 3)
    elements = {"a": osmp(shelf), "s": speaker, "t": speaker, "b": osmp(shelf)}
    start = {"a.size": 7.0}
    system = shelf.system(elements, ["a.out -> s.taken", "t.bytes -> b.in"], start, ["s.heard", "b.y"])
    with Simulator(system, ["s.heard", "b.y"]) as simulator:
        found = simulator.run(stop=0.5, step=0.1)
    assert found[:, 0].tolist() == [0, 0, 7, 14, 21, 28]
    assert found[-1, 1] == sum(b"hel")
    assert np.array_equal(found, run_reference(system, ["s.heard", "b.y"], stop=0.5, step=0.1))


@pytest.mark.parametrize(
    ("mode", "what"),
    [
        (NOWHERE, "a.out was not given"),
        (LESS_THAN_NONE, "a.out is larger than 16 MiB"),
        (TOO_LARGE, "a.out is larger than 16 MiB"),
    ],
)
def test_an_address_that_leads_nowhere_is_not_followed(shelf, mode, what):
    model = osmp(shelf)
    system = shelf.system({"a": model, "b": model}, ["a.out -> b.in"], {"a.mode": float(mode)}, ["b.y"])
    with Simulator(system, ["b.y"]) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=0.2, step=0.1)
    assert (fast.value.element, fast.value.call) == ("a", "fmi2GetInteger")
    with pytest.raises(RunFailed) as slow:
        run_reference(system, ["b.y"], stop=0.2, step=0.1)
    assert str(slow.value) == str(fast.value)
    assert what in str(fast.value)
