"""Random numbers of xorshift generators, as the C runtime computes them; states of whole numbers of 32 bits.

Two numbers are a word of 64 bits, the lower half first. 2 numbers: xorshift64*, whose next state is the product; 4:
xorshift128+; 33: xorshift1024*, the last of which is the place (S. Vigna, ACM Trans. Math. Softw. 42(4), 2016).
"""

from __future__ import annotations

from collections.abc import Sequence

_ALL, _HALF = 2**64 - 1, 2**32 - 1
_TURNS = 10


def random(which: int, state: Sequence[float]) -> float:
    """A number from 0 to 1 from *state* (*which* 0), or number *which* of the next state."""
    halves = [int(number) & _HALF for number in state]
    words = [low | high << 32 for low, high in zip(halves[::2], halves[1::2], strict=False)]
    place = halves[-1]
    if len(state) == 2:
        drawn = words[0] = _next(words[0])
    elif len(state) == 4:
        s1, s0 = words
        s1 ^= s1 << 23 & _ALL
        drawn = ((s1 ^ s0 ^ s1 >> 17 ^ s0 >> 26) + s0) & _ALL
        words = [s0, drawn]
    else:
        s0, place = words[place & 15], (place + 1) & 15
        s1 = words[place] ^ (words[place] << 31 & _ALL)
        words[place] = s0 ^ s0 >> 30 ^ s1 ^ s1 >> 11
        drawn = words[place] * 1181783497276652981 & _ALL
    if which == 0:
        return _signed(drawn, 64) * 2.0**-64 + 0.5
    return float(place if which == 33 else _element(words, which))


def random_start(which: int, seeds: Sequence[float]) -> float:
    """Number *which* of the state that two *seeds*, local and global, begin: of 33 numbers as of 4."""
    local, around = (int(seed) & _HALF for seed in seeds)
    word = local | around << 32 or 126247697
    for _ in range(_TURNS + (which - 1) // 2):
        word = _next(word)
    return float(_element([word], (which - 1) % 2 + 1))


def hashed(text: str) -> int:
    """A whole number of 32 bits from *text*, by A. Partow's hash function."""
    found = 0xAAAAAAAA
    for place, byte in enumerate(text.encode()):
        if place % 2:
            found ^= ~((found << 11) + (byte ^ found >> 5)) & _HALF
        else:
            found ^= (found << 7 ^ byte * (found >> 3)) & _HALF
    return _signed(found, 32)


def _next(word: int) -> int:
    word ^= word >> 12
    word ^= word << 25 & _ALL
    word ^= word >> 27
    return word * 2685821657736338717 & _ALL


def _element(words: Sequence[int], which: int) -> int:
    return _signed(words[(which - 1) // 2] >> (which - 1) % 2 * 32 & _HALF, 32)


def _signed(number: int, bits: int) -> int:
    return number - (1 << bits) if number >> (bits - 1) else number
