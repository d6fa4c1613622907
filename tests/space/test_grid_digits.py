"""Arithmetic in digits and the two ways to run a sweep: exact at the edges of their words, and equal to each other."""

from __future__ import annotations

from math import prod

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from dse.space.flat import FlatSpace, Linear, Variable
from dse.space.methods.grid.digits import (
    DIGIT_BITS,
    Digits,
    carry,
    digits_for,
    running_sums,
    scalar_product,
    split,
    word,
)
from dse.space.methods.grid.levels import run_levels
from dse.space.methods.grid.nodes import SumGrid, run
from dse.space.methods.grid.split import Counting, counting
from dse.space.methods.grid.sweep import Sweep, backward, forward, schedule
from dse.space.methods.mdd.diagram import compile_diagram


def digits(numbers: list[int], shape: tuple[int, ...], number: int) -> Digits:
    """Whole numbers as *number* digits."""
    if number == 1:
        return (np.array(numbers, np.uint64).reshape(shape),)
    mask = (1 << DIGIT_BITS) - 1
    return tuple(
        np.array([value >> (DIGIT_BITS * place) & mask for value in numbers], np.uint64).reshape(shape)
        for place in range(number)
    )


def numbers(parts: Digits) -> list[int]:
    return [
        sum(int(part) << (DIGIT_BITS * place) for place, part in enumerate(cell))
        for cell in zip(*(part.reshape(-1).tolist() for part in parts), strict=True)
    ]


@pytest.mark.parametrize("bits", [1, 15, 16, 31, 32, 63, 64])
def test_a_word_holds_its_largest_number_and_not_the_next(bits: int) -> None:
    kind = word((1 << bits) - 1)
    assert kind is not None
    assert int(np.iinfo(kind).max) >= (1 << bits) - 1
    assert word(1 << 64) is None
    assert digits_for((1 << 64) - 1) == 1
    assert digits_for(1 << 64) == 2
    assert digits_for(1 << 80) == 3


@given(st.lists(st.integers(0, 2**64 - 1), min_size=1, max_size=8), st.integers(2, 4))
def test_splitting_and_carrying_keep_the_numbers(values: list[int], number: int) -> None:
    parts = split(np.array(values, np.uint64), number)
    assert numbers(tuple(parts)) == values
    doubled = [part * np.uint64(5) for part in parts]
    carry(doubled)
    assert numbers(tuple(doubled)) == [5 * value for value in values]
    assert all(int(part.max()) < 1 << DIGIT_BITS for part in doubled[:-1])


@pytest.mark.parametrize(
    ("left", "right"),
    [(2**64 - 1, 2**64 - 1), (2**16 - 1, 2**64 - 1), (1, 0), (2**40 - 1, 2**20), (2**53 + 1, 2**53 - 1)],
)
@pytest.mark.parametrize("length", [1, 8191, 8192, 8193, 1_100_000])
def test_products_of_the_largest_words_add_up_exactly(left: int, right: int, length: int) -> None:
    ours, theirs = np.full(length, left, np.uint64), np.full(length, right, np.uint64)
    assert scalar_product((ours,), (theirs,)) == length * left * right


@given(st.data(), st.integers(1, 3), st.integers(1, 3))
def test_scalar_products_of_any_digits_are_exact(data: st.DataObject, one: int, other: int) -> None:
    def draw(number: int) -> list[int]:
        most = 2**64 - 1 if number == 1 else (1 << (DIGIT_BITS * number)) - 1
        return data.draw(st.lists(st.integers(0, most), min_size=6, max_size=6))

    left, right = draw(one), draw(other)
    expected = sum(a * b for a, b in zip(left, right, strict=True))
    assert scalar_product(digits(left, (2, 3), one), digits(right, (2, 3), other)) == expected


@given(st.lists(st.integers(0, 2**64 - 1), min_size=12, max_size=12))
def test_running_sums_pass_64_bits_exactly(values: list[int]) -> None:
    total = sum(values)
    sums = np.array(numbers(running_sums(digits(values, (3, 4), 1), total)), object).reshape(3, 4)
    table = np.array(values, object).reshape(3, 4)
    expected = table.cumsum(axis=0).cumsum(axis=1)
    assert (sums == expected).all()
    assert sums[-1, -1] == total


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
    for sweep in sweeps:
        at_once = run_levels(sweep).grids
        one_by_one = run(sweep, schedule(sweep, [prod(shape) for shape in sweep.shapes])).grids
        assert {node for node, grid in one_by_one.items() if grid.largest} == set(at_once)
        for node, grid in at_once.items():
            assert numbers(grid.digits) == numbers(one_by_one[node].digits)
            assert max(numbers(grid.digits)) <= grid.largest
            assert sum(numbers(grid.digits)) <= int(sweep.paths[-1][node])


def test_a_bound_on_the_numbers_keeps_a_grid_in_the_least_word() -> None:
    found = random_counting(7)
    sweep = forward(found.layers, found.sums, found.before, 9)
    order = schedule(sweep, [1.0] * 10)
    free = run(sweep, order)
    capped = run(sweep, order, [free.largest])

    def total(grid: SumGrid) -> int:
        return sum(numbers(grid.digits))

    assert {node: total(grid) for node, grid in capped.grids.items()} == {
        node: total(grid) for node, grid in free.grids.items()
    }
