"""Spaces that no diagram and no graph of all rules hold: listed while they are few, else estimated and drawn."""

from __future__ import annotations

from math import comb, factorial

import numpy as np
import pytest

from dse.errors import DseError
from dse.space.flat import Clause, FlatSpace, Fold, Gather, Linear, Table, Variable, Wide
from dse.space.methods.clausal import ClausalEngine
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.sampling import population
from dse.space.methods.sampling.tilt import EmptyError, TooRareError
from dse.space.methods.solver import model
from dse.space.methods.tally import Tally

NEVER = Table((), np.array(False))


class Graphless(ClausalEngine):
    graph = None


def clausal(number, *rules):
    """Yes-or-no decisions, as if their rules had no graph together."""
    return Graphless(FlatSpace("coins", tuple(Variable(f"c{i}", ("no", "yes")) for i in range(number)), (), rules))


def heads(number, low, high):
    return Linear({i: np.array([0, 1, 0], np.int64) for i in range(number)}, low, high)


def permutation(number):
    """*number* places of as many values, all different by pairs."""
    values = tuple(f"v{n}" for n in range(number))
    apart = ~np.eye(number + 1, dtype=np.bool_)
    rules = tuple(Table((a, b), apart) for b in range(number) for a in range(b))
    return FlatSpace("permutation", tuple(Variable(f"p{n}", values) for n in range(number)), (), rules)


def test_nothing_is_left_where_nothing_meets_the_rules():
    empty = clausal(12, NEVER, heads(12, 3, None))
    assert empty.estimate(1) == Tally(0)
    assert empty.exact_count() == 0
    assert empty.first() is None
    for ask in (lambda: empty.sample(3, 1), lambda: empty.shares(1)):
        with pytest.raises(EmptyError):
            ask()


def test_few_rows_are_known_exactly():
    few = clausal(20, heads(20, 19, None))
    assert few.is_exact
    assert few.exact_count() == 21
    assert few.times_taken() == [[1, 20, 0]] * 20
    assert few.shares(1).shares[0].tolist() == [1 / 21, 20 / 21, 0]
    assert {tuple(row) for row in few.sample(200, 1).tolist()} == {tuple(row) for row in few._few.tolist()}


def test_an_estimate_has_the_true_number_inside():
    many = clausal(16, heads(16, 8, None))
    assert not many.is_exact
    assert many.exact_count() is None
    found = many.estimate(1)
    assert not found.exact
    assert found.low <= sum(comb(16, k) for k in range(8, 17)) <= found.high


def test_the_intervals_of_permutations_hold_the_factorial():
    # Of 10 intervals of 95 % fewer than 8 hold it once in 87 times.
    found = [population.estimate(permutation(6), seed) for seed in range(10)]
    assert sum(tally.low <= factorial(6) <= tally.high for tally in found) >= 8
    assert abs(sum(tally.value for tally in found) / 10 / factorial(6) - 1) < 0.02


def test_draws_meet_every_kind_of_rule_and_have_values_as_often_as_they_occur():
    inner = Variable("inner", ("a", "b"), (0, 1))
    weights = {n: np.array([0, n + 1, 0], np.int64) for n in range(8)}

    class Few:
        def bounds(self, low, high):
            return low[0] <= 3, high[0] > 3

        def holds(self, folds):
            return folds[0] <= 3

    yes = np.array([False, True, False])
    rules = (
        Linear(weights, 9, None),
        Clause(((1, yes), (2, yes), (8, np.array([True, False, True])))),
        Wide((Fold(Gather.SUM, {n: np.array([0, 1, 0], np.int64) for n in range(8)}, 0),), Few()),
    )
    flat = FlatSpace("mixed", (*(Variable(f"c{n}", ("no", "yes")) for n in range(8)), inner), (), rules)
    rows = population.drawn(flat, 4_000, 3)
    assert recheck(flat).valid(rows).all()
    every, _ = model.SolverModel(flat).rows(1_000)
    # Draws of one population depend on each other: twice the six standard deviations of independent ones.
    spread = 12 * 0.5 / len(rows) ** 0.5
    assert np.abs((rows == 1).mean(axis=0) - (every == 1).mean(axis=0)).max() < spread
    assert np.abs((rows < 0).mean(axis=0) - (every < 0).mean(axis=0)).max() < spread


def test_draws_of_permutations_hardly_repeat() -> None:
    # Redrawing one place moves no permutation; swaps do. 2,000 uniform draws of 10! rows repeat once in two cases.
    rows = population.drawn(permutation(10), 2_000, 1)
    assert len({tuple(row) for row in rows.tolist()}) > 1_950


@pytest.mark.thorough
def test_a_sample_starts_with_the_rows_of_a_smaller_one():
    large = clausal(16, heads(16, 8, None)).sample(200, 7)
    assert (large.sum(axis=1) >= 8).all()
    for number in (0, 64):
        assert clausal(16, heads(16, 8, None)).sample(number, 7).tolist() == large[:number].tolist()


@pytest.mark.thorough
def test_a_sum_that_few_rows_meet_is_tightened_in_steps():
    rare = population.estimate(clausal(40, heads(40, 37, None)).flat, 1)
    # 1 row in 10^8 has 37 heads or more: none of 8,000 rows at first.
    assert rare.low <= sum(comb(40, k) for k in (37, 38, 39, 40)) <= rare.high


def test_rows_too_rare_to_be_seen_are_refused(monkeypatch):
    monkeypatch.setattr(model, "is_installed", lambda: False)
    one = clausal(20, Table(tuple(range(20)), np.pad(np.zeros((2,) * 20, np.bool_), 0)))
    with pytest.raises(TooRareError):
        population.estimate(one.flat, 1)
    with pytest.raises(DseError, match="cannot count the configurations of 'coins'"):
        one.estimate(1)
    with pytest.raises(DseError, match="cannot draw configurations of 'coins'"):
        one.sample(1, 1)


def test_a_list_goes_on_as_long_as_it_finds_rows():
    blocks = list(clausal(11, heads(11, 1, None)).blocks())
    assert len(blocks) > 1
    assert len({tuple(row) for block in blocks for row in block.tolist()}) == sum(map(len, blocks)) == 2**11 - 1
