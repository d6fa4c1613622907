"""What goes wrong in a model exchange FMU is told by name, with the element and the time; nothing hangs."""

from __future__ import annotations

from dataclasses import replace

import pytest
from cosim.exchange_models import model, system

from dse.cosim.simulator import RunFailed, Simulator
from dse.domain.fmu import Exchange, FmiInterface
from dse.errors import DseError

BOTH = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="session")
def folder(shelf):
    return shelf.folder


def failure_of(fmu, start, *, stop=1.0, step=0.1) -> RunFailed:
    names = ["e.x"]
    start = {f"e.{name}": value for name, value in start.items()}
    with Simulator(system({"e": fmu}, (), start, names), names) as simulator, pytest.raises(RunFailed) as failure:
        simulator.run(stop=stop, step=step)
    assert failure.value.element == "e"
    return failure.value


DERIVATIVE, INDICATOR, REFUSED, ERROR, NO_END, NO_TIME, BOUNDLESS, STATE, NEVER = range(1, 10)


@BOTH
@pytest.mark.parametrize(
    ("how", "what"),
    [
        (DERIVATIVE, "e: the derivative of x is not a finite number at t = 0.35 s"),
        (INDICATOR, "e: event indicator 1 is not a finite number at t = 0.35 s"),
        (NO_END, "e: the event iteration finds no end in 100 passes at t = 0.35 s"),
        (NO_TIME, "e chatters: 32 events with next to no time between them at t = 0.35 s"),
        (NEVER, "e: the time of its next event is not a number at t = 0.35 s"),
        (STATE, "e: the state x is not a finite number at t = 0.35 s"),
        (BOUNDLESS, "e: no step of the solver is small enough for the tolerance of 1e-06 at t = 0.35"),
    ],
)
def test_what_cannot_be_integrated_is_told(folder, version, how, what):
    failure = failure_of(model("faulty", version, folder), {"how": how, "at": 0.35})
    assert failure.what.startswith(what)
    assert failure.time == pytest.approx(0.3)


@BOTH
def test_derivatives_that_are_refused_at_every_step_are_told_as_the_fmu_did(folder, version):
    failure = failure_of(model("faulty", version, folder), {"how": REFUSED, "at": 0.35})
    name = "fmi2GetDerivatives" if version == 2 else "fmi3GetContinuousStateDerivatives"
    assert failure.what == f"e: {name} at t = 0.3 s returned discard"
    assert failure.call == name


@BOTH
def test_an_error_is_told_with_what_the_fmu_logged(folder, version):
    failure = failure_of(model("faulty", version, folder), {"how": ERROR, "at": 0.35})
    assert "returned error" in failure.what
    assert failure.log == ("the road has ended",)


@BOTH
def test_chattering_fails_by_name_and_does_not_hang(folder, version):
    failure = failure_of(model("relay", version, folder), {"band": 1e-12}, step=1.0)
    assert failure.what.startswith("e chatters: 32 events of event indicator 1 with next to no time between them at t")


def test_chattering_that_gets_on_a_little_fails_after_a_million_steps(folder):
    failure = failure_of(model("relay", 2, folder), {"band": 1e-7}, step=1.0)
    assert failure.what.startswith("e: more than 1000000 steps of the solver in one communication step at t = 0.5")


def test_another_number_of_states_than_described_is_told(folder):
    fmu = model("oscillator", 3, folder, "-DCOUNTED_STATES=3")
    assert failure_of(fmu, {}).what == "e: the FMU has 3 continuous states, which its description does not declare"


@BOTH
def test_a_failure_leaves_the_simulator_usable(folder, version):
    fmu = model("faulty", version, folder)
    with Simulator(system({"e": fmu}, (), {}, ["e.x"]), ["e.x"]) as simulator:
        for _ in range(3):
            with pytest.raises(RunFailed):
                simulator.run(stop=1.0, step=0.1, start={"e.how": DERIVATIVE, "e.at": 0.35})
            found = simulator.run(stop=1.0, step=0.1, start={"e.how": 0, "e.at": 0.0})
            assert found[-1, 0] == pytest.approx(1.0, abs=1e-12)


@BOTH
def test_a_library_without_a_function_of_model_exchange_is_refused_by_name(shelf, version):
    fmu = replace(shelf.fmu("linear", version), interface=FmiInterface.MODEL_EXCHANGE, exchange=Exchange((), (), 0, 0))
    with pytest.raises(DseError, match="lacks the function"):
        Simulator(system({"e": fmu}, (), {}, ["e.y"]), ["e.y"])
