"""Stepping, sample hits, initialization, saved states and the order of calls."""

from __future__ import annotations

import ctypes

import pytest
from fmpy.fmi1 import FMICallException
from hypothesis import HealthCheck, given, settings, strategies as st


def test_a_plant_steps_once_per_communication_step(workshop, new_slave):
    slave = new_slave(workshop.integrator()).ready(rate=0.5, gain=4.0)
    assert slave.get("x") == 1.0
    slave.step(0.0, 0.25)
    slave.set("rate", 1.0)
    slave.step(0.25, 0.125)
    assert slave.get("x") == 1.0 + 0.25 * 4.0 * 0.5 + 0.125 * 4.0 * 1.0
    assert slave.get("steps") == 2


def test_a_sampled_component_runs_every_hit_of_the_step(workshop, new_slave):
    slave = new_slave(workshop.counter(0.01)).ready(u=1.0)
    assert slave.get("hits") == 0
    slave.step(0.0, 0.05)
    assert slave.get("hits") == 5
    slave.step(0.05, 0.004)
    assert slave.get("hits") == 6
    slave.step(0.054, 0.006)
    assert slave.get("hits") == 6
    slave.step(0.06, 0.0001)
    assert slave.get("hits") == 7


def test_inputs_take_effect_at_the_next_hit_and_outputs_hold_until_then(workshop, new_slave):
    slave = new_slave(workshop.counter(0.1)).ready(u=2.0, first=0.0)
    slave.step(0.0, 0.05)
    assert slave.get("total") == 2.0
    slave.set("u", 100.0)
    assert slave.get("total") == 2.0
    slave.step(0.05, 0.05)
    assert slave.get("total") == 2.0
    slave.step(0.1, 0.05)
    assert slave.get("total") == 102.0


@pytest.mark.parametrize(
    ("period", "size", "steps"), [(0.01, 0.01, 6001), (0.01, 0.05, 1200), (0.05, 0.01, 6000), (0.1, 0.03, 1000)]
)
@pytest.mark.parametrize("clock", ["counted", "summed up"])
def test_no_hit_is_lost_or_doubled_over_a_long_run(workshop, new_slave, period, size, steps, clock):
    slave = new_slave(workshop.counter(period)).ready()
    time = 0.0
    for k in range(steps):
        time = k * size if clock == "counted" else time
        slave.step(time, size)
        time += size
        if k % 97 == 0 or k == steps - 1:
            # hits at j*period < (k+1)*size, in whole hundredths of a second
            expected = -(-round((k + 1) * size * 100) // round(period * 100))
            assert slave.get("hits") == expected


def test_hits_count_from_the_start_time(workshop, new_slave):
    slave = new_slave(workshop.counter(0.01)).ready(start_time=1234.567)
    for k in range(100):
        slave.step(1234.567 + k * 0.01, 0.01)
    assert slave.get("hits") == 100


@pytest.fixture
def hits_of(workshop, new_slave):
    """Counts the hits of one instance over steps given in hundredths of a second."""
    slave = new_slave(workshop.counter(0.07))

    def count(hundredths):
        slave.fmu.reset()
        slave.ready()
        passed = 0
        for size in hundredths:
            slave.step(passed * 0.01, size * 0.01)
            passed += size
        return slave.get("hits"), passed

    return count


@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(hundredths=st.lists(st.integers(1, 40), min_size=1, max_size=60))
def test_any_partition_of_time_has_the_hits_before_its_end(hits_of, hundredths):
    hits, passed = hits_of(hundredths)
    assert hits == -(-passed // 7)


def test_init_sees_zeros_and_the_values_as_set_however_often_it_runs(workshop, new_slave):
    slave = new_slave(workshop.counter()).enter()
    assert slave.get("total") == 3.0
    slave.set("u", 10.0)
    assert slave.get("total") == 13.0
    slave.set("first", 1.0)
    assert slave.get("total") == 11.0
    assert slave.get("total") == 11.0
    slave.fmu.exitInitializationMode()
    assert slave.get("total") == 11.0


def test_two_instances_do_not_know_each_other(workshop, new_slave):
    component = workshop.counter()
    one, other = new_slave(component).ready(u=1.0), new_slave(component).ready(u=5.0, first=0.0)
    for k in range(3):
        one.step(k * 0.01, 0.01)
    other.step(0.0, 0.01)
    assert (one.get("total"), one.get("hits")) == (6.0, 3)
    assert (other.get("total"), other.get("hits")) == (5.0, 1)


def test_a_reset_instance_is_equal_to_a_fresh_one_to_the_last_byte(workshop, new_slave):
    component = workshop.counter()
    fresh = new_slave(component).saved()
    used = new_slave(component).ready(start_time=1.0, u=1.5, first=9.0)
    used.step(1.0, 0.5)
    assert used.saved() != fresh
    used.fmu.reset()
    assert used.saved() == fresh


def test_a_saved_state_brings_back_time_hits_and_values(workshop, new_slave):
    component = workshop.counter(0.02)
    slave = new_slave(component).ready(u=1.0)
    slave.step(0.0, 0.05)
    kept = slave.saved()
    slave.set("u", 2.0)
    slave.step(0.05, 0.05)
    first = (slave.get("total"), slave.get("hits"))
    for target in (slave, new_slave(component)):
        target.load(kept)
        target.set("u", 2.0)
        target.step(0.05, 0.05)
        assert (target.get("total"), target.get("hits")) == first
        assert target.saved() == slave.saved()


def test_a_state_that_is_not_of_this_component_is_refused(workshop, new_slave):
    slave, other = new_slave(workshop.counter()), new_slave(workshop.integrator())
    for foreign in (other.saved(), slave.saved()[:-1], bytes(len(slave.saved()))):
        with pytest.raises(FMICallException):
            slave.load(foreign)
        assert "not a saved state of this component" in slave.messages.pop()


def test_a_wrong_token_is_refused_with_a_message(workshop, new_slave, version):
    slave = new_slave(workshop.counter())
    wrong = type(slave)(slave.model)
    with pytest.raises(Exception, match="Failed to instantiate"):
        wrong.create("{of another build}")
    assert "different builds" in wrong.messages[0]


def _early_step(slave):
    slave.step(0.0, 0.01)


def _early_get(slave):
    slave.get("hits")


def _early_exit(slave):
    slave.fmu.exitInitializationMode()


def _early_terminate(slave):
    slave.enter().fmu.terminate()


def _second_enter(slave):
    slave.ready().fmu.enterInitializationMode()


def _set_output(slave):
    slave.ready().set("total", 1.0)


def _set_fixed_parameter_while_stepping(slave):
    slave.ready().set("bias", 1)


def _set_after_the_end(slave):
    slave.ready().fmu.terminate()
    slave.set("u", 1.0)


def _step_after_the_end(slave):
    slave.ready().fmu.terminate()
    slave.step(0.0, 0.01)


def _step_of_nothing(slave):
    slave.ready().step(0.0, 0.0)


def _step_of_infinity(slave):
    slave.ready().step(0.0, float("inf"))


def _step_from_elsewhere(slave):
    slave.ready().step(0.5, 0.01)


def _start_at_nan(slave):
    slave.enter(start_time=float("nan"))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (_early_step, "DoStep: not allowed before the initialization mode"),
        (_early_get, "not allowed before the initialization mode"),
        (_early_exit, "ExitInitializationMode: not allowed before the initialization mode"),
        (_early_terminate, "Terminate: not allowed in the initialization mode"),
        (_second_enter, "EnterInitializationMode: not allowed while stepping"),
        (_set_output, "variable 'total' cannot be set while stepping"),
        (_set_fixed_parameter_while_stepping, "variable 'bias' cannot be set while stepping"),
        (_set_after_the_end, "not allowed after the termination"),
        (_step_after_the_end, "not allowed after the termination"),
        (_step_of_nothing, "the step of 0 s is not positive and finite"),
        (_step_of_infinity, "is not positive and finite"),
        (_step_from_elsewhere, "starts at 0.5 s, but the instance stands at 0 s"),
        (_start_at_nan, "the start time is not a finite number"),
    ],
)
def test_a_call_out_of_order_is_refused_and_told(workshop, new_slave, call, message):
    slave = new_slave(workshop.counter())
    with pytest.raises(FMICallException):
        call(slave)
    assert message in slave.messages[-1]


def test_a_refused_call_leaves_the_instance_usable(workshop, new_slave):
    slave = new_slave(workshop.counter()).ready(u=1.0)
    with pytest.raises(FMICallException):
        slave.step(7.0, 0.01)
    slave.step(0.0, 0.01)
    assert slave.get("hits") == 1


@pytest.mark.parametrize("version", [2])
def test_fmi_2_needs_the_experiment_set_up_first(workshop, new_slave):
    slave = new_slave(workshop.counter())
    with pytest.raises(FMICallException):
        slave.fmu.enterInitializationMode()
    assert "fmi2SetupExperiment has to be called first" in slave.messages[0]


@pytest.mark.parametrize("version", [3])
@pytest.mark.parametrize(
    "name", ["fmi3EnterEventMode", "fmi3EnterStepMode", "fmi3EnterConfigurationMode", "fmi3EvaluateDiscreteStates"]
)
def test_what_fmi_3_asks_for_and_this_fmu_has_not_is_refused_by_name(workshop, new_slave, name):
    slave = new_slave(workshop.counter())
    function = getattr(slave.fmu.dll, name)
    function.argtypes, function.restype = [ctypes.c_void_p], ctypes.c_int
    assert function(slave.fmu.component) == 3
    assert f"{name}: there " in slave.messages[0]


@pytest.mark.parametrize("version", [3])
def test_every_function_of_fmi_3_is_exported(workshop, new_slave):
    from fmpy.fmi3 import _FMU3

    slave = new_slave(workshop.counter())
    names = [name for name in vars(_FMU3) if name.startswith("fmi3")]
    assert len(names) > 60
    assert [name for name in names if not hasattr(slave.fmu.dll, name)] == []
