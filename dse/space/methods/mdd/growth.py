"""One layer of a diagram made from the one before: all states expanded at once, equal ones become one node."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Ints
from dse.space.methods.mdd.distinct import distinct

_ENTRIES = 32
"""Children allowed for each node allowed: a bound of memory where variables have very many values."""

_BLOCK = 1 << 21
"""Children times columns expanded at a time: a bound of memory."""


class TooWideError(Exception):
    """The diagram needs more nodes than allowed; callers fall back to another order or another method."""


class Growth:
    """Nodes made so far, against the most allowed; raises TooWideError before more memory is taken."""

    def __init__(self, most_nodes: int) -> None:
        self.layers: list[NDArray[np.int32]] = []
        self._nodes_left = most_nodes
        self._entries_left = _ENTRIES * most_nodes

    def grow(self, states: Ints, width: int, successors: Callable[[Ints], tuple[Ints, list[Ints]]]) -> Ints:
        """Append the layer of *states*, shape (columns, nodes), and return those of the next.

        *successors* of some states are the pairs node * width + value that exist and the columns after each.
        """
        columns, nodes = states.shape
        self._nodes_left -= nodes
        self._entries_left -= (nodes - 1) * width
        if self._nodes_left < 0 or self._entries_left < 0:
            raise TooWideError
        child = np.full(nodes * width, -1, np.int32)
        block = max(1, _BLOCK // (width * max(1, columns)))
        found: list[Ints] = []
        places: list[tuple[Ints, Ints]] = []
        total = 0
        for start in range(0, nodes, block):
            pairs, after = successors(states[:, start : start + block])
            first, classes = distinct(after, len(pairs))
            places.append((pairs + start * width, classes + total))
            found.append(np.array([column[first] for column in after], np.int64).reshape(len(after), len(first)))
            total += len(first)
            if len(first) > self._nodes_left or total > 8 * self._nodes_left + _BLOCK:
                raise TooWideError
        following = found[0]
        if len(found) > 1:
            following = np.concatenate(found, axis=1)
            first, classes = distinct(list(following), total)
            following = following[:, first]
            places = [(pairs, classes[numbers]) for pairs, numbers in places]
        for pairs, numbers in places:
            child[pairs] = numbers
        self.layers.append(child.reshape(nodes, width))
        return following
