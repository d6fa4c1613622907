"""Numbers from waveforms against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dse.metrics import functions as f
from dse.metrics.catalogue import FUNCTIONS
from dse.metrics.machine import TIME as TIME_REGISTER

STEP = 1e-3
TIME = np.arange(0, 20 + STEP / 2, STEP)


def value(name, *arguments, time=TIME):
    """What the metric function *name* gives, its instructions carried out at once."""

    def carried_out(function, *registers):
        return function(*[time if register is TIME_REGISTER else register for register in registers])

    return FUNCTIONS[name].emit(carried_out, *arguments)


def first_order(tau):
    return 1 - np.exp(-TIME / tau)


def second_order(zeta, omega=2.0):
    damped = omega * math.sqrt(1 - zeta**2)
    return 1 - np.exp(-zeta * omega * TIME) * (
        np.cos(damped * TIME) + zeta / math.sqrt(1 - zeta**2) * np.sin(damped * TIME)
    )


@pytest.mark.parametrize("zeta", [0.1, 0.3, 0.5, 0.7])
def test_overshoot_of_a_second_order_step_response(zeta):
    # The peak lies at most half a step from a row; there the curve falls by |x''| h²/8 ≤ ω² h²/8.
    exact = math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2))
    assert value("overshoot", second_order(zeta), 1.0) == pytest.approx(exact, abs=2.0**2 * STEP**2 / 8)


@pytest.mark.parametrize("tau", [0.5, 1.0, 3.0])
def test_rise_time_of_a_first_order_step_response(tau):
    # Linear interpolation is off by |x''| h²/8 in x, that is h²/(8 τ) in time, at either end.
    assert f.rise_time(TIME, first_order(tau), 1.0) == pytest.approx(tau * math.log(9), abs=STEP**2 / (4 * tau))


@pytest.mark.parametrize("band", [0.02, 0.05])
def test_settling_and_reach_time_of_a_first_order_step_response(band):
    exact = math.log(1 / band)
    assert f.settling_time(TIME, first_order(1.0), 1.0, band) == pytest.approx(exact, abs=STEP**2 / 8)
    assert f.reach_time(TIME, first_order(1.0), 1.0, band) == pytest.approx(exact, abs=STEP**2 / 8)


def test_a_swinging_response_is_reached_long_before_it_settles():
    x = second_order(0.1)
    envelope = math.log(1 / 0.02) / (0.1 * 2.0)
    reached, settled = f.reach_time(TIME, x, 1.0), f.settling_time(TIME, x, 1.0)
    assert reached < 1.0
    assert envelope - math.pi / 2 < settled < envelope + 0.1


def test_times_count_from_the_first_row():
    x = first_order(1.0)
    for function in (f.rise_time, f.settling_time, f.reach_time):
        assert function(TIME + 100, x, 1.0) == pytest.approx(function(TIME, x, 1.0), abs=1e-9)


def test_a_falling_waveform_has_the_same_times_as_a_rising_one():
    x = first_order(1.0)
    assert f.rise_time(TIME, 5 - x, 4.0) == pytest.approx(math.log(9), abs=STEP**2)
    assert f.settling_time(TIME, 5 - x, 4.0, 0.01) == pytest.approx(math.log(1 / 0.04), abs=STEP**2)
    assert f.reach_time(TIME, 5 - x, 4.0, 0.01) == pytest.approx(math.log(1 / 0.04), abs=STEP**2)


def test_overshoot_and_undershoot_are_signed_and_relative_to_the_size_of_the_target():
    x = np.array([0.0, 8.0])
    assert value("overshoot", x, 10.0) == pytest.approx(-0.2)
    assert value("overshoot", x, 5.0) == pytest.approx(0.6)
    assert value("undershoot", x, 5.0) == pytest.approx(1.0)
    assert value("undershoot", x + 6, 5.0) == pytest.approx(-0.2)
    assert value("overshoot", -x, -5.0) == pytest.approx(1.0)
    assert value("undershoot", -x, -5.0) == pytest.approx(0.6)


def test_a_jump_over_the_band_between_two_rows_counts_as_reaching_it():
    time, x = np.array([0.0, 1.0, 2.0]), np.array([0.0, 2.0, 2.0])
    assert f.reach_time(time, x, 1.0, 0.1) == pytest.approx(0.45)
    assert math.isnan(f.settling_time(time, x, 1.0, 0.1))


def test_what_is_in_the_band_from_the_start_settles_at_once():
    time, x = np.array([0.0, 1.0]), np.array([1.0, 1.01])
    assert f.settling_time(time, x, 1.0) == f.reach_time(time, x, 1.0) == 0.0


NOT_DEFINED = {
    "a target of zero has no relative overshoot": lambda t, x: value("overshoot", x, 0.0),
    "a target of zero has no relative undershoot": lambda t, x: value("undershoot", x, 0.0),
    "a response that stays below 90 % has no rise time": lambda t, x: f.rise_time(t, 0.5 * x, 1.0),
    "a response that starts at its target has no rise time": lambda t, x: f.rise_time(t, x, x.item(0)),
    "a response that never comes near is never reached": lambda t, x: f.reach_time(t, x, 3.0),
    "a response outside the band at the end has not settled": lambda t, x: f.settling_time(t, x, 0.5),
    "a waveform with NaN at the end has not settled": lambda t, x: f.settling_time(t, np.append(x[:-1], np.nan), 1.0),
    "a waveform with NaN has no maximum": lambda t, x: value("overshoot", np.append(x[:-1], np.nan), 1.0),
    "a window longer than the run has no mean": lambda t, x: f.steady_state_error(t, x, 1.0, 20.1),
    "a negative window has no mean": lambda t, x: f.steady_state_error(t, x, 1.0, -1.0),
    "a negative band holds nothing": lambda t, x: f.settling_time(t, x, 1.0, -0.1),
    "a single row has no mean": lambda t, x: value("mean", x[:1], time=t[:1]),
    "a single row has no rms": lambda t, x: value("rms", x[:1], time=t[:1]),
    "a NaN at the start has no rise time": lambda t, x: f.rise_time(t, np.append(np.nan, x[1:]), 1.0),
}


@pytest.mark.parametrize("case", NOT_DEFINED.values(), ids=NOT_DEFINED)
def test_what_is_not_defined_is_nan(case):
    assert math.isnan(case(TIME, first_order(1.0)))


def test_steady_state_error_is_the_mean_over_the_rows_of_the_window():
    time = np.arange(11) * 0.1
    x = np.arange(11.0)
    assert f.steady_state_error(time, x, 2.0, 0.2) == pytest.approx(9.0 - 2.0)
    assert f.steady_state_error(time, x, 2.0, 1.0) == pytest.approx(5.0 - 2.0)
    assert f.steady_state_error(time, x, 2.0, 0.0) == pytest.approx(10.0 - 2.0)


def test_averages_are_over_time_not_over_rows():
    time, x = np.array([0.0, 1.0, 4.0]), np.array([0.0, 2.0, 2.0])
    assert value("integral", x, time=time) == pytest.approx(7.0)
    assert value("mean", x, time=time) == pytest.approx(7.0 / 4)
    assert value("rms", x, time=time) == pytest.approx(math.sqrt((2 + 12) / 4))


def test_rms_of_a_sine_over_full_periods():
    time = np.linspace(0, 2 * math.pi, 1001)
    assert value("rms", 3 * np.sin(time), time=time) == pytest.approx(3 / math.sqrt(2), rel=1e-12)


def test_ends_and_extremes():
    x = np.array([2.0, -1.0, 5.0, 3.0])
    assert (f.initial(x), f.final(x), f.minimum(x), f.maximum(x)) == (2.0, 3.0, -1.0, 5.0)


def test_time_to_collision_is_infinite_where_the_gap_does_not_close():
    gap, closing = np.array([10.0, 10.0, 10.0, 0.0, 0.0]), np.array([2.0, 0.0, -1.0, 1.0, 0.0])
    assert f.time_to_collision(gap, closing).tolist() == [5.0, math.inf, math.inf, 0.0, math.inf]
    assert math.isnan(f.time_to_collision(np.array([1.0]), np.array([math.nan]))[0])


def test_at_first_is_the_value_in_the_first_row_of_a_condition():
    x = np.array([4.0, 3.0, 2.0, 1.0])
    assert f.at_first(x, np.array([False, True, False, True])) == 3.0
    assert f.at_first(x, np.array([True, True, True, True])) == 4.0
    assert math.isnan(f.at_first(x, np.full(4, fill_value=False)))


def test_duration_gives_each_row_half_the_way_to_its_neighbours():
    time = np.array([0.0, 1.0, 2.0, 4.0])
    assert value("duration", np.array([True, False, True, True]), time=time) == pytest.approx(0.5 + 1.5 + 1.0)
    assert value("duration", np.full(4, fill_value=True), time=time) == pytest.approx(4.0)


def test_occurrences_are_the_times_a_condition_begins_to_hold():
    pattern = [True, True, False, False, True, False, True]
    assert value("occurrences", np.array(pattern)) == 3
    assert value("occurrences", np.array(pattern[2:])) == 2
    assert value("occurrences", np.zeros(4, dtype=bool)) == 0
    assert value("occurrences", np.ones(1, dtype=bool)) == 1


waveforms = st.lists(st.floats(-10, 10), min_size=2, max_size=30).map(np.array)


@given(waveforms, st.floats(0.1, 5), st.floats(0.001, 0.5))
def test_settling_time_is_the_end_of_the_last_excursion(x, target, band):
    time = np.arange(float(x.size))
    outside = np.flatnonzero(np.abs(x - target) > band * target)
    inside_limits = ~((x >= target - band * target) & (x <= target + band * target))
    if (np.flatnonzero(inside_limits).tolist()) != outside.tolist():
        return  # a row on the very edge, where the two ways to round differ
    settled = f.settling_time(time, x, target, band)
    if outside.size == 0:
        assert settled == 0.0
    elif outside[-1] == x.size - 1:
        assert math.isnan(settled)
    else:
        assert outside[-1] <= settled <= outside[-1] + 1


@given(waveforms, st.floats(0.1, 5))
def test_overshoot_is_positive_exactly_when_the_target_is_passed(x, target):
    assert (value("overshoot", x, target) > 0) == bool((x > target).any())
    assert (value("undershoot", x, target) > 0) == bool((x < target).any())


@given(
    st.lists(st.tuples(st.floats(0.01, 2), st.floats(-1e3, 1e3)), min_size=2, max_size=30),
    st.floats(0.05, 4),
)
def test_a_rolling_mean_is_the_integral_over_the_last_window(rows, window):
    time, x = np.cumsum([step for step, _ in rows]), np.array([level for _, level in rows])
    means = value("rolling_mean", x, window, time=time)
    whole = [row for row in range(time.size) if time[row] - time[0] >= window]
    if not whole:
        assert np.isnan(means).all()
        return
    for row in whole:
        kinks = np.concatenate(([time[row] - window], time[(time > time[row] - window) & (time <= time[row])]))
        exact = np.trapezoid(np.interp(kinks, time, x), kinks) / window
        assert means[row] == pytest.approx(exact, rel=1e-9, abs=1e-9 * 1e3 * time[-1] / window)
    assert (means[: whole[0]] == means[whole[0]]).all()


def test_the_rolling_mean_of_a_ramp_lags_by_half_the_window():
    assert value("rolling_mean", 3 * TIME, 2.0)[-1] == pytest.approx(3 * (20 - 1), rel=1e-12)


def test_a_rolling_mean_is_undefined_only_while_the_hole_is_in_its_window():
    x = np.ones_like(TIME)
    x[1500] = math.nan
    means = value("rolling_mean", x, 1.0)
    assert np.isnan(means[1500:2501]).all()
    assert (np.abs(means[2502:] - 1) < 1e-12).all()
    assert means[1499] == pytest.approx(1)


def test_a_mean_that_rolls_over_a_window_without_length_is_undefined():
    assert np.isnan(value("rolling_mean", TIME, 0.0)).all()
    assert np.isnan(value("rolling_mean", TIME, -1.0)).all()
    assert np.isnan(value("rolling_mean", TIME, math.inf)).all()


@pytest.mark.parametrize("q", [0.0, 0.05, 0.5, 0.95, 1.0])
def test_a_percentile_of_even_rows_is_that_of_numpy(q):
    # Each row stands for 1/20000 of the time, in which a sine changes by at most ω·A·h, as from row to row.
    x = np.sin(0.1 * math.pi * TIME)
    assert value("percentile", x, q) == pytest.approx(float(np.quantile(x, q)), abs=2 * STEP * 0.1 * math.pi)


@pytest.mark.parametrize("q", [0.1, 0.5, 0.9])
def test_a_percentile_does_not_depend_on_where_rows_are_dense(q):
    # x = t on [0, 20]: below 20 q for the share q of the time. Rows are up to 0.02 s apart.
    time = np.concatenate((np.linspace(0, 2, 2000, endpoint=False), np.linspace(2, 20, 901)))
    assert value("percentile", time, q, time=time) == pytest.approx(20 * q, abs=0.02)
    assert abs(float(np.quantile(time, 0.5)) - 10) > 5  # rows counted alike are not the time


@pytest.mark.parametrize("q", [-0.1, 1.1, math.nan])
def test_a_percentile_that_there_is_not_is_undefined(q):
    assert math.isnan(value("percentile", TIME, q))


A, JERK, DELAY = 0.774 * 9.81, 12.65, 0.75  # the reference driver of UN R157
SEEN = 3.0  # s: the risk begins


def stopping_distance(speed: float, delay: float) -> float:
    """By hand: the delay, the brake built up, full braking; or a standstill before it is built up."""
    built = A / JERK
    held = speed - JERK * built**2 / 2
    if held <= 0:
        return speed * (delay + 2 / 3 * math.sqrt(2 * speed / JERK))
    return speed * (delay + built) - JERK * built**3 / 6 + held**2 / (2 * A)


@pytest.mark.parametrize("speed", [1.0, 2.0, 5.0, 60 / 3.6, 130 / 3.6])
@pytest.mark.parametrize("delay", [0.75, 0.4 + 0.75])
def test_a_driver_who_brakes_for_a_standing_car_has_the_gap_less_the_stopping_distance(speed, delay):
    gap = 200.0 - speed * TIME
    left = value("driver_gap", gap, np.full_like(TIME, speed), TIME >= SEEN, delay, A, JERK)
    # Rows are 1 ms apart; the first one with a risk is at most one row late.
    assert left == pytest.approx(200.0 - speed * SEEN - stopping_distance(speed, delay), abs=speed * 2 * STEP)


def test_a_driver_behind_a_braking_car_agrees_with_a_numerical_integration_and_not_with_what_the_run_does():
    speed, other = 25.0, 8.0
    lead = 40.0 + 25.0 * TIME - np.where(TIME > SEEN, other / 2 * np.minimum(TIME - SEEN, 25.0 / other) ** 2, 0.0)
    lead -= np.where(SEEN + 25.0 / other < TIME, 25.0 * (TIME - SEEN - 25.0 / other), 0.0)
    own, place = np.zeros_like(TIME), 0.0
    now = speed
    for row, time in enumerate(TIME):
        own[row] = place
        braking = min(max(time - SEEN - 1.15, 0.0) * JERK, A)
        now, before = max(now - braking * STEP, 0.0), now
        place += (now + before) / 2 * STEP
    expected = float(np.min((lead - own)[TIME >= SEEN]))
    run = speed * np.where(TIME > SEEN, np.exp(-(TIME - SEEN)), 1.0)  # the car of the run brakes otherwise
    moved = np.concatenate([[0.0], np.cumsum((run[1:] + run[:-1]) / 2 * STEP)])
    left = value("driver_gap", lead - moved, run, TIME >= SEEN, 1.15, A, JERK)
    # An explicit step of 1 ms: its error is half a step of the deceleration's rise over the whole stop.
    assert left == pytest.approx(expected, abs=0.05)
    assert expected < 15.0


def test_a_driver_without_a_risk_has_no_gap():
    assert math.isnan(value("driver_gap", TIME, TIME, TIME < 0.0, DELAY, A, JERK))
    assert math.isnan(value("driver_gap", TIME, TIME, TIME >= 0.0, DELAY, 0.0, JERK))
