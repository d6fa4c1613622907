"""Model exchange: FMPy's CVode integrates the same models, and finds what co-simulation finds."""

from __future__ import annotations

import ctypes

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmu.modelica_models.drive import instances
from fmu.modelica_models.models import BALL, CHECKED, GRAZE, LAG, OSCILLATOR, PULSE, RELAY, ROOT, SAMPLED


@pytest.fixture
def new(cache, version):
    with instances(cache, version) as make:
        yield make


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    ("model", "stop", "outputs"),
    [
        (OSCILLATOR, 10.0, ["x", "energy"]),
        (LAG, 1.0, ["x", "y"]),
        (BALL, 1.4, ["h", "bounces", "last"]),
        (RELAY, 3.0, ["x", "on", "switches"]),
        (SAMPLED, 1.0, ["x"]),
        (PULSE, 1.0, ["x", "count"]),
        (GRAZE, 30.0, ["x", "passed"]),
    ],
    ids=lambda value: getattr(value, "name", None),
)
def test_model_exchange_and_co_simulation_agree(cache, version, model, stop, outputs):
    archive = str(model.fmu(cache, version))
    results = [
        simulate_fmu(
            archive,
            validate=False,
            fmi_type=kind,
            stop_time=stop,
            step_size=0.07,
            output_interval=0.07,
            relative_tolerance=1e-9,
            output=outputs,
        )
        for kind in ("CoSimulation", "ModelExchange")
    ]
    places = [{round(time, 9): k for k, time in enumerate(result["time"])} for result in results]
    common = sorted(set(places[0]) & set(places[1]))
    assert len(common) >= 14
    for name in outputs:
        one, other = (
            np.array([float(result[name][place[time]]) for time in common])
            for result, place in zip(results, places, strict=True)
        )
        # CVode's own error, which grows over the run
        assert np.abs(one - other).max() < 2e-6


def test_indicators_tell_whether_a_relation_is_what_the_equations_hold_it_for(new, version):
    ball = new(BALL, is_exchange=True).ready()
    values = np.zeros(1)
    states = np.array([1e-3, -1.0])

    def indicator(height):
        states[0] = height
        _continuous(ball, states)
        ball.fmu.getEventIndicators(_pointer(values), 1)
        return values[0]

    _leave_event_mode(ball, version)
    assert indicator(1e-3) == 1e-3
    assert indicator(0.0) < 0.0
    assert indicator(-1e-3) == -1e-3


def _pointer(values):
    return values.ctypes.data_as(ctypes.POINTER(ctypes.c_double))


def _continuous(instance, states):
    instance.fmu.setContinuousStates(_pointer(states), len(states))


def _leave_event_mode(instance, version):
    update = instance.fmu.newDiscreteStates if version == 2 else instance.fmu.updateDiscreteStates
    answer = update()
    instance.fmu.enterContinuousTimeMode()
    return answer


def test_an_event_mode_tells_new_states_and_the_next_tick(new, version):
    ball = new(BALL, is_exchange=True).ready()
    _leave_event_mode(ball, version)
    _continuous(ball, np.array([-1e-9, -2.0]))
    ball.fmu.setTime(0.4)
    ball.fmu.enterEventMode()
    again, ends, nominals, has_new_states, has_next, _ = _leave_event_mode(ball, version)
    assert (bool(again), bool(ends), bool(nominals), bool(has_new_states), bool(has_next)) == (
        False, False, False, True, False,
    )  # fmt: skip
    assert (ball.get("v"), ball.get("bounces"), ball.get("last")) == (pytest.approx(1.4), 1, 0.4)
    sampled = new(SAMPLED, is_exchange=True).ready()
    *_, has_next, next_time = _leave_event_mode(sampled, version)
    assert (bool(has_next), next_time) == (True, 0.01)
    for k in range(1, 4):
        sampled.fmu.setTime(next_time)
        sampled.fmu.enterEventMode()
        *_, has_next, next_time = _leave_event_mode(sampled, version)
        assert (sampled.get("at"), next_time) == (k / 100, (k + 1) / 100)


def test_values_follow_the_states_time_and_inputs_that_are_set(new, version):
    lag = new(LAG, is_exchange=True).ready(u=2.0)
    _leave_event_mode(lag, version)
    _continuous(lag, np.array([5.0]))
    assert (lag.get("x"), lag.get("slope"), lag.get("y")) == (5.0, (2.0 - 5.0) / 0.5, 15.0)
    lag.set("u", 7.0)
    assert (lag.get("slope"), lag.get("through")) == (4.0, 12.0)


def test_a_point_where_the_model_cannot_be_solved_is_discarded_and_another_can_be_tried(new, version):
    root = new(ROOT, is_exchange=True).ready()
    _leave_event_mode(root, version)
    name = "fmi2GetDerivatives" if version == 2 else "fmi3GetContinuousStateDerivatives"
    function = root.fmu.dll[name]
    function.restype = ctypes.c_int
    value = (ctypes.c_double * 1)()
    _continuous(root, np.array([-1.0]))
    assert function(ctypes.c_void_p(root.fmu.component), value, ctypes.c_size_t(1)) == 2
    assert "y ^ 2 = x has no solution" in root.messages[-1]
    _continuous(root, np.array([4.0]))
    assert function(ctypes.c_void_p(root.fmu.component), value, ctypes.c_size_t(1)) == 0
    assert root.get("y") == pytest.approx(2.0)


def test_an_assert_fails_the_completed_step(new, version):
    checked = new(CHECKED, is_exchange=True).ready()
    _leave_event_mode(checked, version)
    checked.fmu.completedIntegratorStep()
    _continuous(checked, np.array([0.5]))
    with pytest.raises(FMICallException):
        checked.fmu.completedIntegratorStep()
    assert any("x must stay below top" in text for text in checked.messages)


def test_a_terminate_is_told_after_the_step(new, version):
    checked = new(CHECKED, is_exchange=True).ready(end=0.2, top=9.0)
    _leave_event_mode(checked, version)
    _continuous(checked, np.array([0.25]))
    _, ends = checked.fmu.completedIntegratorStep()
    assert bool(ends)


def test_a_wrong_number_of_states_is_refused(new, version):
    ball = new(BALL, is_exchange=True).ready()
    with pytest.raises(FMICallException):
        _continuous(ball, np.zeros(3))
    assert "3 values, where the model has 2" in ball.messages[-1]
