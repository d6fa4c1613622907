"""Modelica's built-in functions over values. Those that make events or change the frame are in `evaluation`."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from functools import reduce
from typing import NamedTuple

from dse.modelica.algebra.expression import COMPARISONS, Expression, Graph
from dse.modelica.flatten.values import (
    Array,
    MismatchError,
    Value,
    array,
    broadcast,
    concatenated,
    mapped,
    multiplied,
    of_cells,
    only,
    places,
    product,
    scalar,
    total,
    whole,
)


class Given(NamedTuple):
    """What a built-in function is given: its arguments, and the graph to answer in."""

    graph: Graph
    values: Sequence[Value]


Function = Callable[[Given], Value]

_EACH = ["abs", "sqrt", "sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh", "exp", "log", "log10"]
_BINARY = {
    "add": "add",
    "subtract": "subtract",
    "elementwise_add": "add",
    "elementwise_subtract": "subtract",
    "elementwise_multiply": "multiply",
    "elementwise_divide": "divide",
    "elementwise_power": "power",
}


def binary(graph: Graph, operator: str, left: Array, right: Array) -> Array:
    """``left operator right`` (Modelica 3.6, 10.6). Raises MismatchError for sizes that do not fit, KeyError else."""
    if operator == "multiply":
        return multiplied(graph, left, right)
    if operator == "divide":
        if right.shape != ():
            raise MismatchError("a division by an array")
        return broadcast(left, right, lambda a, b: a / b)
    if operator in ("add", "subtract") and left.shape != right.shape:
        raise MismatchError(f"sizes {list(left.shape)} and {list(right.shape)} do not fit")
    if operator in _BINARY:
        return broadcast(left, right, lambda a, b: graph.make(_BINARY[operator], a, b))
    if operator in ("and", "or"):
        return broadcast(left, right, lambda a, b: graph.make(operator, a, b))
    if operator not in COMPARISONS | {"power"}:
        raise KeyError(operator)
    if left.shape or right.shape:
        raise MismatchError(f"'{operator}' over arrays")
    return scalar(graph.make(operator, left.elements[0], right.elements[0]))


def _elementwise(operator: str) -> Function:
    def function(given: Given) -> Value:
        (value,) = given.values
        return mapped(array(value), lambda element: given.graph.make(operator, element))

    return function


def _atan2(given: Given) -> Value:
    left, right = given.values
    return broadcast(array(left), array(right), lambda a, b: given.graph.make("atan2", a, b))


def _extreme(operator: str) -> Function:
    def function(given: Given) -> Value:
        if len(given.values) == 1:
            elements = _elements(given)
        else:
            left, right = given.values
            elements = (only(left), only(right))
        if not elements:
            raise MismatchError("the least or greatest of nothing")
        return scalar(reduce(lambda one, other: given.graph.make(operator, one, other), elements))

    return function


def _elements(given: Given) -> Sequence[Expression]:
    (value,) = given.values
    return array(value).elements


def _size(given: Given) -> Value:
    shape = array(given.values[0]).shape
    if len(given.values) == 1:
        return Array(tuple(given.graph.constant(size) for size in shape), (len(shape),))
    dimension = whole(given.values[1])
    if len(given.values) != 2 or not 1 <= dimension <= len(shape):
        raise MismatchError(f"the size of dimension {dimension}")
    return scalar(given.graph.constant(shape[dimension - 1]))


def _filled(value: Expression, sizes: Sequence[Value]) -> Value:
    shape = tuple(whole(size) for size in sizes)
    if any(size < 0 for size in shape):
        raise MismatchError("an array of negative size")
    return Array((value,) * math.prod(shape), shape)


def _linspace(given: Given) -> Value:
    first, last, count = only(given.values[0]), only(given.values[1]), whole(given.values[2])
    if len(given.values) != 3 or count < 2:
        raise MismatchError("linspace of fewer than two points")
    width = last - first
    inner = [first + width * float(k) / float(count - 1) for k in range(1, count - 1)]
    return Array((first, *inner, last), (count,))


def _identity(given: Given) -> Value:
    (size,) = (whole(value) for value in given.values)
    one, zero = given.graph.constant(1.0), given.graph.constant(0.0)
    return Array(tuple(one if i == j else zero for i, j in places((size, size))), (size, size))


def _diagonal(given: Given) -> Value:
    vector = _vector_of(given.values, None)
    size, zero = len(vector), given.graph.constant(0.0)
    return Array(tuple(vector[i - 1] if i == j else zero for i, j in places((size, size))), (size, size))


def _transpose(given: Given) -> Value:
    (matrix,) = (array(value) for value in given.values)
    if len(matrix.shape) < 2:
        raise MismatchError("the transpose of what is not a matrix")
    return of_cells(matrix.cells.swapaxes(0, 1))


def _vector(given: Given) -> Value:
    (value,) = (array(value) for value in given.values)
    if sum(1 for size in value.shape if size > 1) > 1:
        raise MismatchError("a vector of what has two dimensions")
    return Array(value.elements, (len(value.elements),))


def _cross(given: Given) -> Value:
    left, right = given.values
    a, b = _vector_of((left,), 3), _vector_of((right,), 3)
    return Array((a[1] * b[2] - b[1] * a[2], a[2] * b[0] - b[2] * a[0], a[0] * b[1] - b[0] * a[1]), (3,))


def _skew(given: Given) -> Value:
    x, y, z = _vector_of(given.values, 3)
    zero = given.graph.constant(0.0)
    return Array((zero, -z, y, z, zero, -x, -y, x, zero), (3, 3))


def _outer_product(given: Given) -> Value:
    left, right = given.values
    a, b = _vector_of((left,), None), _vector_of((right,), None)
    return Array(tuple(x * y for x in a for y in b), (len(a), len(b)))


def _vector_of(values: Sequence[Value], size: int | None) -> tuple[Expression, ...]:
    (value,) = (array(value) for value in values)
    if len(value.shape) != 1 or size not in (None, len(value.elements)):
        raise MismatchError(f"a vector{'' if size is None else f' of {size}'} is needed here")
    return value.elements


def _cat(given: Given) -> Value:
    dimension, *arrays = given.values
    return concatenated(whole(dimension), [array(value) for value in arrays])


def _bracketed(dimension: int) -> Function:
    """``[a, b; c, d]``: rows are concatenated along 2, then along 1; everything is a matrix at least."""

    def function(given: Given) -> Value:
        arrays = [array(value) for value in given.values]
        rank = max(2, *(len(value.shape) for value in arrays))
        return concatenated(
            dimension, [Array(value.elements, value.shape + (1,) * (rank - len(value.shape))) for value in arrays]
        )

    return function


# fmt: off
BUILTINS: Mapping[str, Function] = {
    **{name: _elementwise(name) for name in _EACH}, "atan2": _atan2, "min": _extreme("minimum"),
    "max": _extreme("maximum"), "sum": lambda given: scalar(total(given.graph, _elements(given))),
    "product": lambda given: scalar(product(given.graph, _elements(given))), "size": _size,
    "zeros": lambda given: _filled(given.graph.constant(0.0), given.values),
    "ones": lambda given: _filled(given.graph.constant(1.0), given.values),
    "fill": lambda given: _filled(only(given.values[0]), given.values[1:]), "linspace": _linspace,
    "identity": _identity, "diagonal": _diagonal, "transpose": _transpose, "vector": _vector, "cross": _cross,
    "skew": _skew, "outer_product": _outer_product, "cat": _cat, "promoted_cat1": _bracketed(1),
    "promoted_cat2": _bracketed(2)
}
# fmt: on
"""Functions that need nothing but their arguments' values."""
