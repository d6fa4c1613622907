"""Which rows of integers are equal: exact, without hashing, in one sort where the rows fit into 62 bits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Ints

_ROOM = 1 << 62


def distinct(columns: Sequence[Ints], rows: int) -> tuple[Ints, Ints]:
    """For each class of equal rows one row number, and for each of *rows* its class.

    Columns of shape (rows,); classes ascend lexicographically, the number of a row is the first of its class.
    """
    key, span = np.zeros(rows, np.int64), 1
    if not rows:
        return key, key
    for column in columns:
        low = int(column.min())
        width = int(column.max()) - low + 1
        if width == 1:
            continue
        if span == 1 and width <= _ROOM:
            key, span = column - low, width
            continue
        if span * width > _ROOM:
            if span > rows:
                key, span = _ranks(key)
            if span * width > _ROOM:
                column, width = _ranks(column)  # noqa: PLW2901  the ranks stand for the column
                low = 0
        key, span = key * width + (column - low), span * width
    return _counted(key, span) if span <= 4 * rows else _sorted(key)


def distinct_rows(matrix: NDArray[np.signedinteger[Any]], span: int) -> tuple[Ints, Ints]:
    """The same for the rows of a matrix whose entries lie in [0, span)."""
    rows, width = matrix.shape
    together = max(1, 62 // max(1, (span - 1).bit_length()))
    columns = []
    for start in range(0, width, together):
        block = matrix[:, start : start + together]
        key = block[:, 0].astype(np.int64)
        for column in range(1, block.shape[1]):
            key *= span
            key += block[:, column]
        columns.append(key)
    return distinct(columns, rows)


def _ranks(column: Ints) -> tuple[Ints, int]:
    first, classes = _sorted(column)
    return classes, len(first)


def _counted(key: Ints, span: int) -> tuple[Ints, Ints]:
    """By counting: keys are not much more than rows."""
    seen = np.zeros(span, np.bool_)
    seen[key] = True
    number = np.cumsum(seen) - 1
    classes = number[key]
    first = np.empty(int(number[-1]) + 1, np.int64)
    first[classes[::-1]] = np.arange(len(key) - 1, -1, -1)
    return first, classes


def _sorted(key: Ints) -> tuple[Ints, Ints]:
    order = np.argsort(key, kind="stable")
    ascending = key[order]
    new = np.empty(len(key), np.bool_)
    new[0] = True
    np.not_equal(ascending[1:], ascending[:-1], out=new[1:])
    classes = np.empty(len(key), np.int64)
    classes[order] = np.cumsum(new) - 1
    return order[new], classes
