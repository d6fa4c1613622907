"""Events of the Modelica runtime: found, located, in order, and refused by name where they have no end."""

from __future__ import annotations

import math
from ctypes import byref, c_double, c_int
from dataclasses import replace

import pytest
from fmpy.fmi1 import FMICallException
from fmu.modelica_models.drive import instances
from fmu.modelica_models.models import (
    BALL,
    CHATTER,
    CHECKED,
    ENDLESS,
    GRAZE,
    PULSE,
    RELAY,
    SAMPLED,
    SCHMITT,
    TANK,
)


@pytest.fixture
def version():
    return 2  # the events know nothing of an FMI version; the exchange tests see both


@pytest.fixture
def new(cache, version):
    with instances(cache, version) as make:
        yield make


def _bounce_times(loss, count):
    first = math.sqrt(2.0 / 9.81)
    times = [first]
    for k in range(1, count):
        times.append(times[-1] + 2.0 * first * (1.0 - loss) ** k)
    return times


@pytest.mark.parametrize("step", [0.5, 0.013])
@pytest.mark.parametrize("solver", ["AUTO", "STIFF"])
def test_a_ball_bounces_when_it_touches_the_ground(new, step, solver):
    ball = new(replace(BALL, name=f"ball_{solver.lower()}", solver=solver)).ready(tolerance=1e-10)
    times, seen = _bounce_times(0.3, 8), 0
    while ball.time + step < times[-1]:
        ball.step(step)
        count = ball.get("bounces")
        if count > seen:
            # 9 digits: the speeds that decide are right to the tolerance
            assert ball.get("last") == pytest.approx(times[count - 1], abs=1e-9)
            seen = count
    assert seen == sum(time < ball.time for time in times)


def test_a_ball_that_comes_to_rest_is_told_to_chatter(new):
    ball = new(BALL).ready(loss=0.5)
    rest = _bounce_times(0.5, 100)[-1]  # 1.35457...
    ball.step(rest - 1e-3)
    with pytest.raises(FMICallException):
        ball.step(0.1)
    assert "chatters, 16 events with next to no time between them: V(h) <= 0.0" in ball.messages[-1]
    assert f"at {rest:.8f}"[:-3] in ball.messages[-1]


@pytest.mark.parametrize("step", [0.5, 0.1, 0.011])
@pytest.mark.parametrize("solver", ["AUTO", "STIFF"])
def test_a_relay_switches_at_its_two_levels(new, step, solver):
    relay = new(replace(RELAY, name=f"relay_{solver.lower()}", solver=solver)).ready(tolerance=1e-9)
    cooling = math.log(11.0 / 9.0)  # from 21 to 19 towards 10, and from 19 to 21 towards 30, alike
    first = math.log(10.0 / 9.0)
    for k in range(round(3.0 / step)):
        relay.fmu.doStep(k * step, step)
        time = (k + 1) * step
        assert relay.get("switches") == (0 if time < first else 1 + math.floor((time - first) / cooling))
        assert relay.get("on") == (relay.get("switches") % 2 == 1)
        assert relay.get("x") == pytest.approx(_temperature(time, first, cooling), abs=1e-7)


def _temperature(time, first, cooling):
    if time < first:
        return 10.0 + 10.0 * math.exp(-time)
    phase = (time - first) % (2.0 * cooling)
    if phase < cooling:
        return 30.0 - 11.0 * math.exp(-phase)
    return 10.0 + 11.0 * math.exp(cooling - phase)


@pytest.mark.parametrize("solver", ["AUTO", "STIFF"])
@pytest.mark.parametrize("step", [0.5, 5.0, 0.07])
def test_a_level_passed_for_a_short_while_is_not_missed(new, step, solver):
    graze = new(replace(GRAZE, name=f"graze_{solver.lower()}", solver=solver)).ready(tolerance=1e-6)
    for k in range(round(70.0 / step)):
        graze.fmu.doStep(k * step, step)
    assert graze.get("passed") == math.floor((70.0 - math.pi / 2) / (2 * math.pi)) + 1


@pytest.mark.parametrize("width", [0.01, 1e-5])
def test_a_pulse_between_two_communication_points_has_its_area(new, width):
    pulse = new(PULSE).ready(to=0.2 + width)
    pulse.step(1.0)
    assert pulse.get("count") == 1
    assert pulse.get("x") == pytest.approx(width, abs=1e-12)


def test_ticks_are_exact_after_a_hundred_thousand(new):
    sampled = new(SAMPLED).ready()
    for k in range(10):
        sampled.fmu.doStep(k * 100.0, 100.0)
        # The tick at the end belongs to the next step.
        assert sampled.get("ticks") == (k + 1) * 10_000
        assert sampled.get("at") == ((k + 1) * 10_000 - 1) / 100
    sampled.fmu.doStep(1000.0, 0.001)
    assert sampled.get("ticks") == 100_001
    assert sampled.get("at") == 1000.0


@pytest.mark.parametrize("step", [0.01, 0.03, 0.0123])
def test_ticks_are_neither_lost_nor_doubled_by_an_importer_that_sums_up_its_steps(new, step):
    sampled = new(SAMPLED).ready()
    time = 0.0
    for k in range(3000):
        sampled.fmu.doStep(time, step)
        time += step
        exact = (k + 1) * round(step * 10_000) / 100  # in hundredths of a second
        assert sampled.get("ticks") == math.ceil(exact - 1e-6)


def test_ticks_before_the_start_do_not_count(new):
    sampled = new(SAMPLED).ready(start_time=12.345)
    sampled.step(0.01)
    assert (sampled.get("ticks"), sampled.get("at")) == (1, 12.35)


def test_a_tick_at_the_communication_point_sees_the_input_of_the_step_it_begins(new):
    sampled = new(SAMPLED).ready(demand=1.0)
    assert sampled.get("held_input") == 1.0
    for k in range(20):
        sampled.set("demand", 10.0 + k)
        sampled.fmu.doStep(k * 0.01, 0.01)
        # at 0 the tick was part of the initialization
        assert sampled.get("held_input") == (1.0 if k == 0 else 10.0 + k)


def test_a_sampled_controller_follows_its_closed_form(new):
    sampled = new(SAMPLED).ready(tolerance=1e-10)
    x, decay = 0.0, math.exp(-0.01)
    for _ in range(100):
        u = 4.0 * (1.0 - x)
        x = u + (x - u) * decay
    sampled.run(1.0, 0.25)
    assert sampled.get("x") == pytest.approx(x, abs=1e-8)


@pytest.mark.sampled(4)
@pytest.mark.parametrize("step", [0.01, 0.5])
@pytest.mark.parametrize("solver", ["AUTO", "STIFF"])
def test_a_model_that_has_no_values_beyond_an_event_comes_to_it_nevertheless(new, solver, step):
    tank = new(replace(TANK, name=f"tank_{solver.lower()}", solver=solver)).ready(tolerance=1e-8)
    empty = 2.0 * (1.0 - 0.1 * math.log(1.1 / 0.1))
    tank.run(1.5, step)
    assert tank.time < empty
    assert tank.get("h") == pytest.approx(_level(empty - 1.5), abs=1e-7)
    tank.run(3.0, step)
    assert tank.get("h") == pytest.approx(0.0, abs=1e-9)
    assert tank.get("slope") == 0.0


def _level(rest):
    # rest = 2 * (r - 0.1 * log(1 + 10 * r)) for the root r of the level
    low, high = 0.0, 1.0
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if 2.0 * (middle - 0.1 * math.log1p(10.0 * middle)) < rest else (low, middle)
    return low * low


def test_a_relation_that_looks_at_the_value_before_has_its_hysteresis(new):
    schmitt = new(SCHMITT).ready()
    for k in range(300):
        schmitt.fmu.doStep(k * 0.1, 0.1)
        turns = (k + 1) * 0.1 / math.pi  # below -0.1 from (1 + d), above 0.1 from (2 + d) half turns on
        late = math.asin(0.1) / math.pi
        assert schmitt.get("changes") == max(0, math.floor(turns - late))
        assert schmitt.get("b") == (schmitt.get("changes") % 2 == 0)


def test_a_relation_that_switches_back_at_once_is_told_to_chatter(new):
    chatter = new(CHATTER).ready()
    chatter.step(0.9)
    with pytest.raises(FMICallException):
        chatter.step(0.5)
    assert "DoStep: at 1" in chatter.messages[-1]
    assert "next to no time between them: V(x) > 0.0" in chatter.messages[-1]


def test_an_event_iteration_without_an_end_is_refused(new):
    endless = new(ENDLESS).ready()
    with pytest.raises(FMICallException):
        endless.step(1.0)
    assert "the event iteration finds no end in 100 passes" in endless.messages[-1]
    assert "at 0.5 s" in endless.messages[-1]


def test_an_assert_fails_the_step_with_its_own_text(new):
    checked = new(CHECKED).ready()
    checked.step(0.2)
    with pytest.raises(FMICallException):
        checked.step(0.2)
    assert any("x must stay below top" in text for text in checked.messages)
    assert "an assert of the model is violated" in checked.messages[-1]


def test_an_assert_that_fails_at_the_start_fails_the_initialization(new):
    checked = new(CHECKED)
    with pytest.raises(FMICallException):
        checked.ready(top=-1.0)
    assert "error: at 0 s: x must stay below top" in checked.messages


def test_a_warning_is_told_once_and_the_simulation_goes_on(new):
    checked = new(CHECKED).ready(warn=0.05, top=9.0)
    checked.run(0.2, 0.01)
    assert [text.split(" s: ")[1] for text in checked.messages] == ["x is getting large"]
    assert checked.messages[0].startswith("warning: at 0.0")
    assert checked.get("x") == pytest.approx(0.2)


def test_a_terminate_ends_the_step_where_it_happens_and_is_told_as_the_end(new):
    checked = new(CHECKED).ready(end=0.15, top=9.0)
    checked.step(0.1)
    with pytest.raises(FMICallException, match="discard"):
        checked.step(0.1)
    ended, last = c_int(0), c_double(0.0)
    assert checked.fmu.fmi2GetBooleanStatus(checked.fmu.component, 3, byref(ended)) == 0
    assert ended.value == 1
    assert checked.fmu.fmi2GetRealStatus(checked.fmu.component, 2, byref(last)) == 0
    assert 0.15 <= last.value <= 0.2
