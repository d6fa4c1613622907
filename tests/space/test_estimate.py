"""Estimated counts and shares against the truth."""

from __future__ import annotations

from math import comb

import numpy as np
import pytest

from dse.space.flat import FlatSpace, Fold, Gather, Linear, Table, Variable, Wide
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.mdd.expand import expand
from dse.space.methods.sampling import sample as sampling
from dse.space.methods.sampling.estimate import estimate, estimate_occurrences
from dse.space.methods.sampling.tilt import EmptyError, TooRareError
from dse.space.methods.tally import Tally


def coins(number, *rules):
    """A space of *number* yes-or-no decisions."""
    return FlatSpace("coins", tuple(Variable(f"c{i}", ("no", "yes")) for i in range(number)), (), rules)


def heads(number, low, high):
    return Linear({i: np.array([0, 1, 0], np.int64) for i in range(number)}, low, high)


def between(number, low, high):
    return sum(comb(number, k) for k in range(low, high + 1))


class AtMost:
    """A judge that knows only exact answers: vague about everything."""

    def __init__(self, most):
        self.most = most

    def bounds(self, low, high):
        return np.ones_like(low[0], np.bool_), np.ones_like(low[0], np.bool_)

    def holds(self, folds):
        return folds[0] <= self.most


def heads_judged(number, most):
    return Wide((Fold(Gather.SUM, heads(number, None, None).weights, 0),), AtMost(most))


CASES = {
    "a tail": (coins(60, heads(60, None, 20)), between(60, 0, 20)),
    "a far tail": (coins(60, heads(60, 55, None)), between(60, 55, 60)),
    "a band": (coins(60, heads(60, 28, 31)), between(60, 28, 31)),
    "a band far out": (coins(60, heads(60, 5, 7)), between(60, 5, 7)),
    "a single value": (coins(60, heads(60, 12, 12)), comb(60, 12)),
    "two sums that say the same": (coins(60, heads(60, None, 20), heads(60, None, 21)), between(60, 0, 20)),
    "no sum but a judge": (coins(12, heads_judged(12, 5)), between(12, 0, 5)),
    "a sum and a judge": (coins(12, heads(12, 3, None), heads_judged(12, 5)), between(12, 3, 5)),
}


@pytest.fixture
def small_batches(monkeypatch):
    """Batches that are soon drawn; their means scatter more, which is the harder test of an interval."""
    monkeypatch.setattr("dse.space.methods.sampling.estimate._BATCH", 200)


@pytest.mark.thorough
@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", CASES)
def test_intervals_hold_the_truth_about_nineteen_times_of_twenty(name, small_batches):
    flat, truth = CASES[name]
    diagram = compile_diagram(flat)
    seeds = 20
    tallies = [estimate(diagram, seed, relative=0.05) for seed in range(seeds)]
    assert not any(tally.exact for tally in tallies)
    assert all(tally.low <= tally.value <= tally.high for tally in tallies)
    # Fewer than 16 of 20 happens to an honest interval in 1 of 400 cases; the seeds are fixed.
    assert sum(tally.low <= truth <= tally.high for tally in tallies) >= 16
    assert all(abs(tally.value - truth) < 0.15 * truth for tally in tallies)


@pytest.mark.sampled(8)
@pytest.mark.parametrize("name", CASES)
def test_the_interval_is_about_as_wide_as_asked(name, small_batches):
    diagram = compile_diagram(CASES[name][0])
    tallies = [estimate(diagram, seed, relative=0.04) for seed in range(5)]
    # A single pilot can be lucky and ask for half the batches; the median of five is not.
    widths = sorted((tally.high - tally.low) / 2 / tally.value for tally in tallies)
    assert widths[2] < 0.052


@pytest.mark.thorough
def test_estimates_are_unbiased(small_batches):
    flat, truth = CASES["a tail"]
    values = [estimate(compile_diagram(flat), seed, relative=0.02).value for seed in range(40)]
    # 40 estimates of at most 1 % standard deviation: 0.16 % for their mean.
    assert abs(sum(values) / 40 / truth - 1) < 0.005


def test_the_same_seed_gives_the_same_estimate(small_batches):
    diagram = compile_diagram(CASES["a band"][0])
    assert estimate(diagram, 4, 0.05) == estimate(diagram, 4, 0.05)
    assert estimate(diagram, 4, 0.05) != estimate(diagram, 5, 0.05)


@pytest.mark.thorough
def test_counts_beyond_every_float_are_whole_numbers(small_batches):
    number = 2000
    tally = estimate(compile_diagram(coins(number, heads(number, None, 900))), 1)
    truth = between(number, 0, 900)
    assert truth > 10**500
    assert isinstance(tally.value, int)
    assert tally.low * 99 <= truth * 100 <= tally.high * 101


def test_sums_larger_than_32_bits_are_compared_in_full(small_batches):
    large = {i: own * (1 << 40) for i, own in heads(60, None, None).weights.items()}
    tally = estimate(compile_diagram(coins(60, Linear(large, None, 20 << 40))), 1, relative=0.01)
    truth = between(60, 0, 20)
    assert abs(tally.value - truth) < 0.03 * truth


def test_sums_too_various_to_be_merged_are_estimated_alike(small_batches):
    rng = np.random.default_rng(1)
    parts = {i: np.array([0, int(rng.integers(1 << 40, 1 << 41)), 0]) for i in range(16)}
    total = sum(int(own[1]) for own in parts.values())
    more = {i: np.array([0, int(rng.integers(1 << 40, 1 << 41)), 0]) for i in range(16)}
    rules = (Linear(parts, None, total // 2), Linear(more, None, sum(int(own[1]) for own in more.values()) // 2))
    rows = (np.arange(1 << 16)[:, None] >> np.arange(16)[None, :]) & 1
    truth = np.ones(1 << 16, np.bool_)
    for rule in rules:
        truth &= rows @ np.array([int(own[1]) for own in rule.weights.values()]) <= rule.high
    tally = estimate(compile_diagram(coins(16, *rules)), 1, relative=0.01)
    assert abs(tally.value - int(truth.sum())) < 0.02 * int(truth.sum())


def test_without_sums_the_count_is_exact():
    assert estimate(compile_diagram(coins(7)), 1) == Tally(128)
    assert estimate(compile_diagram(coins(0)), 1) == Tally(1)


def test_sums_that_no_row_breaks_leave_the_count_exact():
    assert estimate(compile_diagram(coins(7, heads(7, 0, 7))), 1) == Tally(128)


def test_layers_that_hold_the_sums_make_the_count_exact():
    assert estimate(expand(compile_diagram(coins(9, heads(9, 2, 3)))), 1) == Tally(between(9, 2, 3))


def test_what_is_proven_empty_counts_nothing_exactly():
    assert estimate(compile_diagram(coins(7, heads(7, 8, None))), 1) == Tally(0)
    assert estimate(compile_diagram(coins(7, Table((), np.array(False)))), 1) == Tally(0)
    assert estimate(compile_diagram(coins(40, heads(40, None, 15), heads(40, 18, None))), 1) == Tally(0)


def test_one_valid_row_is_counted_as_one(small_batches):
    tally = estimate(compile_diagram(coins(30, heads(30, 30, None))), 1)
    assert tally.low == tally.value == 1


def test_what_is_never_hit_is_not_called_nothing(small_batches):
    odd = Linear({i: np.array([0, 2, 0], np.int64) for i in range(20)}, 7, 7)
    with pytest.raises(TooRareError):
        estimate(compile_diagram(coins(20, odd)), 1, most_draws=50_000)


def test_occurrences_of_symmetric_decisions_are_alike():
    diagram = compile_diagram(coins(12, heads(12, None, 3)))
    truth = sum(comb(11, k - 1) for k in range(1, 4)) / between(12, 0, 3)
    shares = estimate_occurrences(diagram, 1, 4000)
    assert len(shares.shares) == 12
    for share, half_width in zip(shares.shares, shares.half_widths, strict=True):
        assert share.sum() == pytest.approx(1)
        assert abs(share[1] - truth) < 1.8 * half_width[1]
        assert half_width[1] < 0.02


def test_a_value_that_was_never_seen_still_has_an_interval():
    rare = coins(30, heads(30, None, 29), Table((0,), np.array([True, False, False])))
    shares = estimate_occurrences(compile_diagram(rare), 1, 1000)
    assert shares.shares[0].tolist() == [1.0, 0.0, 0.0]
    assert 0.003 < shares.half_widths[0][1] < 0.005


def test_occurrences_are_exact_without_sums():
    shares = estimate_occurrences(compile_diagram(coins(3)), 1, 10)
    assert shares.shares[2].tolist() == [0.5, 0.5, 0.0]
    assert shares.half_widths[2].tolist() == [0.0, 0.0, 0.0]


def test_nothing_occurs_in_an_empty_space():
    with pytest.raises(EmptyError):
        estimate_occurrences(compile_diagram(coins(3, Table((), np.array(False)))), 1, 10)


def test_an_estimate_lies_in_its_interval_even_where_nearly_everything_is_valid():
    for seed in range(8):
        found = estimate(compile_diagram(coins(24, heads(24, 1, None))), seed, size=64)
        assert 1 <= found.low <= found.value <= found.high <= 2**24


def test_a_deep_diagram_is_given_fewer_draws(monkeypatch):
    monkeypatch.setattr(sampling, "MOST_DRAWN_CELLS", 5_000)
    monkeypatch.setattr(sampling, "_WORDS", 1_000)
    diagram = compile_diagram(coins(100, heads(100, 50, 50)))
    drawn = []
    walk = sampling.walk

    def counted(walks, random, number):
        drawn.append(number)
        return walk(walks, random, number)

    monkeypatch.setattr(sampling, "walk", counted)
    with pytest.raises(TooRareError):
        sampling.sample(diagram, 100, 1, most_draws=0)
    assert drawn == []
    assert len(sampling.sample(diagram, 3, 1)) == 3
    assert set(drawn) == {9}
    assert sum(drawn) < 70
