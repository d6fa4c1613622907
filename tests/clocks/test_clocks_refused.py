"""What clocks may not do, and what they do not go together with: refused by name."""

from __future__ import annotations

from dataclasses import replace

import pytest

from clocks.fmus import Workshop, description, system_of
from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import FmiInterface
from dse.domain.method import Adaptive, Method
from dse.errors import DseError

COUNTDOWN, CONSTANT = 'intervalVariability="countdown"', 'intervalVariability="constant" intervalDecimal="0.3"'
ENDLESS, NEGATIVE, ENDS, ALWAYS_AGAIN = 2, 3, 4, 8
RECORD = ["a.count", "a.y"]


def ticker(workshop: Workshop, timing: str = COUNTDOWN, **flags: str):
    return workshop.open(workshop.ticker(timing, **flags))


def refused(system, method=None) -> str:
    with pytest.raises(DseError) as error:
        Simulator(system, RECORD, method=method or Method())
    return str(error.value)


def failed(system, **run) -> RunFailed:
    with Simulator(system, RECORD) as simulator, pytest.raises(RunFailed) as failure:
        simulator.run(**({"stop": 1.0, "step": 0.25} | run))
    return failure.value


@pytest.mark.parametrize(
    ("wire", "message"),
    [
        ("a.bell -> b.x", "a.bell -> b.x: a clock can be wired to a clock only"),
        ("a.y -> b.ring", "a.y -> b.ring: a clock can be wired to a clock only"),
        ("a.ring -> b.ring", "a.ring: a wire starts at a clock that neither is an output nor ticks by itself"),
        ("a.bell -> b.tick", "b.tick: it ticks by itself (countdown), so no wire can end there"),
        ("a.bell -> b.bell", "b.bell: a wire ends at what is not an input"),
    ],
)
def test_wires_that_no_tick_can_go_over(workshop: Workshop, wire, message):
    a = ticker(workshop)
    assert message in refused(system_of({"a": a, "b": a}, [wire], {}, RECORD))


def test_two_wires_at_one_clock(workshop: Workshop):
    a = ticker(workshop)
    system = system_of(dict.fromkeys("abc", a), ["a.bell -> b.ring", "c.bell -> b.ring"], {}, RECORD)
    assert "b.ring: 2 wires end at one input" in refused(system)


def test_clocks_that_nobody_can_let_tick(workshop: Workshop):
    model = ticker(workshop)
    without = replace(model, capabilities=replace(model.capabilities, has_event_mode=False))
    text = refused(system_of({"a": without}, (), {}, RECORD))
    assert "a.tick: it is a clock that ticks by itself, but its FMU has no event mode (hasEventMode) to tick in" in text
    exchange = replace(model, interface=FmiInterface.MODEL_EXCHANGE)
    text = refused(system_of({"a": exchange, "b": model}, ["b.sum -> a.u", "b.bell -> a.ring"], {}, RECORD))
    assert "a.tick: it is a clock that ticks by itself, which is supported for co-simulation only" in text
    assert "a.u: a variable that belongs to a clock is supported for co-simulation with event mode only" in text
    assert "a.ring: clocks are supported for co-simulation with event mode only" in text


def test_methods_that_clocks_do_not_go_together_with(workshop: Workshop):
    system = system_of({"a": ticker(workshop)}, (), {}, RECORD)
    assert "a: clocks that tick do not go together with an adaptive step" in refused(
        system, Method(adaptive=Adaptive())
    )
    text = refused(system, Method(steps={"a": 0.5}))
    assert text.startswith("a: a step of its own does not go together with clocks that tick")


def test_a_clock_is_recorded_as_the_number_of_its_ticks(workshop: Workshop):
    system = system_of({"a": ticker(workshop, CONSTANT)}, (), {}, RECORD)
    with Simulator(system, ["a.count", "a.tick", "a.ring"]) as simulator:
        for _ in range(2):  # counted anew in each run
            rows = simulator.run(stop=0.9, step=0.15)
            assert rows[:, 1].tolist() == rows[:, 0].tolist() == [1, 1, 2, 2, 3, 3, 4]
            assert not rows[:, 2].any()


def test_an_fmu_that_cannot_stop_where_a_clock_ticks(workshop: Workshop):
    model = ticker(workshop, CONSTANT, canHandleVariableCommunicationStepSize="false")
    system = system_of({"a": model}, (), {}, RECORD)
    failure = failed(system)
    assert str(failure) == (
        "a takes only steps of one length, and a.tick ticks at t = 0.3 s, between two communication points; "
        "use a step that ends there"
    )
    assert (failure.element, failure.time) == ("a", 0.25)
    with Simulator(system, RECORD) as simulator:
        assert simulator.run(stop=0.9, step=0.15)[:, 0].tolist() == [1, 1, 2, 2, 3, 3, 4]
    both = system_of({"b": ticker(workshop, CONSTANT), "a": model}, ["b.bell -> a.ring"], {}, RECORD)
    assert failed(both).element == "a"


def test_intervals_that_no_clock_can_have(workshop: Workshop):
    for timing in (COUNTDOWN, 'intervalVariability="fixed"'):
        failure = failed(system_of({"a": ticker(workshop, timing)}, (), {"a.mode": NEGATIVE, "a.kind": 4.0}, RECORD))
        assert str(failure) == "a.tick: its FMU gives -1 s for its ticks in the initialization"
        assert (failure.call, failure.element) == ("", "a")
    failure = failed(system_of({"a": ticker(workshop, 'intervalVariability="tunable"')}, (), {"a.period": 0.0}, RECORD))
    assert str(failure) == "a.tick: its FMU gives 0 s for its ticks in the initialization"


def test_a_clock_that_never_stops_ticking(workshop: Workshop):
    system = system_of({"a": ticker(workshop)}, (), {"a.mode": ENDLESS, "a.kind": 4.0, "a.period": 0.3}, RECORD)
    assert str(failed(system)) == "a.tick ticks more than 1000 times at t = 0.3 s"


def test_updates_without_an_end(workshop: Workshop):
    failure = failed(system_of({"a": ticker(workshop)}, (), {"a.mode": ALWAYS_AGAIN, "a.period": 9.0}, RECORD))
    what = "a: fmi3UpdateDiscreteStates at t = 0 s asked for more than 1000 event iterations at one point in time"
    assert str(failure) == what


def test_what_goes_round_among_clocked_variables_must_settle(workshop: Workshop):
    a = ticker(workshop, CONSTANT)
    round_and_round = {"a": a, "b": a}, ["a.sum -> b.u", "b.sum -> a.u"]
    # a.sum = b.sum + bias, b.sum = a.sum
    with Simulator(system_of(*round_and_round, {}, RECORD), RECORD) as simulator:
        assert simulator.run(stop=1.0, step=0.25)[-1, 0] == 4
    failure = failed(system_of(*round_and_round, {"a.bias": 1.0}, RECORD))
    assert str(failure).endswith(".tick: what ticks with it, and what belongs to that, does not settle at t = 0 s")


def test_an_end_that_an_fmu_asks_for_when_a_clock_ticks(workshop: Workshop):
    start = {"a.mode": ENDS, "a.kind": 4.0, "a.period": 0.25}
    with Simulator(system_of({"a": ticker(workshop)}, (), start, RECORD), RECORD) as simulator:
        rows = simulator.run(stop=2.0, step=0.25)
        assert rows[:, 1].tolist() == [0, 0.25, 0.5, 0.75]
        assert simulator.ended == "a: fmi3UpdateDiscreteStates at t = 0.75 s asked to end the simulation"
    with Simulator(system_of({"a": ticker(workshop)}, (), start, RECORD), RECORD) as simulator:
        assert simulator.run(stop=2.0, step=0.5)[:, 1].tolist() == [0, 0.5]


def test_descriptions_that_say_no_time(workshop: Workshop):
    for timing, message in (
        ('intervalVariability="constant"', "variable 'tick' is a constant clock, but has no interval"),
        ('intervalVariability="constant" intervalDecimal="0"', "variable 'tick' cannot tick every 0 s from 0 s on"),
        ('intervalVariability="hourly"', "intervalVariability"),
        ("", "variable 'tick' does not declare when it ticks: it has no 'intervalVariability'"),
    ):
        with pytest.raises(DseError) as error:
            ticker(workshop, timing)
        assert message in str(error.value)


def test_a_variable_of_a_clock_that_is_not_there_belongs_to_none(workshop: Workshop):
    model = ticker(workshop, CONSTANT)
    y = replace(model.variables["y"], clocks=(99,))
    model = replace(model, variables={**model.variables, "y": y})
    with Simulator(system_of({"a": model}, (), {}, RECORD), RECORD) as simulator:
        assert simulator.run(stop=1.0, step=0.25)[:, 1].tolist() == [0, 0.25, 0.5, 0.75, 1.0]


def test_an_fmu_for_scheduled_execution_only(workshop: Workshop):
    text = description("ticker", []).replace("<CoSimulation", "<ScheduledExecution")
    with pytest.raises(DseError, match="the FMU is for scheduled execution only, which is not supported"):
        workshop.open(workshop.build("ticker", "ticker", text))
