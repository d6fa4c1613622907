"""Values while a model is flattened: arrays of scalar expressions, records, strings."""

from __future__ import annotations

import itertools
import math
import operator
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np

from dse.modelica.algebra.expression import Expression, Graph


@dataclass(frozen=True, slots=True)
class Array:
    """*elements* row by row; a scalar has *shape* () and one element."""

    elements: tuple[Expression, ...]
    shape: tuple[int, ...] = ()

    @property
    def numbers(self) -> np.ndarray:
        """The elements' numbers from 0, in its shape."""
        return np.arange(len(self.elements)).reshape(self.shape)

    @property
    def cells(self) -> np.ndarray:
        """The elements as a new array of numpy's."""
        found = np.empty(len(self.elements), object)
        found[:] = self.elements
        return found.reshape(self.shape)


@dataclass(frozen=True, slots=True)
class Structure:
    """A record's fields, in order."""

    fields: tuple[Value, ...]


@dataclass(frozen=True, slots=True)
class Text:
    """A string; known while the model is built."""

    text: str


Value = Array | Structure | Text


class MismatchError(Exception):
    """Operands do not fit; its text says why. Turned into a problem with a place by whoever knows the place."""


def scalar(expression: Expression) -> Array:
    """*expression* as a value."""
    return Array((expression,))


def of_cells(cells: np.ndarray) -> Array:
    """The expressions *cells* as a value."""
    return Array(tuple(cells.flat), cells.shape)


def only(value: Value) -> Expression:
    """The one expression of a scalar. Raises MismatchError for anything else."""
    if isinstance(value, Array) and value.shape == ():
        return value.elements[0]
    raise MismatchError("a scalar is needed here")


def array(value: Value) -> Array:
    """*value*, which must be a number or an array of numbers."""
    if isinstance(value, Array):
        return value
    raise MismatchError("a number is needed here")


def whole(value: Value) -> int:
    """The whole number that *value* is while the model is built."""
    found = only(value)
    if not found.is_constant or not found.value.is_integer():
        raise MismatchError("a whole number known while the model is built is needed here")
    return int(found.value)


def places(shape: Sequence[int]) -> Iterator[tuple[int, ...]]:
    """All index tuples from 1, row by row."""
    return itertools.product(*(range(1, size + 1) for size in shape))


def mapped(value: Array, function: Callable[[Expression], Expression]) -> Array:
    """*function* of each element."""
    return Array(tuple(function(element) for element in value.elements), value.shape)


def broadcast(left: Array, right: Array, function: Callable[[Expression, Expression], Expression]) -> Array:
    """*function* element by element; a scalar goes with every element."""
    if left.shape == right.shape:
        shape, pairs = left.shape, list(zip(left.elements, right.elements, strict=True))
    elif left.shape == ():
        shape, pairs = right.shape, [(left.elements[0], element) for element in right.elements]
    elif right.shape == ():
        shape, pairs = left.shape, [(element, right.elements[0]) for element in left.elements]
    else:
        raise MismatchError(f"sizes {list(left.shape)} and {list(right.shape)} do not fit")
    return Array(tuple(function(a, b) for a, b in pairs), shape)


def stacked(values: Sequence[Value]) -> Value:
    """An array whose first dimension counts *values*, all of one shape."""
    arrays = [array(value) for value in values]
    shapes = {value.shape for value in arrays}
    if len(shapes) != 1:
        raise MismatchError("an array's elements must have one size")
    return Array(tuple(element for value in arrays for element in value.elements), (len(arrays), *shapes.pop()))


def total(graph: Graph, elements: Sequence[Expression]) -> Expression:
    """Sum from left to right; 0 of nothing."""
    return reduce(operator.add, elements) if elements else graph.constant(0.0)


def product(graph: Graph, elements: Sequence[Expression]) -> Expression:
    """Product from left to right; 1 of nothing."""
    return reduce(operator.mul, elements) if elements else graph.constant(1.0)


def multiplied(graph: Graph, left: Array, right: Array) -> Array:
    """Modelica's ``*``: with a scalar by element, else the product of vectors and matrices (Modelica 3.6, 10.6.5)."""
    if left.shape == () or right.shape == ():
        return broadcast(left, right, lambda a, b: a * b)
    if len(left.shape) > 2 or len(right.shape) > 2 or left.shape[-1] != right.shape[0]:
        raise MismatchError(f"a product of sizes {list(left.shape)} and {list(right.shape)}")
    inner, outer = right.shape[0], (*left.shape[:-1], *right.shape[1:])
    rows = left.cells.reshape(math.prod(left.shape[:-1]), inner)
    columns = right.cells.reshape(inner, math.prod(right.shape[1:])).T
    return Array(tuple(total(graph, list(row * column)) for row in rows for column in columns), outer)


def concatenated(dimension: int, values: Sequence[Array]) -> Array:
    """``cat(dimension, ...)``, the dimension counted from 1; all of one rank."""
    if dimension < 1:
        raise MismatchError(f"a concatenation along dimension {dimension}")
    try:
        return of_cells(np.concatenate([value.cells for value in values], dimension - 1))
    except ValueError:
        raise MismatchError("a concatenation of arrays of different rank or size") from None
