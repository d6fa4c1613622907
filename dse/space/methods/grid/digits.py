"""Exact arithmetic on arrays of whole numbers of any size: carries, running sums, scalar products.

A number below 2^64 is one digit, of the least type that holds it; a greater one has several of 40 bits each, the
least significant first, in 64-bit words whose upper bits take up the sums until they are carried.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

WordArray = NDArray[np.unsignedinteger[Any]]
Digits = tuple[WordArray, ...]
"""Arrays of one shape; one of any unsigned type, or several of uint64 below 2^40 each."""

DIGIT_BITS = 40
LONGEST = 1 << (64 - DIGIT_BITS)
"""How many digits may be added before they are carried."""

_BITS = np.uint64(DIGIT_BITS)
_MASK = np.uint64((1 << DIGIT_BITS) - 1)
_PIECE = 20
_PIECE_MASK = np.uint64((1 << _PIECE) - 1)
_RUN = 1 << (53 - 2 * _PIECE)
"""So many products of two pieces add up exactly in a double of 53 bits, in any order."""
_BLOCK = _RUN << 6


def word(bound: int) -> type[np.unsignedinteger[Any]] | None:
    """The least type that holds numbers up to *bound*, None if it takes several digits."""
    for bits, kind in ((16, np.uint16), (32, np.uint32), (64, np.uint64)):
        if bound < 1 << bits:
            return kind
    return None


def digits_for(bound: int) -> int:
    """How many digits numbers up to *bound* take; one only if they fit a word."""
    return 1 if word(bound) else -(-bound.bit_length() // DIGIT_BITS)


def split(words: WordArray, number: int) -> list[WordArray]:
    """A single digit of any type as *number* digits of 40 bits, at least two."""
    wide = words.astype(np.uint64)
    return [wide & _MASK, wide >> _BITS, *(np.zeros_like(wide) for _ in range(number - 2))]


def carry(digits: Sequence[WordArray]) -> None:
    """Bring all digits but the last below 2^40, in place; a single digit stays as it is."""
    for low, high in pairwise(digits):
        np.add(high, low >> _BITS, out=high)
        np.bitwise_and(low, _MASK, out=low)


def running_sums(digits: Digits, bound: int) -> Digits:
    """Sums over all cells whose index is not greater along any axis; *bound* bounds their total."""
    count = digits_for(bound)
    if count == 1:
        sums = [digits[0].astype(np.uint64)]
    elif len(digits) == 1:
        sums = split(digits[0], count)
    else:
        sums = [digit.copy() for digit in digits]
        sums += [np.zeros_like(sums[0]) for _ in range(count - len(digits))]
    for axis in range(sums[0].ndim):
        for digit in sums:
            np.cumsum(digit, axis=axis, out=digit)
        carry(sums)
    return tuple(sums)


def scalar_product(left: Digits, right: Digits) -> int:
    """Sum over all cells of left * right; both of one shape."""
    return sum(
        _product(one.reshape(-1), other.reshape(-1)) << (DIGIT_BITS * (row + column))
        for row, one in enumerate(left)
        for column, other in enumerate(right)
    )


def _product(left: WordArray, right: WordArray) -> int:
    """In pieces of 20 bits, whose products add up exactly in doubles."""
    total = 0
    for start in range(0, left.size, _BLOCK):
        lefts = _pieces(left[start : start + _BLOCK])
        rights = _pieces(right[start : start + _BLOCK])
        for row, one in enumerate(lefts):
            for column, other in enumerate(rights):
                runs = np.vecdot(one, other).astype(np.int64)
                total += int(runs.sum()) << (_PIECE * (row + column))
    return total


def _pieces(words: WordArray) -> list[NDArray[np.float64]]:
    """Pieces as doubles in rows of one run each, padded with zeros; none if all words are 0."""
    largest = int(words.max(initial=0))
    wide = np.zeros(-(-len(words) // _RUN) * _RUN, np.uint64)
    wide[: len(words)] = words
    number = -(-largest.bit_length() // _PIECE)
    return [
        ((wide >> np.uint64(_PIECE * place)) & _PIECE_MASK).astype(np.float64).reshape(-1, _RUN)
        for place in range(number)
    ]
