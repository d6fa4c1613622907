from __future__ import annotations

import numpy as np
from hypothesis import given, strategies as st

from dse.space.methods.mdd.distinct import distinct, distinct_rows

LARGE = 2**62


@given(st.data())
def test_rows_have_one_class_exactly_if_they_are_equal(data: st.DataObject) -> None:
    largest = [data.draw(st.sampled_from((0, 2, 1000, LARGE))) for _ in range(data.draw(st.integers(0, 5)))]
    row = st.tuples(*(st.sampled_from((-most, 0, most // 2, most)) for most in largest))
    rows = data.draw(st.lists(row, max_size=30))
    columns = [np.array([row[place] for row in rows], np.int64) for place in range(len(largest))]
    first, classes = distinct(columns, len(rows))
    expected = sorted(set(rows))
    assert [expected[number] for number in classes.tolist()] == rows
    assert first.tolist() == [rows.index(row) for row in expected]


@given(st.integers(1, 200), st.integers(1, 40), st.data())
def test_wide_matrices_are_sorted_lexicographically(span: int, width: int, data: st.DataObject) -> None:
    row = st.lists(st.sampled_from((0, span // 2, span - 1)), min_size=width, max_size=width)
    matrix = data.draw(st.lists(row, min_size=1, max_size=12))
    first, classes = distinct_rows(np.array(matrix), span)
    expected = sorted({tuple(row) for row in matrix})
    assert [expected[number] for number in classes.tolist()] == [tuple(row) for row in matrix]
    assert [tuple(matrix[number]) for number in first.tolist()] == expected
