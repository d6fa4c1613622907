"""An FMU that asks to end the simulation ends it: the rows until then are the result, and it is told who asked when."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from cosim.exchange_models import model, system
from oracle.reference import run_reference

from dse.cosim.simulator import Simulator
from dse.domain.fmu import Capabilities
from dse.domain.method import Adaptive, Algorithm, Coupling, Method

BOTH = pytest.mark.parametrize("version", [2, 3])
NEXT_STATES = {2: "fmi2NewDiscreteStates", 3: "fmi3UpdateDiscreteStates"}
WANTS_TO_END, EVENT_ENDS, FAULTY_ENDS = 3, 2, 8


def ended(simulated, record, *, stop=1.0, step=0.1, method=None, start=None):
    """The rows of the kernel, fresh, after a proof and after a reset, and in plain Python; and what was told."""
    method = method or Method()
    with Simulator(simulated, record, method=method) as simulator:
        rows = [simulator.run(stop=stop, step=step, start=start or {}).copy() for _ in range(3)]
        told, is_reset = simulator.ended, simulator.reset_is_trusted
    assert is_reset
    slow = run_reference(simulated, record, stop=stop, step=step, method=method, start=start or {})
    assert {each.tobytes() for each in rows} == {slow.tobytes()}
    return slow, told


@BOTH
@pytest.mark.parametrize(("at", "n_rows"), [(0.35, 4), (0.4, 5), (1.0, 11)])
def test_a_model_ends_by_an_event(shelf, version, at, n_rows):
    simulated = system({"e": model("ender", version, shelf.folder)}, (), {"e.how": 1, "e.at": at}, ["e.x"])
    rows, told = ended(simulated, ["e.x"])
    assert rows[:, 0] == pytest.approx(0.1 * np.arange(n_rows))
    assert told == f"e: {NEXT_STATES[version]} at t = {at:g} s asked to end the simulation"


@BOTH
def test_a_model_ends_when_a_step_of_the_solver_is_completed(shelf, version):
    simulated = system({"e": model("ender", version, shelf.folder)}, (), {"e.how": 2, "e.at": 0.35}, ["e.x"])
    rows, told = ended(simulated, ["e.x"])
    assert rows[:, 0] == pytest.approx(0.1 * np.arange(5))
    assert f"fmi{version}CompletedIntegratorStep at t = 0.4 s asked" in told


def test_a_slave_that_discards_its_step_ends_with_the_last_row(shelf):
    start = {"s.mode": WANTS_TO_END, "s.most": 0.05}
    simulated = shelf.system({"s": shelf.fmu("stepper", 2)}, start=start, record=["s.y"])
    rows, told = ended(simulated, ["s.y"])
    assert rows.tolist() == [[0.0]]
    assert told == "s: fmi2DoStep at t = 0 s asked to end the simulation"


def eventful(shelf, **able):
    capabilities = Capabilities(can_handle_variable_step=True, has_event_mode=True, **able)
    return replace(shelf.fmu("eventful", 3), capabilities=capabilities)


METHODS = {
    "jacobi": (Method(), 6),
    "gauss_seidel": (Method(algorithm=Algorithm.GAUSS_SEIDEL), 6),
    "shorter steps": (Method(steps={"e": 0.05}), 6),
    "longer steps": (Method(steps={"e": 0.5}), 1),  # the step from 0 on was not made by all
    "carried on": (Method(coupling=Coupling.PROPAGATE), 5),  # what has ended is given nothing any more
}


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("first", [True, False])
def test_the_others_come_to_the_row_where_it_is_asked_for(shelf, name, first):
    """An event at 0.5 s: in step mode, told as it comes."""
    method, n_rows = METHODS[name]
    parts = {"e": eventful(shelf), "t": shelf.fmu("stepper", 2)}
    start = {"e.mode": EVENT_ENDS, "e.period": 0.5}
    record = ["t.y", "e.steps"]
    simulated = shelf.system(parts if first else dict(reversed(parts.items())), ["t.y -> e.u"], start, record)
    rows, told = ended(simulated, record, method=method)
    assert rows[:, 0] == pytest.approx(0.1 * np.arange(n_rows))
    assert told == "e: fmi3UpdateDiscreteStates at t = 0.5 s asked to end the simulation"


def test_adaptive_steps_end_with_the_last_row(shelf):
    """What is tried may be taken back: the row at the end of a step is not the end's."""
    for at, n_rows in ((0.35, 4), (0.4, 4)):
        simulated = system({"e": model("ender", 2, shelf.folder)}, (), {"e.how": 1, "e.at": at}, ["e.x"])
        rows, told = ended(simulated, ["e.x"], method=Method(adaptive=Adaptive(1e-3, 1e-6, 1e-6)))
        assert len(rows) == n_rows
        assert f"at t = {at:g} s asked" in told


def test_what_is_whole_or_fails_is_not_called_ended(shelf):
    simulated = shelf.system({"f": shelf.fmu("faulty", 3)}, start={"f.mode": FAULTY_ENDS}, record=["f.y"])
    with Simulator(simulated, ["f.y"]) as simulator:
        assert len(simulator.run(stop=1.0, step=0.1, start={"f.at": 0.45})) == 7
        assert simulator.ended
        assert len(simulator.run(stop=1.0, step=0.1, start={"f.at": 2.0})) == 11
        assert not simulator.ended
