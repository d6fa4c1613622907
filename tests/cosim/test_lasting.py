"""Memory whose address FMUs keep is never given back, and does not grow."""

from __future__ import annotations

import ctypes

from dse.cosim import lasting
from dse.cosim.simulator import Simulator


def addresses(simulator: Simulator) -> int:
    return ctypes.addressof(simulator._tables.elements)


def test_the_next_simulator_takes_over_the_memory_of_a_closed_one(shelf):
    system = shelf.system({"a": shelf.fmu("linear"), "b": shelf.fmu("linear")}, ["a.y -> b.u", "b.y -> a.u"])
    with Simulator(system, ["a.y"]) as first:
        first.run(stop=1.0, step=0.1)
        was = addresses(first)
    kept = len(lasting._lasting)
    for _ in range(20):
        with Simulator(system, ["a.y"]) as later:
            later.run(stop=1.0, step=0.1)
            assert addresses(later) == was
    assert len(lasting._lasting) == kept


def test_simulators_that_are_open_at_once_have_memory_of_their_own(shelf):
    system = shelf.system({"a": shelf.fmu("linear")}, (), {"a.u": 1.0}, ["a.y"])
    with Simulator(system, ["a.y"]) as one, Simulator(system, ["a.y"]) as other:
        assert addresses(one) != addresses(other)


def test_memory_of_a_simulator_that_nobody_closed_stays(shelf):
    system = shelf.system({"a": shelf.fmu("linear")}, (), {"a.u": 1.0}, ["a.y"])
    simulator = Simulator(system, ["a.y"])
    where = addresses(simulator)
    del simulator
    assert where in {ctypes.addressof(elements) for elements, _ in lasting._lasting}
