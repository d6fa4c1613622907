"""Draws with exactly known probabilities."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
from hypothesis import given, strategies as st

from dse.space.methods.sampling.uniform import bits, draw, generator, tabulate

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
