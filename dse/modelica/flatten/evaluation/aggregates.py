"""Rules for arrays and records: building them, taking parts, replacing parts."""

from __future__ import annotations

from collections.abc import Generator, Mapping, Sequence

from dse.modelica.algebra.expression import Expression
from dse.modelica.flatten.document import check_counters, points, shape
from dse.modelica.flatten.evaluation.context import Request, Rule, Steps, Visit, requested
from dse.modelica.flatten.evaluation.indexing import indexed, updated
from dse.modelica.flatten.values import Array, MismatchError, Structure, Value, array, only, stacked, whole


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
    return indexed(visit.graph, base, subscripts)


def _update(visit: Visit) -> Steps:
    base = array((yield visit.request(visit.node.data["base"])))
    subscripts = yield from _subscripts(visit, base)
    value = array((yield visit.request(visit.node.data["value"])))
    return updated(visit.graph, base, subscripts, value, visit.frame, visit.where)


def _subscripts(visit: Visit, base: Array) -> Generator[Request, Value, Sequence[Sequence[Expression] | Expression]]:
    if len(visit.node.subscripts) > len(base.shape):
        raise MismatchError("more subscripts than dimensions")
    found: list[Sequence[Expression] | Expression] = []
    for subscript, size in zip(visit.node.subscripts, base.shape, strict=False):
        if subscript.kind == "whole":
            found.append([visit.graph.constant(float(k)) for k in range(1, size + 1)])
            continue
        value = array((yield visit.request(subscript.node)))
        if subscript.kind == "index":
            found.append(only(value))
        elif len(value.shape) == 1:
            found.append(value.elements)
        else:
            raise MismatchError("a slice by what is not a vector")
    return found


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
