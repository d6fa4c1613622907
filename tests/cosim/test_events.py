"""Event mode, early return and intermediate updates of FMI 3.0 co-simulation."""

from __future__ import annotations

from dataclasses import replace

import pytest
from oracle.reference import run_reference

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.method import Adaptive, Algorithm, Coupling, Extrapolation, Method

FINE, ENDLESS, ENDS, STANDS_STILL = range(4)
WITHOUT = "(with event mode; `event_mode: off` in the source of its component does without)"
LINEAR = Method(extrapolation=Extrapolation.LINEAR)
RECORD = ["e.y", "e.seen", "e.events", "e.updates", "e.steps"]
EVERY_METHOD = pytest.mark.parametrize(
    "method",
    [Method(), Method(algorithm=Algorithm.GAUSS_SEIDEL), Method(coupling=Coupling.PROPAGATE)],
    ids=["jacobi", "gauss-seidel", "propagate"],
)


def eventful(shelf, **able):
    model = shelf.fmu("eventful", 3)
    return replace(model, capabilities=replace(model.capabilities, **({"has_event_mode": True} | able)))


def alone(model, shelf, **start):
    return shelf.system({"e": model}, (), {f"e.{name}": value for name, value in start.items()}, RECORD)


def same_bits(system, record, method=None, **run):
    run = {"stop": 1.0, "step": 0.25} | run
    method = method or Method()
    with Simulator(system, record, method=method) as simulator:
        rows = [simulator.run(**run) for _ in range(3)]
    slow = run_reference(system, record, method=method, **run)
    for fast in rows:
        assert fast.tobytes() == slow.tobytes()
    return slow


def test_events_inside_a_step_are_handled_where_they_are_if_the_fmu_returns_early(shelf):
    # Events at 5/16, 10/16, 15/16: in the second, third and fourth step of 4/16.
    system = alone(eventful(shelf, can_return_early=True), shelf, period=5 / 16, u=1.0)
    rows = same_bits(system, RECORD)
    assert rows[:, 0].tolist() == [0, 0.25, 0.5, 0.75, 1.0]
    assert rows[:, 2].tolist() == [0, 0, 1, 2, 3]
    assert rows[:, 4].tolist() == [0, 1, 3, 5, 7]


def test_events_inside_a_step_are_handled_at_its_end_if_the_fmu_cannot_return_early(shelf):
    rows = same_bits(alone(eventful(shelf), shelf, period=5 / 16, u=1.0), RECORD)
    assert rows[:, 2].tolist() == [0, 0, 1, 2, 3]
    assert rows[:, 4].tolist() == [0, 1, 2, 3, 4]


def test_a_step_ends_at_an_event_that_is_announced(shelf):
    rows = same_bits(alone(eventful(shelf), shelf, period=5 / 16, announces=1, u=1.0), RECORD)
    assert rows[:, 2].tolist() == [0, 0, 1, 2, 3]
    assert rows[:, 4].tolist() == [0, 1, 3, 5, 7]
    model = eventful(shelf, can_handle_variable_step=False)
    assert same_bits(alone(model, shelf, period=5 / 16, announces=1), RECORD)[:, 4].tolist() == [0, 1, 2, 3, 4]


def test_an_event_at_a_communication_point_shows_what_comes_after_it(shelf):
    for able in ({}, {"can_return_early": True}):
        rows = same_bits(alone(eventful(shelf, **able), shelf, period=0.25), RECORD)
        assert rows[:, 2].tolist() == [0, 1, 2, 3, 4]
        assert rows[:, 4].tolist() == [0, 1, 2, 3, 4]


@EVERY_METHOD
def test_discrete_inputs_are_set_in_event_mode_and_only_when_they_change(shelf, method):
    source = shelf.fmu("counter", 3)
    start = {"c.enable": 1, "c.increment": 2, "e.u": 1.0}
    wires = ["c.count -> e.d"]
    elements = {"c": source, "e": eventful(shelf)}
    rows = same_bits(shelf.system(elements, wires, start, [*RECORD, "c.count"]), [*RECORD, "c.count"], method)
    assert rows[:, 5].tolist() == [0, 2, 4, 6, 8]
    still = shelf.system(elements, wires, start | {"c.increment": 0}, RECORD)
    # The value is given before the initialization ends with an update, which sees it; then nothing changes.
    assert same_bits(still, RECORD, method)[-1, 3] == 1
    assert rows[-1, 3] > 2


def test_a_step_that_is_taken_back_is_no_reason_to_give_discrete_inputs_again(shelf):
    # d is 2 all the time: one update sees it, at the end of the initialization.
    model = shelf.fmu("eventful", 3, "-DMAY_ROLL_BACK", "-DSAVES")
    able = replace(model.capabilities, has_event_mode=True, can_save_state=True)
    source = shelf.fmu("linear", 2, "-DMAY_ROLL_BACK", "-DSAVES")
    elements = {"c": replace(source, capabilities=replace(source.capabilities, can_save_state=True))}
    start = {"c.y0": 2.0, "c.a": 1.0, "e.u": 1.0}
    system = shelf.system(elements | {"e": replace(model, capabilities=able)}, ["c.y -> e.d"], start, RECORD)
    rows = same_bits(system, RECORD, Method(adaptive=Adaptive(1e-3, 1e-3)))
    assert rows[-1, [1, 3]].tolist() == [2, 1]
    # It grows by a half each second, and so often has e an event: as often in the steps that are kept.
    growing = shelf.system(
        elements | {"e": replace(model, capabilities=able)}, ["c.y -> e.d"], start | {"c.a": 2.0}, RECORD
    )
    rows = same_bits(growing, RECORD, Method(adaptive=Adaptive(1e30, 1e30)))
    assert rows[:, 3].tolist() == [1, 2, 4, 6, 8]  # two half steps each, the first with what it was given before


def test_a_text_that_a_step_taken_back_has_changed_is_what_it_was(shelf):
    model = shelf.fmu("speaker", 3, "-DMAY_ROLL_BACK", "-DSAVES", "-DEVENTS")
    able = replace(model.capabilities, has_event_mode=True, can_save_state=True)
    growing = 5
    system = shelf.system(
        dict.fromkeys(("a", "b"), replace(model, capabilities=able)),
        ["a.said -> b.given"],
        {"a.mode": growing, "a.size": 1.0},
        ["b.heard", "b.events"],
    )
    rows = same_bits(system, ["b.heard", "b.events"], Method(adaptive=Adaptive()), stop=3.0, step=0.5)
    # The text grows at 1, 2 and 3 s, in the second of two half steps, and is given where the next begins.
    assert rows[:, 0].tolist() == [1, 1, 1, 2, 2, 3, 3]
    assert rows[:, 1].tolist() == [1, 1, 1, 2, 2, 3, 3]


def test_the_discrete_inputs_of_each_step_are_seen_once(shelf):
    source = shelf.fmu("counter", 3)
    start = {"c.enable": 1, "c.increment": 2}
    system = shelf.system({"c": source, "e": eventful(shelf)}, ["c.count -> e.d"], start, RECORD)
    # Written before the first step: 0; then 2, 4 and 6 (Jacobi writes what the step before left).
    assert same_bits(system, RECORD)[:, 1].tolist() == [0, 0, 2, 6, 12]


@pytest.mark.parametrize(
    ("mode", "message"),
    [
        (ENDLESS, "e: fmi3UpdateDiscreteStates asked for more than 1000 event iterations at one point in time"),
        (STANDS_STILL, "e: fmi3DoStep at t = 0 s returned before the end of the step"),
    ],
)
def test_events_without_an_end_are_a_failure(shelf, mode, message):
    system = alone(eventful(shelf, can_return_early=True), shelf, mode=mode, period=0.25)
    with Simulator(system, RECORD) as simulator, pytest.raises(RunFailed) as fast:
        simulator.run(stop=1.0, step=0.25)
    with pytest.raises(RunFailed) as slow:
        run_reference(system, RECORD, stop=1.0, step=0.25)
    assert str(fast.value).removesuffix(f" {WITHOUT}") == str(slow.value) == message
    assert str(fast.value).endswith(WITHOUT) == (mode == ENDLESS)


def test_an_fmu_that_refuses_the_event_mode_it_declares_runs_without(shelf):
    model = shelf.fmu("eventful", 3, "-DREFUSES_EVENTS")
    eager = replace(model, capabilities=replace(model.capabilities, has_event_mode=True))
    with Simulator(alone(eager, shelf), ["e.y"]) as simulator, pytest.raises(RunFailed) as failed:
        simulator.run(stop=1.0, step=0.25)
    assert str(failed.value) == f"e: fmi3InstantiateCoSimulation returned no instance {WITHOUT}"
    with Simulator(alone(model, shelf, u=2.0), ["e.y"]) as simulator:
        assert simulator.run(stop=1.0, step=0.25)[-1].tolist() == [2.0]


def ramp(shelf, **able):
    """e.u is the time of another element: a straight line."""
    elements = {"t": shelf.fmu("stepper", 2), "e": eventful(shelf, **able)}
    return shelf.system(elements, ["t.y -> e.u"], {}, ["e.y"])


def test_an_fmu_that_asks_within_its_step_is_given_inputs_on_their_way(shelf):
    for able in ({"has_event_mode": False}, {}):
        system = ramp(shelf, provides_intermediate_update=True, **able)
        # The integral of t over 1 s but for the first step, which is held: 1/2 - 1/32 with steps of 1/4.
        assert same_bits(system, ["e.y"], LINEAR)[-1, 0] == 1 / 2 - 1 / 32
        assert same_bits(system, ["e.y"])[-1, 0] == 3 / 8  # held: the left sum


def test_an_fmu_that_asks_for_inputs_with_an_environment_it_was_never_given_is_given_its_own(shelf):
    astray = shelf.fmu("eventful", 3, "-DASTRAY")
    system = ramp(shelf, provides_intermediate_update=True)
    model = replace(astray, capabilities=system.element("e").model.capabilities)
    elements = tuple(replace(e, model=model) if e.name == "e" else e for e in system.elements)
    with Simulator(replace(system, elements=elements), ["e.y"], method=LINEAR) as simulator:
        assert simulator.run(stop=1.0, step=0.25)[-1, 0] == 1 / 2 - 1 / 32


def test_an_fmu_that_does_not_ask_is_given_the_middle_of_the_step(shelf):
    assert same_bits(ramp(shelf), ["e.y"], LINEAR)[-1, 0] == 1 / 2 - 1 / 32


def test_an_fmu_that_cannot_save_its_state_is_refused_by_adaptive_steps(shelf):
    with pytest.raises(Exception, match="state"):
        Simulator(ramp(shelf), ["e.y"], method=Method(adaptive=Adaptive()))
