"""Draws with exactly known probabilities."""

from __future__ import annotations

from collections import Counter
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dse.space.uniform import bits, draw, generator, integers_below, tabulate


@pytest.mark.parametrize("limit", [1, 2, 3, 255, 256, 257, 3**200])
def test_whole_numbers_stay_below_their_limit_and_reach_near_both_ends(limit):
    found = integers_below(limit, 2000, generator(1))
    assert len(found) == 2000
    assert 0 <= min(found) <= limit // 50
    assert limit - 1 - limit // 50 <= max(found) < limit


def test_small_whole_numbers_are_equally_likely():
    counts = Counter(integers_below(5, 50_000, generator(2)))
    # 50,000 draws, 5 values: each 10,000 with a standard deviation of 89.
    assert all(abs(counts[value] - 10_000) < 400 for value in range(5))


def test_no_whole_number_is_below_nothing():
    with pytest.raises(ValueError, match="at least 1"):
        integers_below(0, 1, generator(1))


SHARES = st.lists(st.one_of(st.just(0.0), st.floats(1e-30, 1e30)), min_size=1, max_size=9).filter(any)


@given(SHARES)
def test_the_parts_of_a_table_are_whole_and_make_up_everything(shares):
    table = tabulate(np.array([shares]))
    starts = [*map(int, table.starts[0]), 1 << 63]
    parts = [end - start for start, end in pairwise(starts)]
    alive = [value for value, share in enumerate(shares) if share > 0]
    assert sum(parts) == 1 << 63
    assert all(part > 0 for part in parts[: len(alive)])
    assert table.values[0, : len(alive)].tolist() == alive
    total = sum(map(Fraction, shares))
    for part, value, chance in zip(parts, alive, table.chances[0], strict=False):
        assert float(Fraction(part, 1 << 63)) == chance
        assert abs(Fraction(part, 1 << 63) - Fraction(shares[value]) / total) < Fraction(1, 1 << 49)


@given(SHARES, st.lists(st.integers(0, (1 << 63) - 1), min_size=1, max_size=20))
def test_bits_pick_the_branch_in_whose_part_they_lie(shares, drawn):
    table = tabulate(np.array([[1.0] * len(shares), shares]))
    places = draw(table, np.ones(len(drawn), np.int32), np.array(drawn, np.uint64))
    width = table.starts.shape[1]
    for place, number in zip(places.tolist(), drawn, strict=True):
        starts = [int(start) for start in table.starts[1]]
        assert place - width == max(j for j, start in enumerate(starts) if start <= number)
        assert shares[table.values.ravel()[place]] > 0


def test_bits_are_one_word_of_the_stream_each():
    together = bits(generator(3), (6, 5))
    one = generator(3)
    assert (np.concatenate([bits(one, (2, 5)), bits(one, (4, 5))]) == together).all()
