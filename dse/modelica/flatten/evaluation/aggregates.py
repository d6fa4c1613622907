"""Rules for arrays and records: building them, taking parts, replacing parts."""

from __future__ import annotations

import itertools
from collections.abc import Generator, Mapping, Sequence

import numpy as np

from dse.errors import Location
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.flatten.document import Subscript, check_counters, points, shape
from dse.modelica.flatten.evaluation.context import Frame, Request, Rule, Steps, Visit, requested
from dse.modelica.flatten.values import (
    Array,
    MismatchError,
    Structure,
    Value,
    array,
    only,
    places,
    scalar,
    stacked,
    whole,
)


def _array(visit: Visit) -> Steps:
    values = yield from requested(visit.frame, visit.node.operands)
    if not values:
        return Array((), (0,))
    return stacked(values)


def _record(visit: Visit) -> Steps:
    values = yield from requested(visit.frame, visit.node.operands)
    return Structure(tuple(values))


def _field(visit: Visit) -> Steps:
    base = yield visit.request(visit.node.data["base"])
    if not isinstance(base, Structure) or not 0 <= visit.node.data["field"] < len(base.fields):
        raise MismatchError("a field of what is not a single record")
    place: int = visit.node.data["field"]
    return base.fields[place]


def _range(visit: Visit) -> Steps:
    data = visit.node.data
    first = whole((yield visit.request(data["start_expression"])))
    step = 1
    if data["explicit_step_expression"] is not None:
        step = whole((yield visit.request(data["explicit_step_expression"])))
    last = whole((yield visit.request(data["stop_expression"])))
    if step == 0:
        raise MismatchError("a range of step 0")
    numbers = range(first, last + (1 if step > 0 else -1), step)
    return Array(tuple(visit.graph.constant(float(item)) for item in numbers), (len(numbers),))


def _comprehension(visit: Visit) -> Steps:
    domain = visit.node.data["domain"]
    check_counters(visit.document, domain, visit.frame.function)
    values: list[Value] = []
    for point in points(visit.document, domain):
        value = yield Request(visit.frame.turn(domain, point), visit.node.data["body"])
        values.append(value)
    sizes = shape(visit.document, domain)
    if not values:
        return Array((), sizes)
    found = array(stacked(values))
    return Array(found.elements, sizes + found.shape[1:])


def _index(visit: Visit) -> Steps:
    base = array((yield visit.request(visit.node.data["base"])))
    subscripts = yield from _subscripts(visit, base)
    numbers = base.numbers
    every = itertools.product(*(one.elements for one in subscripts))
    return Array(tuple(_element(visit.graph, base, numbers, index) for index in every), _shape(subscripts))


def _update(visit: Visit) -> Steps:
    base = array((yield visit.request(visit.node.data["base"])))
    subscripts = yield from _subscripts(visit, base)
    value = array((yield visit.request(visit.node.data["value"])))
    return updated(visit.graph, base, subscripts, value, visit.frame, visit.where)


def _subscripts(visit: Visit, base: Array) -> Generator[Request, Value, list[Array]]:
    """A scalar drops its dimension of *base*, a vector keeps it; missing ones mean everything."""
    missing = len(base.shape) - len(visit.node.subscripts)
    if missing < 0:
        raise MismatchError("more subscripts than dimensions")
    found: list[Array] = []
    for subscript, size in zip((*visit.node.subscripts, *[Subscript("whole")] * missing), base.shape, strict=True):
        if subscript.kind == "whole":
            found.append(Array(tuple(visit.graph.constant(k) for k in range(1, size + 1)), (size,)))
            continue
        value = array((yield visit.request(subscript.node)))
        if subscript.kind == "index":
            found.append(scalar(only(value)))
        elif len(value.shape) == 1:
            found.append(value)
        else:
            raise MismatchError("a slice by what is not a vector")
    return found


def _shape(subscripts: Sequence[Array]) -> tuple[int, ...]:
    return tuple(size for one in subscripts for size in one.shape)


def _element(graph: Graph, base: Array, numbers: np.ndarray, index: Sequence[Expression]) -> Expression:
    """One element of *base*, whose elements have *numbers* in its shape.

    An index only known at run time becomes a ``select`` over what the known ones leave.
    """
    known = [known_index(item, size) for item, size in zip(index, base.shape, strict=True)]
    left = numbers[tuple(slice(None) if at is None else at - 1 for at in known)]
    unknown = [item for item, at in zip(index, known, strict=True) if at is None]
    elements = [base.elements[number] for number in left.flat]
    return graph.make("select", graph.array(elements, left.shape), *unknown) if unknown else elements[0]


RULES: Mapping[str, Rule] = {
    "array": _array,
    "record": _record,
    "field": _field,
    "range": _range,
    "comprehension": _comprehension,
    "index": _index,
    "array_update": _update,
}
"""Rules by kind of node."""


# Assignment to elements of an array inside a function.


def updated(
    graph: Graph, base: Array, subscripts: Sequence[Array], value: Array, frame: Frame, where: Location | None
) -> Array:
    """*base* with ``base[subscripts] := value``. An index only known at run time gives a choice for every element.

    Such an index outside the array fails the run, by an assertion of *frame*. Raises MismatchError for other sizes.
    """
    if _shape(subscripts) != value.shape:
        raise MismatchError("an assignment to array elements of another size")
    elements, numbers = list(base.elements), base.numbers
    for element, index in zip(value.elements, itertools.product(*(one.elements for one in subscripts)), strict=True):
        known = [known_index(item, size) for item, size in zip(index, base.shape, strict=True)]
        for item, size, found in zip(index, base.shape, known, strict=True):
            if found is None:
                at_most = graph.make("less_equal", item, graph.of(float(size)))
                inside = graph.make("and", graph.make("greater_equal", item, graph.of(1.0)), at_most)
                frame.demand(inside, "an index outside its array", where)
        for place in places([1 if found else size for found, size in zip(known, base.shape, strict=True)]):
            exact = [found or at for found, at in zip(known, place, strict=True)]
            condition = graph.constant(1.0)
            for item, at, found in zip(index, exact, known, strict=True):
                if found is None:
                    condition = graph.make("and", condition, graph.make("equal", item, graph.of(float(at))))
            spot = numbers[tuple(at - 1 for at in exact)]
            elements[spot] = graph.make("if", condition, element, elements[spot])
    return Array(tuple(elements), base.shape)


def known_index(index: Expression, size: int) -> int | None:
    """*index* if it is a number. Raises MismatchError unless it lies in 1 .. *size*."""
    if not index.is_constant:
        return None
    if not index.value.is_integer() or not 1 <= index.value <= size:
        raise MismatchError(f"index {index.value:g} of a dimension of size {size}")
    return int(index.value)
