"""Values of expressions: for start values, and as an oracle that shares nothing with the generated C."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from dse.errors import fail
from dse.modelica.algebra.arithmetic import FUNCTIONS
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Symbol
from dse.modelica.algebra.traversal import walk

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from scipy.interpolate import PPoly

Values = Mapping[Symbol, float] | Callable[[Symbol], float]


def evaluate(expressions: Iterable[Expression], values: Values) -> list[float]:
    """Value of each of *expressions* where symbols have *values*.

    IEEE doubles: NaN outside a domain (of an operator, a ``select`` or a table that refuses to extrapolate), infinite
    at a pole. Raises what *values* raises for an unknown symbol; DseError for a table whose axis does not increase.
    """
    of = values.__getitem__ if isinstance(values, Mapping) else values
    roots = list(expressions)
    done: dict[int, float] = {}
    for node in walk(roots):
        if node.symbol is not None:
            done[node.number] = float(of(node.symbol))
        elif node.is_constant:
            done[node.number] = node.value
        elif node.operator == "select":
            done[node.number] = _selected(node, done)
        elif node.operator == "call":
            done[node.number] = _called(node, done)
        elif node.operator != "array":
            done[node.number] = FUNCTIONS[node.operator](*(done[operand.number] for operand in node.operands))
    return [done[root.number] for root in roots]


def _selected(node: Expression, done: Mapping[int, float]) -> float:
    array, *indices = node.operands
    place = 0
    for index, size in zip(indices, array.shape, strict=True):
        value = done[index.number]
        if not (1 <= value <= size and value.is_integer()):
            return math.nan
        place = place * size + int(value) - 1
    return done[array.operands[place].number]


def _called(node: Expression, done: Mapping[int, float]) -> float:
    def scalar(place: int) -> float:
        return done[node.operands[place].number]

    def elements(place: int) -> list[float]:
        return [done[element.number] for element in node.operands[place].operands]

    if node.name == "random":
        return _random(int(scalar(0)), elements(2))
    if node.name == "random_start":
        return _random_start(int(scalar(0)), elements(1))
    count = {"table1": 1, "table2": 2}.get(node.name)
    if count is None:
        raise fail(f"'{node.name}' cannot be evaluated")
    orders, point = [int(scalar(k)) for k in range(count)], [scalar(count + k) for k in range(count)]
    axes, points = [elements(2 * count + k) for k in range(count)], elements(3 * count)
    for axis in axes:
        if len(axis) < 2 or any(not a < b for a, b in pairwise(axis)):
            raise fail(f"a table needs at least two points on a strictly increasing axis, not {axis}")
    is_smooth, extrapolation = scalar(3 * count + 1) != 0, scalar(3 * count + 2)
    if extrapolation not in range(HOLD, ERROR + 1):
        raise fail(f"a table's extrapolation is 1, 2 or 3, not {extrapolation:g}")
    if not all(map(math.isfinite, points)):
        return math.nan
    return table(orders, point, axes, points, is_smooth, int(extrapolation))


# Tables, as the C runtime computes them.

HOLD, LINEAR, ERROR = 1, 2, 3
"""Outside of a table: its end value; on with the slope at the end; an error (NaN here)."""


def table(
    orders: Sequence[int],
    point: Sequence[float],
    axes: Sequence[Sequence[float]],
    points: Sequence[float],
    is_smooth: bool,
    extrapolation: int,
) -> float:
    """Value or partial derivative (*orders* up to 2) at *point* of the table of *points*, row by row, over *axes*.

    Smooth over one axis: monotone cubic Hermite (Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5(2), 1984, 300-304);
    over several: cubic Hermite along each with three-point parabolic slopes. Two points are joined by a line.
    """
    from scipy.interpolate import CubicHermiteSpline, PchipInterpolator, PPoly

    for x, xs in zip(point, axes, strict=True):
        if math.isnan(x) or (extrapolation == ERROR and not xs[0] <= x <= xs[-1]):
            return math.nan
    values = np.reshape(points, [len(xs) for xs in axes])
    for order, x, xs in zip(orders, point, axes, strict=True):
        curve: PPoly
        if not is_smooth or len(xs) == 2:
            curve = PPoly(np.stack([(np.diff(values.T) / np.diff(xs)).T, values[:-1]]), xs)
        elif len(axes) == 1:
            curve = PchipInterpolator(xs, values)
        else:
            curve = CubicHermiteSpline(xs, values, np.gradient(values, xs, axis=0, edge_order=2))
        values = _extended(curve, order, x, xs, extrapolation)
    return float(values)


def _extended(curve: PPoly, order: int, x: float, xs: Sequence[float], extrapolation: int) -> NDArray[np.float64]:
    end = min(max(x, xs[0]), xs[-1])
    if x == end:
        return curve(x, order)
    if extrapolation == HOLD:
        return curve(end) if order == 0 else 0.0 * curve(end)
    slope = curve(end, 1)
    return (curve(end) + slope * (x - end), slope, 0.0 * slope)[order]


# Random numbers by xorshift generators (S. Vigna, ACM Trans. Math. Softw. 42(4), 2016), as the C runtime computes them.
# Two whole numbers of 32 bits are a word, the lower half first. 2 numbers: xorshift64*, whose next state is the
# product; 4: xorshift128+; 33: xorshift1024*, the last of which is the place.

_ALL, _HALF = 2**64 - 1, 2**32 - 1
_TURNS = 10


def _random(which: int, state: Sequence[float]) -> float:
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


def _random_start(which: int, seeds: Sequence[float]) -> float:
    """Number *which* of the state that two *seeds*, local and global, begin: of 33 numbers as of 4."""
    local, around = (int(seed) & _HALF for seed in seeds)
    word = local | around << 32 or 126247697
    for _ in range(_TURNS + (which - 1) // 2):
        word = _next(word)
    return float(_element([word], (which - 1) % 2 + 1))


def _next(word: int) -> int:
    word ^= word >> 12
    word ^= word << 25 & _ALL
    word ^= word >> 27
    return word * 2685821657736338717 & _ALL


def _element(words: Sequence[int], which: int) -> int:
    return _signed(words[(which - 1) // 2] >> (which - 1) % 2 * 32 & _HALF, 32)


def _signed(number: int, bits: int) -> int:
    return number - (1 << bits) if number >> (bits - 1) else number
