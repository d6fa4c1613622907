"""Memory whose address FMUs keep is never given back, and does not grow."""

from __future__ import annotations

import ctypes

from dse.cosim.binding import persistent_memory
from dse.cosim.simulator import Simulator


def addresses(simulator: Simulator) -> int:
    return ctypes.addressof(simulator._tables.elements.structures)


def test_memory_does_not_grow_with_the_simulators_that_were_closed(shelf):
    system = shelf.system({"a": shelf.fmu("linear"), "b": shelf.fmu("linear")}, ["a.y -> b.u", "b.y -> a.u"])
    counts = []
    for _ in range(3 * persistent_memory.QUARANTINE):
        with Simulator(system, ["a.y"]) as simulator:
            simulator.run(stop=1.0, step=0.1)
        counts.append(len(persistent_memory._lasting))
    assert counts[-1] == counts[2 * persistent_memory.QUARANTINE]


def test_memory_that_somebody_still_writes_to_is_not_used_again(shelf):
    system = shelf.system({"a": shelf.fmu("linear")}, (), {"a.u": 1.0}, ["a.y"])
    with Simulator(system, ["a.y"]) as haunted:
        where = addresses(haunted)
        logs = haunted._tables.elements._logs
    logs[0].count += 1
    seen = set()
    for _ in range(2 * persistent_memory.QUARANTINE):
        with Simulator(system, ["a.y"]) as later:
            seen.add(addresses(later))
    assert where not in seen


def test_simulators_that_are_open_at_once_have_memory_of_their_own(shelf):
    system = shelf.system({"a": shelf.fmu("linear")}, (), {"a.u": 1.0}, ["a.y"])
    with Simulator(system, ["a.y"]) as one, Simulator(system, ["a.y"]) as other:
        assert addresses(one) != addresses(other)


def test_memory_of_a_simulator_that_nobody_closed_stays(shelf):
    system = shelf.system({"a": shelf.fmu("linear")}, (), {"a.u": 1.0}, ["a.y"])
    simulator = Simulator(system, ["a.y"])
    where = addresses(simulator)
    del simulator
    assert where in {ctypes.addressof(elements) for elements, _ in persistent_memory._lasting}
