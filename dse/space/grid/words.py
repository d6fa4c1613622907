"""Exact arithmetic on arrays of whole numbers: the least words that hold them, running sums, scalar products.

Numbers too large for a word of 64 bits are known by their remainders for several moduli without a common divisor
(the Chinese remainder theorem): the same sums again, each time below 2^40.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import gcd
from typing import Any

import numpy as np
from numpy.typing import NDArray

Words = NDArray[np.unsignedinteger[Any]]

BITS = 40
LONGEST = 1 << (64 - BITS)
"""How many remainders may be added before they are reduced again."""

_PIECE = 20
_PIECE_MASK = np.uint64((1 << _PIECE) - 1)
_RUN = 1 << (53 - 2 * _PIECE)
"""So many products of two pieces add up exactly in a double of 53 bits, in any order."""
_BLOCK = _RUN << 6


def word(bound: int) -> type[np.unsignedinteger[Any]]:
    """The least type that holds numbers up to *bound*. Raises OverflowError if none does."""
    for bits, kind in ((16, np.uint16), (32, np.uint32), (64, np.uint64)):
        if bound < 1 << bits:
            return kind
    raise OverflowError("a number of more than 64 bits")


def moduli(bound: int) -> Iterator[int]:
    """Moduli below 2^40 without a common divisor whose product is greater than *bound*."""
    product, modulus = 1, 1 << BITS
    while product <= bound:
        modulus -= 1
        if gcd(product, modulus) == 1:
            yield modulus
            product *= modulus


def reduce(words: Words, modulus: int | None) -> None:
    """Take remainders in place; without a modulus nothing changes."""
    if modulus is not None:
        np.remainder(words, np.uint64(modulus), out=words)


def running_sums(words: Words, bound: int, modulus: int | None = None) -> Words:
    """Sums over all cells whose index is not greater along any axis; *bound* bounds their total.

    Raises OverflowError if that is more than 64 bits, and there is no modulus.
    """
    if modulus is None:
        word(bound)
    sums = words.astype(np.uint64)
    for axis in range(sums.ndim):
        np.cumsum(sums, axis=axis, out=sums)
        reduce(sums, modulus)
    return sums


def scalar_product(left: Words, right: Words) -> int:
    """Sum over all cells of left * right, both of one shape: in pieces of 20 bits, whose products are exact doubles."""
    left, right, total = left.reshape(-1), right.reshape(-1), 0
    for start in range(0, left.size, _BLOCK):
        lefts = _pieces(left[start : start + _BLOCK])
        rights = _pieces(right[start : start + _BLOCK])
        for row, one in enumerate(lefts):
            for column, other in enumerate(rights):
                runs = np.vecdot(one, other).astype(np.int64)
                total += int(runs.sum()) << (_PIECE * (row + column))
    return total


def _pieces(words: Words) -> list[NDArray[np.float64]]:
    """Pieces as doubles in rows of one run each, padded with zeros; none if all words are 0."""
    largest = int(words.max(initial=0))
    wide = np.zeros(-(-len(words) // _RUN) * _RUN, np.uint64)
    wide[: len(words)] = words
    number = -(-largest.bit_length() // _PIECE)
    return [
        ((wide >> np.uint64(_PIECE * place)) & _PIECE_MASK).astype(np.float64).reshape(-1, _RUN)
        for place in range(number)
    ]
