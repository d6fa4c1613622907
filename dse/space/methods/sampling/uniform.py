"""Random draws whose probabilities are known exactly: whole numbers of 63 bits, and branches from tables.

A table holds whole numbers out of 2^63, so what is drawn has exactly the tabulated probability; that the table was
made from rounded weights then matters no more, because the caller can correct for it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import Floats

Bits = NDArray[np.uint64]
"""Independent uniform whole numbers below 2^63."""

DRAWN_BITS = 63

_Entry = TypeVar("_Entry", bound=np.generic)


@dataclass(frozen=True, slots=True, eq=False)
class BranchTable:
    """For every node, branches in ascending order; arrays of shape (nodes, width), padded on the right.

    Branch j is drawn for bits in [starts[j], starts[j + 1]); *values* is its column among the shares, *chances* its
    probability. Padding starts at 2^63, which no bits reach.
    """

    starts: NDArray[np.uint64]
    values: NDArray[np.int16]
    chances: Floats


def generator(seed: int) -> np.random.Generator:
    """The stream of random numbers of a seed; the same on all machines."""
    return np.random.Generator(np.random.PCG64(seed))


def bits(random: np.random.Generator, shape: tuple[int, ...]) -> Bits:
    """Uniform whole numbers below 2^63; one word of the stream each, in order."""
    return random.integers(0, 1 << DRAWN_BITS, size=shape, dtype=np.uint64)


def tabulate(shares: Floats) -> BranchTable:
    """Branches drawn in proportion to *shares* >= 0, shape (nodes, columns), at least one positive in each row.

    Probabilities differ from the shares by rounding; none is less than its share by more than rounding.
    """
    alive = shares > 0
    most = int(alive.sum(axis=1).max())
    columns = np.argsort(~alive, axis=1, kind="stable")[:, :most]
    own = np.take_along_axis(shares / shares.sum(axis=1, keepdims=True), columns, axis=1)
    parts = np.ceil(own * 2.0**DRAWN_BITS).astype(np.uint64)
    rows, largest = np.arange(len(parts)), own.argmax(axis=1)
    parts[rows, largest] = 0
    parts[rows, largest] = np.uint64(1 << DRAWN_BITS) - parts.sum(axis=1, dtype=np.uint64)
    # As wide as a power of two, so that every bisection takes the same steps.
    width = 1 << (most - 1).bit_length()
    starts = np.full((len(parts), width), 1 << DRAWN_BITS, np.uint64)
    starts[:, 0] = 0
    np.cumsum(parts[:, :-1], axis=1, out=starts[:, 1:most])
    return BranchTable(
        starts, _widened(columns.astype(np.int16), width), _widened(np.ldexp(parts.astype(float), -DRAWN_BITS), width)
    )


def draw(table: BranchTable, node: NDArray[np.int32], drawn: Bits) -> NDArray[np.int64]:
    """What *drawn* picks at each *node*, both of shape (rows,): places in the ravelled arrays of the table."""
    width = table.starts.shape[1]
    starts = table.starts.ravel()
    place: NDArray[np.int64] = node.astype(np.int64) * width
    step = width >> 1
    while step:
        place += step * (starts[place + step] <= drawn)
        step >>= 1
    return place


def _widened(array: NDArray[_Entry], width: int) -> NDArray[_Entry]:
    return np.pad(array, ((0, 0), (0, width - array.shape[1])))
