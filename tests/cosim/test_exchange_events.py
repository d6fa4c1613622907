"""Events of model exchange: where they are found, what they change, and several at a time."""

from __future__ import annotations

import numpy as np
import pytest
from cosim.exchange_models import model, simulated
from hypothesis import HealthCheck, given, settings, strategies as st

BOTH = pytest.mark.parametrize("version", [2, 3])


@pytest.fixture(scope="session")
def folder(shelf):
    return shelf.folder


@BOTH
def test_states_that_an_event_sets_are_taken_over(folder, version):
    time, found = simulated(
        model("sawtooth", version, folder), ["x", "resets"], stop=10.0, step=0.1, start={"rate": 0.77}
    )
    # x is linear between resets, which any solver follows but for rounding: 1e-12 of what has passed.
    assert np.abs(found["x"] - 0.77 * time % 1.0).max() < 1e-11
    assert found["resets"].tolist() == np.floor(0.77 * time).tolist()


@settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(rate=st.floats(0.05, 40.0), step=st.sampled_from([0.01, 0.1, 0.37, 1.0]), version=st.sampled_from([2, 3]))
def test_no_reset_is_missed_however_long_the_step(folder, rate, step, version):
    time, found = simulated(
        model("sawtooth", version, folder), ["x", "resets"], stop=10 * step, step=step, start={"rate": rate}
    )
    total = rate * time
    # Where a reset falls on a communication point within rounding it may be before or after it.
    assert np.abs(found["resets"] + found["x"] - total).max() < 1e-9 * (1.0 + total[-1])
    assert ((found["x"] > -1e-9) & (found["x"] < 1.0 + 1e-9)).all()


@BOTH
def test_an_event_just_where_the_equations_end_is_met(folder, version):
    fmu = model("tank", version, folder, tolerance=1e-8)
    time, found = simulated(fmu, ["h", "empty"], stop=3.0, step=0.1)
    # Torricelli: sqrt(h) falls by k/2 a second. Errors grow as 1/sqrt(h) towards the end, where h is tiny itself.
    assert np.abs(found["h"] - np.maximum(0.0, 1.0 - 0.5 * time) ** 2).max() < 1e-7
    assert found["empty"].tolist() == [float(t > 2.05) for t in time] or found["empty"][21:].all()
    assert not found["empty"][:20].any()


@BOTH
def test_time_events_and_state_events_at_one_time_are_all_handled(folder, version):
    record = ["x", "ticks", "other_ticks", "state_events", "events", "last"]
    time, found = simulated(model("clocks", version, folder), record, stop=2.0, step=0.1)
    # Both clocks and the state event meet at 0.5 s, which is a communication point, too.
    assert found["ticks"].tolist() == list(range(21))
    assert found["other_ticks"].tolist() == [float(int((t + 1e-9) / 0.25)) for t in time]
    assert found["state_events"].tolist() == [float(t > 0.45) for t in time]
    # x' counts the ticks: the sum of 0 … k-1, a tenth of a second each.
    assert np.abs(found["x"] - [0.1 * k * (k - 1) / 2 for k in range(21)]).max() < 1e-11
    # One iteration at the beginning, 20 ticks and 4 that no tick of the first clock meets: 0.25, 0.75, 1.25, 1.75 s.
    assert found["events"][-1] == 25


@BOTH
def test_a_clock_is_never_told_another_time_than_the_one_it_asked_for(folder, version):
    start = {"period": 0.1, "other_period": 1e9, "event": 1e9}
    _, found = simulated(model("clocks", version, folder), ["last", "ticks"], stop=100.0, step=0.1, start=start)
    # (k + 1) * 0.1 as the FMU computes it; the end of a step is k * 0.1 + 0.1, which may be another number.
    assert found["last"][1:].tolist() == [k * 0.1 for k in range(1, 1001)]
    assert found["ticks"][-1] == 1000


@BOTH
def test_many_events_in_one_step_are_all_found(folder, version):
    start = {"period": 0.001, "other_period": 0.0015, "event": 0.5}
    _, found = simulated(model("clocks", version, folder), ["ticks", "other_ticks"], stop=1.0, step=1.0, start=start)
    assert found["ticks"][-1] == 1000
    assert found["other_ticks"][-1] == 666


@BOTH
def test_an_indicator_that_dips_below_zero_within_a_step_is_seen(folder, version):
    for half in (1e-1, 1e-2, 1e-3):
        start = {"middle": 0.537, "half": half}
        _, found = simulated(model("graze", version, folder), ["crossings"], stop=1.0, step=0.1, start=start)
        assert found["crossings"][-1] == 2


@BOTH
def test_an_event_that_a_completed_step_asks_for_is_had(folder, version):
    _, found = simulated(model("stepper", version, folder), ["x", "still"], stop=1.0, step=0.1, start={"limit": 0.35})
    # The step that passes 0.35 ends at a communication point at the latest.
    assert found["still"][-1] == 1
    assert 0.35 <= found["x"][-1] <= 0.4 + 1e-12


@BOTH
def test_a_relay_with_hysteresis_swings_between_its_limits(folder, version):
    band = 0.0111
    _, found = simulated(model("relay", version, folder), ["x", "switches"], stop=2.0, step=0.1, start={"band": band})
    # From 0.5 down to -band, then to and fro over 2 * band, with speed 1.
    assert found["switches"][-1] == 1 + int((2.0 - (0.5 + band)) / (2.0 * band))
    assert np.abs(found["x"][6:]).max() <= band + 1e-12
