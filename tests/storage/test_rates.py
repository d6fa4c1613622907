"""Intervals of rates: against scipy, and how often they cover a rate that is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import binomtest

from dse.domain.rates import rate_interval, settled

RATES = (0.001, 0.02, 0.1, 0.5)


@pytest.mark.parametrize(("met", "draws"), [(0, 5), (5, 5), (8, 10), (1, 300), (299, 300)])
def test_the_interval_of_a_chosen_number_of_draws_is_that_of_clopper_and_pearson(met: int, draws: int) -> None:
    expected = binomtest(met, draws).proportion_ci(0.9, "exact")
    low, high = rate_interval(np.array([met]), np.array([draws]), 0.9)
    assert (low[0], high[0]) == pytest.approx((expected.low, expected.high), abs=1e-9)


def test_without_a_draw_nothing_is_known_of_the_rate() -> None:
    for sequential in (False, True):
        low, high = rate_interval(np.array([0]), np.array([0]), sequential=sequential)
        assert (low[0], high[0]) == (0.0, 1.0)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("rate", RATES)
def test_a_sequential_interval_covers_the_rate_whenever_it_is_looked_at(rate: float) -> None:
    # Of a coverage of 95 %, 94 % of 1,500 repetitions are 1.8 standard errors less.
    draws = np.random.default_rng(7).random((1500, 100)) < rate
    met, count = np.cumsum(draws, axis=1), np.broadcast_to(np.arange(1, 101), draws.shape)
    low, high = rate_interval(met.ravel(), count.ravel(), sequential=True)
    covers = ((low <= rate) & (rate <= high)).reshape(draws.shape)
    assert covers.all(axis=1).mean() >= 0.94


@pytest.mark.parametrize("rate", RATES)
def test_an_interval_covers_the_rate_after_a_chosen_number_of_draws(rate: float) -> None:
    met = np.random.default_rng(8).binomial(20, rate, 300)
    low, high = rate_interval(met, np.full(300, 20))
    assert ((low <= rate) & (rate <= high)).mean() >= 0.94


def test_an_interval_of_a_chosen_number_of_draws_is_too_narrow_if_it_is_looked_at_after_each() -> None:
    draws = np.random.default_rng(7).random((300, 400)) < 0.1
    met, count = np.cumsum(draws, axis=1), np.broadcast_to(np.arange(1, 401), draws.shape)
    low, high = rate_interval(met.ravel(), count.ravel())
    assert ((low <= 0.1) & (high >= 0.1)).reshape(draws.shape).all(axis=1).mean() < 0.85


def test_a_rate_of_95_percent_is_certain_after_as_many_draws_as_the_docs_say() -> None:
    counts = np.arange(1, 200)
    first = [int(counts[settled(counts, counts, 0.95, sequential=s)][0]) for s in (False, True)]
    assert first == [72, 79]
    assert settled(np.array([2]), np.array([5]), 0.95, sequential=True)[0]  # 3 of 5 missed it
