"""Arithmetic in words and the two ways to run a sweep: exact at the edges of their words, and equal to each other."""

from __future__ import annotations

from itertools import combinations
from math import gcd, prod

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dse.space.flat import FlatSpace, Linear, Variable
from dse.space.grid.levels import run_levels
from dse.space.grid.nodes import run
from dse.space.grid.split import Counting, counting
from dse.space.grid.sweep import Sweep, backward, forward, schedule
from dse.space.grid.words import BITS, moduli, running_sums, scalar_product, word
from dse.space.mdd.diagram import compile_diagram


@pytest.mark.parametrize("bits", [1, 15, 16, 31, 32, 63, 64])
def test_a_word_holds_its_largest_number_and_not_the_next(bits: int) -> None:
    assert int(np.iinfo(word((1 << bits) - 1)).max) >= (1 << bits) - 1
    with pytest.raises(OverflowError):
        word(1 << 64)


@given(st.integers(0, 2**200))
def test_a_number_is_known_by_its_remainders(number: int) -> None:
    chosen = list(moduli(number))
    assert prod(chosen) > number
    assert all(1 < modulus < 1 << BITS for modulus in chosen)
    assert all(gcd(one, other) == 1 for one, other in combinations(chosen, 2))


@pytest.mark.parametrize(
    ("left", "right"),
    [(2**64 - 1, 2**64 - 1), (2**16 - 1, 2**64 - 1), (1, 0), (2**40 - 1, 2**20), (2**53 + 1, 2**53 - 1)],
)
@pytest.mark.parametrize("length", [1, 8191, 8192, 8193, 1_100_000])
def test_products_of_the_largest_words_add_up_exactly(left: int, right: int, length: int) -> None:
    ours, theirs = np.full(length, left, np.uint64), np.full(length, right, np.uint64)
    assert scalar_product(ours, theirs) == length * left * right


@given(st.data())
def test_scalar_products_of_any_words_are_exact(data: st.DataObject) -> None:
    numbers = st.lists(st.integers(0, 2**64 - 1), min_size=6, max_size=6)
    left, right = data.draw(numbers), data.draw(numbers)
    arrays = (np.array(some, np.uint64).reshape(2, 3) for some in (left, right))
    assert scalar_product(*arrays) == sum(a * b for a, b in zip(left, right, strict=True))


@given(st.lists(st.integers(0, 2**64 - 1), min_size=12, max_size=12), st.integers(2, 2**40 - 1))
def test_running_sums_are_exact_or_refused_and_their_remainders_always_right(values: list[int], modulus: int) -> None:
    words = np.array(values, np.uint64).reshape(3, 4)
    expected = np.array(values, object).reshape(3, 4).cumsum(axis=0).cumsum(axis=1)
    remainders = running_sums(words % np.uint64(modulus), 0, modulus)
    assert (remainders.astype(object) == expected % modulus).all()
    if sum(values) < 1 << 64:
        assert (running_sums(words, sum(values)).astype(object) == expected).all()
    else:
        with pytest.raises(OverflowError):
            running_sums(words, sum(values))


def random_counting(seed: int) -> Counting:
    """Places without other rules; of 90 values with five weights, many terms are equal."""
    rng = np.random.default_rng(seed)
    places, values = 9, int(rng.choice([3, 4, 90]))
    variables = tuple(Variable(f"v{i}", tuple(f"a{a}" for a in range(values))) for i in range(places))
    rules: list[Linear] = []
    for axis in range(int(rng.integers(1, 4))):
        weights = {i: np.append(rng.integers(0, 5, values), 0).astype(np.int64) for i in range(places)}
        bounds = [(None, 30 - 5 * axis), (None, 17), (12, 20)][int(rng.integers(3))]
        rules.append(Linear(weights, *bounds))
    found = counting(compile_diagram(FlatSpace("space", variables, (), tuple(rules))))
    # Weights may happen to be so small that no bound matters.
    return found if isinstance(found, Counting) else random_counting(seed + 1)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 2**32 - 1), st.integers(0, 9))
def test_grid_by_grid_and_level_by_level_give_the_same_grids(seed: int, cut: int) -> None:
    found = random_counting(seed)
    sweeps: list[Sweep] = [
        forward(found.layers, found.sums, found.before, cut),
        backward(found.layers, found.sums, found.after, cut),
    ]
    order = [schedule(sweep, [prod(shape) for shape in sweep.shapes]) for sweep in sweeps]
    for sweep, one_by_one in zip(sweeps, order, strict=True):
        for modulus in (None, 97):
            at_once, single = run_levels(sweep, modulus).grids, run(sweep, one_by_one, modulus=modulus).grids
            assert {node for node, grid in single.items() if grid.largest} == set(at_once)
            for node, grid in at_once.items():
                assert grid.ways.tolist() == single[node].ways.tolist()
                assert max(grid.ways.tolist()) <= grid.largest
                assert sum(grid.ways.tolist()) <= int(sweep.paths[-1][node])


def test_a_bound_on_the_numbers_keeps_a_grid_in_the_least_word() -> None:
    found = random_counting(7)
    sweep = forward(found.layers, found.sums, found.before, 9)
    order = schedule(sweep, [1.0] * 10)
    free = run(sweep, order)
    capped = run(sweep, order, [free.largest])
    assert {node: grid.ways.tolist() for node, grid in capped.grids.items()} == {
        node: grid.ways.tolist() for node, grid in free.grids.items()
    }
