"""Uniform samples against every valid row of small spaces."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from dse.space.flat import ABSENT, FlatSpace, Fold, Gather, Linear, Table, Variable, Wide
from dse.space.methods.mdd.diagram import compile_diagram
from dse.space.methods.mdd.expand import expand
from dse.space.methods.sampling.sample import MOST_DRAWS, sample, tilted_walks, walk
from dse.space.methods.sampling.tilt import EmptyError, TooRareError, tilt

SUSPICIOUS = 4.5
"""Standard deviations a chi-square statistic may lie off; seeds are fixed, so a test passes for ever or never."""


def variables(*sizes, parents=None):
    parents = parents or {}
    return tuple(
        Variable(f"v{i}", tuple(f"v{i}_{a}" for a in range(size)), parents.get(i)) for i, size in enumerate(sizes)
    )


def space(some, *rules):
    return FlatSpace("small", some, (), rules)


def weights(*numbers):
    return {i: np.array([*own, 0], np.int64) for i, own in enumerate(numbers)}


def all_rows(flat):
    """Every row of the hierarchy that meets every rule, by trying all of them."""
    found = []
    for row in product(*(range(-1, len(variable.values)) for variable in flat.variables)):
        exists = (v.parent is None or row[v.parent[0]] == v.parent[1] for v in flat.variables)
        if all((value != ABSENT) == there for value, there in zip(row, exists, strict=True)):
            found.append(row)
    return [row for row in found if all(_meets(rule, row) for rule in flat.rules)]


def _meets(rule, row):
    match rule:
        case Table():
            return bool(rule.allowed[tuple(row[v] for v in rule.scope)])
        case Linear():
            total = sum(int(own[row[v]]) for v, own in rule.weights.items())
            return (rule.low is None or total >= rule.low) and (rule.high is None or total <= rule.high)
        case Wide():
            folds = [fold.start + sum(int(own[row[v]]) for v, own in fold.values.items()) for fold in rule.folds]
            return rule.judge.holds(folds)
    raise AssertionError(rule)


@dataclass(frozen=True)
class RatioAtMost:
    """first <= ratio * second, vague about a band around equality."""

    ratio: Fraction
    vague: int

    def bounds(self, low, high):
        sure = high[0] + self.vague <= float(self.ratio) * low[1]
        never = low[0] - self.vague > float(self.ratio) * high[1]
        return ~never, ~sure

    def holds(self, folds):
        return folds[0] <= self.ratio * folds[1]


def ratio_rule(first, second, ratio, vague=1):
    folds = tuple(Fold(Gather.SUM, own, 0) for own in (first, second))
    return Wide(folds, RatioAtMost(Fraction(ratio), vague))


NESTED = variables(3, 2, 4, 3, 4, parents={1: (0, 1), 3: (2, 2)})
NOT_BOTH = Table((0, 2), np.array([[True] * 5] * 3 + [[False] * 5]) & ~(np.eye(4, 5, dtype=bool) & (np.arange(5) == 1)))
MASS = Linear(weights([1, 5, 9], [2, 7], [3, 0, 4, 8], [1, 1, 6], [0, 2, 5, 9]), None, 14)
COST = Linear(weights([9, 4, 1], [1, 2], [7, 5, 2, 0], [3, 2, 1], [8, 6, 3, 0]), 9, 16)
RATIO = ratio_rule(MASS.weights, COST.weights, Fraction(6, 5))

SPACES = {
    "no sums": space(NESTED, NOT_BOTH),
    "one sum": space(NESTED, NOT_BOTH, MASS),
    "two sums, one two-sided": space(NESTED, NOT_BOTH, MASS, COST),
    "one value of a sum": space(NESTED, Linear(COST.weights, 12, 12)),
    "the same sum twice": space(NESTED, MASS, Linear(MASS.weights, 3, 12)),
    "a ratio": space(NESTED, NOT_BOTH, RATIO),
    "a ratio and sums": space(NESTED, MASS, COST, RATIO),
    "a rare corner": space(NESTED, Linear(MASS.weights, None, 4)),
    "another order": space(NESTED, MASS, COST),
}


def chi_square(rows, valid):
    """How many standard deviations the chi-square statistic of uniformity is above what it should be."""
    counts = Counter(map(tuple, rows.tolist()))
    expected = len(rows) / len(valid)
    assert set(counts) <= set(valid)
    statistic = sum((counts[row] - expected) ** 2 / expected for row in valid)
    freedom = max(len(valid) - 1, 1)
    return (statistic - (len(valid) - 1)) / (2 * freedom) ** 0.5


@pytest.mark.parametrize("name", SPACES)
def test_every_valid_row_is_equally_likely(name):
    flat = SPACES[name]
    order = (4, 2, 3, 0, 1) if name == "another order" else None
    valid = all_rows(flat)
    assert len(valid) > 1
    rows = sample(compile_diagram(flat, order), 200 * len(valid), 11)
    assert abs(chi_square(rows, valid)) < SUSPICIOUS


def test_the_measure_of_uniformity_sees_a_row_that_is_too_frequent():
    flat = SPACES["one sum"]
    valid = all_rows(flat)
    rows = sample(compile_diagram(flat), 200 * len(valid), 11)
    bent = np.concatenate([rows, np.array([valid[0]] * 200, np.int16)])
    assert abs(chi_square(bent, valid)) > SUSPICIOUS


def test_the_layers_may_hold_the_sums_already():
    flat = SPACES["two sums, one two-sided"]
    valid = all_rows(flat)
    rows = sample(expand(compile_diagram(flat)), 100 * len(valid), 3)
    assert abs(chi_square(rows, valid)) < SUSPICIOUS


def test_the_same_seed_gives_the_same_rows_and_a_larger_sample_starts_with_a_smaller():
    diagram = compile_diagram(SPACES["two sums, one two-sided"])
    many = sample(diagram, 5000, 7)
    assert (sample(diagram, 5000, 7) == many).all()
    assert (sample(diagram, 300, 7) == many[:300]).all()
    assert not (sample(diagram, 5000, 8) == many).all()


def test_the_size_of_a_block_changes_nothing(monkeypatch):
    diagram = compile_diagram(SPACES["two sums, one two-sided"])
    expected = sample(diagram, 1000, 7)
    monkeypatch.setattr("dse.space.methods.sampling.sample._BLOCK", 97)
    assert (sample(diagram, 1000, 7) == expected).all()


def test_the_probability_of_a_walk_is_that_of_the_tilt():
    flat = SPACES["a rare corner"]
    diagram = compile_diagram(flat)
    tilted = tilt(diagram)
    walked = walk(tilted_walks(diagram, tilted), np.random.default_rng(1), 5000)
    found = dict(zip(map(tuple, walked.rows.tolist()), np.ldexp(walked.mantissa, walked.exponent), strict=True))
    everything = all_rows(space(NESTED))
    mass = [int(sum(MASS.weights[i][row[i]] for i in range(5))) for row in everything]
    shares = np.exp(-tilted.multipliers[0] * np.array(mass))
    for row, share in zip(everything, shares / shares.sum(), strict=True):
        if row in found:
            assert found[row] == pytest.approx(share, rel=1e-12)


def test_a_space_without_variables_has_one_row():
    assert sample(compile_diagram(space(())), 3, 1).shape == (3, 0)


def test_no_rows_are_no_rows():
    assert sample(compile_diagram(SPACES["one sum"]), 0, 1).shape == (0, 5)


def test_the_only_valid_row_is_found_among_a_million():
    flat = space(variables(*[8] * 7), Linear(weights(*[range(8)] * 7), 49, None))
    rows = sample(compile_diagram(flat), 50, 1)
    assert rows.shape == (50, 7)
    assert (rows == 7).all()


def test_a_sum_that_no_row_reaches_is_proven_empty():
    flat = space(NESTED, Linear(MASS.weights, 1000, None))
    with pytest.raises(EmptyError):
        sample(compile_diagram(flat), 1, 1)


def test_sums_that_exclude_one_another_are_proven_empty():
    opposed = weights(*[[4, 3, 2, 1, 0]] * 6)
    both = space(variables(*[5] * 6), Linear(weights(*[range(5)] * 6), None, 11), Linear(opposed, None, 12))
    assert all_rows(space(both.variables[:3]))
    with pytest.raises(EmptyError):
        sample(compile_diagram(both), 1, 1)


def test_contradicting_rules_are_proven_empty():
    nothing = Table((), np.array(False))
    with pytest.raises(EmptyError):
        sample(compile_diagram(space(NESTED, nothing)), 1, 1)


def test_what_is_rare_but_not_proven_empty_is_given_up():
    even = Linear(weights(*[[0, 2, 4]] * 5), 5, 5)
    with pytest.raises(TooRareError):
        sample(compile_diagram(space(variables(*[3] * 5), even)), 1, 1, most_draws=50_000)
    assert MOST_DRAWS > 50_000


@pytest.mark.thorough
def test_more_rows_than_any_float_can_count_are_no_trouble():
    number = 700
    flat = space(variables(*[8] * number), Linear(weights(*[range(8)] * number), None, 2000))
    rows = sample(compile_diagram(flat), 50, 1)
    assert int(rows.sum(axis=1).max()) <= 2000
    assert int(rows.sum(axis=1).min()) > 1900


SIZES = st.lists(st.integers(1, 4), min_size=1, max_size=5)


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_samples_of_random_spaces_are_valid_and_reach_every_row(data):
    sizes = data.draw(SIZES)
    some = variables(*sizes, parents={i: (i - 1, 0) for i in range(1, len(sizes)) if data.draw(st.booleans())})
    numbers = st.integers(-9, 9)
    rules = []
    for _ in range(data.draw(st.integers(0, 3))):
        own = weights(*[[data.draw(numbers) for _ in range(size)] for size in sizes])
        low = data.draw(st.integers(-20, 10))
        rules.append(Linear(own, low, low + data.draw(st.integers(0, 25))))
    flat = space(some, *rules)
    valid = set(all_rows(flat))
    diagram = compile_diagram(flat)
    try:
        rows = sample(diagram, 40 * len(valid) + 1, 5, most_draws=400_000)
    except (EmptyError, TooRareError):
        assert not valid
        return
    # A row is missing from 40 times as many draws with probability e^-40.
    assert set(map(tuple, rows.tolist())) == valid
