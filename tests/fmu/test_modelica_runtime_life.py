"""Life of an instance of a Modelica model: initialization, parameters, kinds, saved states, reset, refused calls."""

from __future__ import annotations

import ctypes
import math

import pytest
from fmpy.fmi1 import FMICallException
from fmu.modelica_models.drive import instances
from fmu.modelica_models.models import BALL, CHECKED, KINDS, LAG, OSCILLATOR, RELAY, ROOT, SAMPLED, VAN_DER_POL


@pytest.fixture
def new(cache, version):
    with instances(cache, version) as make:
        yield make


def test_values_read_in_the_initialization_follow_those_that_are_set(new):
    made = new(OSCILLATOR).enter()
    assert made.get("energy") == 0.5 * 4.0
    made.set("rate", 3.0)
    assert made.get("energy") == 0.5 * 9.0
    made.set("x", 2.0)
    assert made.get("energy") == 0.5 * 9.0 * 4.0
    assert made.get("x") == 2.0
    made.fmu.exitInitializationMode()
    assert made.get("energy") == 18.0


def test_a_tunable_parameter_and_what_depends_on_it_change_from_step_to_step(new):
    made = new(OSCILLATOR).ready(tolerance=1e-9)
    made.step(1.0)
    x, v = made.get("x"), made.get("v")
    made.set("rate", 5.0)
    assert made.get("rate") == 5.0
    assert made.get("stiffness") == 25.0
    made.step(0.7)
    assert made.get("stiffness") == 25.0
    assert made.get("x") == pytest.approx(x * math.cos(3.5) + v / 5.0 * math.sin(3.5), abs=1e-7)


def test_outputs_follow_what_is_set_between_two_steps(new):
    made = new(LAG).ready(u=1.0)
    made.step(0.1)
    x = made.get("x")
    assert made.get("through") == 1.0 + x
    made.set("u", 100.0)
    assert made.get("through") == 100.0 + x
    assert made.get("x") == x
    made.set("u", 1.0)
    assert made.get("through") == 1.0 + x


def test_looking_at_the_outputs_between_setting_and_stepping_changes_no_bit_of_the_step(new):
    looking, plain = new(LAG).ready(u=1.0), new(LAG).ready(u=1.0)
    for k in range(5):
        for made in (looking, plain):
            made.set("u", 1.0 + k)
        assert looking.get("through") == 1.0 + k + looking.get("x")
        for made in (looking, plain):
            made.step(0.1)
    assert [looking.get(name) for name in ("x", "through")] == [plain.get(name) for name in ("x", "through")]


@pytest.mark.parametrize(
    ("name", "value"), [("gain", 1.0), ("y", 1.0), ("slope", 0.0)], ids=["fixed", "output", "derivative"]
)
def test_what_cannot_be_set_while_stepping_is_refused_by_name(new, name, value):
    made = new(LAG).ready()
    with pytest.raises(FMICallException):
        made.set(name, value)
    assert f"variable '{name}' cannot be set while stepping" in made.messages[-1]


def test_whole_numbers_truth_values_and_enumerations_are_converted_both_ways(new):
    made = new(KINDS).ready(flag=1, count=-5, mode=3)
    assert (made.get("twice"), made.get("next"), bool(made.get("not_flag"))) == (-10, 1, False)
    made.set("flag", 0)
    made.set("count", 2_000_000_000)
    made.set("mode", 1)
    made.step(0.1)
    assert (made.get("count"), made.get("next"), bool(made.get("not_flag"))) == (2_000_000_000, 2, True)


@pytest.mark.parametrize("mode", [0, 4, -1])
def test_an_item_an_enumeration_does_not_have_is_refused(new, mode):
    made = new(KINDS).ready()
    with pytest.raises(FMICallException):
        made.set("mode", mode)
    assert f"{mode} does not fit 'mode', which takes 1 … 3" in made.messages[-1]


def test_an_integer_beyond_32_bits_is_refused_not_cut(new):
    made = new(KINDS).ready()
    made.set("count", 2_000_000_000)
    made.step(0.1)
    with pytest.raises(FMICallException):
        made.get("twice")
    assert "the value 4000000000 of 'twice' is not in" in made.messages[-1]


def test_a_variable_of_another_kind_is_refused(new):
    made = new(KINDS).ready()
    getter = made.fmu.getReal if made.version == 2 else made.fmu.getFloat64
    with pytest.raises(FMICallException):
        getter([0])
    assert "variable 'flag' is of the kind Boolean" in made.messages[-1]


def test_what_is_not_a_number_is_never_given_out(new):
    made = new(KINDS).ready(count=7)
    with pytest.raises(FMICallException):
        made.get("not_a_number")
    assert "at 0 s: variable 'not_a_number' is not a number" in made.messages[-1]


@pytest.mark.sampled(2)
@pytest.mark.parametrize("model", [OSCILLATOR, BALL, RELAY, SAMPLED, VAN_DER_POL], ids=lambda model: model.name)
def test_a_restored_state_goes_on_to_the_last_bit(new, model):
    one = new(model).ready()
    for k in range(7):
        one.fmu.doStep(k * 0.037, 0.037)
    kept = one.saved()
    for k in range(7, 20):
        one.fmu.doStep(k * 0.037, 0.037)
    other = new(model)
    other.load(kept)
    assert other.saved() == kept
    for k in range(7, 20):
        other.fmu.doStep(k * 0.037, 0.037)
    assert other.saved() == one.saved()
    one.load(kept)
    for k in range(7, 20):
        one.fmu.doStep(k * 0.037, 0.037)
    assert other.saved() == one.saved()


@pytest.mark.parametrize("model", [OSCILLATOR, BALL, SAMPLED], ids=lambda model: model.name)
def test_a_reset_instance_is_equal_to_a_fresh_one_to_the_last_byte(new, model):
    fresh, used = new(model), new(model)
    blank = fresh.saved()
    used.ready(tolerance=1e-9, start_time=1.0)
    used.step(0.5)
    used.fmu.reset()
    assert used.saved() == blank
    used.ready()
    fresh.ready()
    used.run(1.0, 0.1)
    fresh.run(1.0, 0.1)
    assert used.saved() == fresh.saved()


def test_a_failed_instance_can_be_reset_and_used_again(new):
    made = new(ROOT).ready()
    with pytest.raises(FMICallException):
        made.step(2.0)
    made.fmu.reset()
    made.ready()
    made.step(0.75)
    assert made.get("y") == pytest.approx(0.5, abs=1e-6)


def test_a_state_of_another_model_is_refused(new):
    made = new(BALL).ready()
    with pytest.raises(FMICallException):
        made.load(new(RELAY).ready().saved())
    assert "the bytes are not a saved state of this component" in made.messages[-1]


def test_two_instances_do_not_know_each_other(new):
    one, other = new(BALL).ready(loss=0.5), new(BALL).ready(loss=0.1)
    for k in range(12):
        one.fmu.doStep(k * 0.1, 0.1)
        other.fmu.doStep(k * 0.1, 0.1)
    assert (one.get("bounces"), other.get("bounces")) == (3, 1)
    assert one.get("h") != other.get("h")


@pytest.mark.parametrize("tolerance", [-1e-6, 2.0, float("nan")])
def test_a_tolerance_that_is_none_is_refused(new, tolerance):
    made = new(OSCILLATOR)
    with pytest.raises(FMICallException):
        made.enter(tolerance=tolerance)
    assert "is not between 0 and 1" in made.messages[-1]


def test_functions_of_model_exchange_are_refused_to_a_co_simulation(new, version):
    made = new(OSCILLATOR).ready()
    name = "fmi2EnterEventMode" if version == 2 else "fmi3EnterEventMode"
    function = getattr(made.fmu.dll, name)
    function.argtypes, function.restype = [ctypes.c_void_p], ctypes.c_int
    assert function(made.fmu.component) == 3
    assert "the instance is for co-simulation" in made.messages[-1]


def test_a_step_is_refused_to_model_exchange(new, version):
    made = new(OSCILLATOR, is_exchange=True).ready()
    function = made.fmu.dll[f"fmi{version}DoStep"]
    function.restype = ctypes.c_int
    real, pointer = ctypes.c_double, ctypes.byref(ctypes.c_double())
    rest = [ctypes.c_int(1)] if version == 2 else [ctypes.c_bool(True), pointer, pointer, pointer, pointer]
    assert function(ctypes.c_void_p(made.fmu.component), real(0.0), real(0.1), *rest) == 3
    assert "the instance is for model exchange" in made.messages[-1]


def test_a_check_that_fails_at_the_end_of_the_initialization_fails_it(new):
    made = new(CHECKED).enter()
    made.set("top", -1.0)
    with pytest.raises(FMICallException):
        made.fmu.exitInitializationMode()
    assert "error: at 0 s: x must stay below top" in made.messages


@pytest.mark.parametrize("version", [3])
def test_every_function_of_fmi_3_is_exported(new):
    from fmpy.fmi3 import _FMU3

    made = new(OSCILLATOR)
    names = [name for name in vars(_FMU3) if name.startswith("fmi3")]
    assert len(names) > 60
    assert [name for name in names if not hasattr(made.fmu.dll, name)] == []


@pytest.mark.parametrize("version", [3])
def test_time_is_a_variable_in_fmi_3(new):
    made = new(OSCILLATOR).ready(start_time=2.0)
    made.step(0.5)
    assert made.fmu.getFloat64([len(OSCILLATOR.values)]) == [2.5]
