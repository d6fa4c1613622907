"""External functions that the runtime knows: tables and random numbers. A string's hash is known while building."""

from __future__ import annotations

import itertools
from collections.abc import Generator

from dse.modelica.algebra.expression import Expression
from dse.modelica.flatten.document import Document, Record, fields, single
from dse.modelica.flatten.evaluation.context import Frame, Request
from dse.modelica.flatten.model import Model
from dse.modelica.flatten.values import Array, MismatchError, Text, Value, array, only, scalar, whole

_HINT = "external functions other than tables and random numbers cannot be translated; write it in Modelica"
_HASH = "ModelicaStrings_hashString"


def called(
    document: Document, model: Model, frame: Frame, function: Record, number: int
) -> Generator[Request, Value, tuple[Value, ...]]:
    """The output of the external *function* whose arguments *frame* has."""
    external = function["external"]
    where = document.where(function.get("declaration")) or document.at(number)
    fields(external, "purity language symbol arguments result linkage", f"the function '{function['name']}'", where)
    symbol = external["symbol"]
    if symbol not in (*_FUNCTIONS, _HASH) or external["language"].lower() != "c":
        raise document.refused(f"the external function '{symbol}'", number, _HINT)
    if external["result"] != 0 or len(function["outputs"]) != 1 or function["statements"]:
        raise document.refused(f"the external function '{symbol}' in this form", number, _HINT)
    values = []
    for argument in external["arguments"]:
        kind, node = single(argument, "an argument of an external function", where)
        if kind != "input":
            raise document.refused(f"an argument of kind '{kind}' of '{symbol}'", number)
        values.append((yield Request(frame, node)))
    if symbol == _HASH and len(values) == 1 and isinstance(values[0], Text):
        return (scalar(model.graph.of(float(_hashed(values[0].text)))),)
    return (scalar(_FUNCTIONS[symbol](model, list(map(array, values)))),)


def _table1(model: Model, values: list[Array]) -> Expression:
    if len(values) != 6:
        raise MismatchError("dse_table1 of other than (x, xs, size, ys, smooth, extrapolation)")
    x, xs, size, ys, smooth, extrapolation = values
    points = _axis(model, xs, size)
    if ys.shape != (points,):
        raise MismatchError("dse_table1 with other than one value a point")
    graph = model.graph
    data = [graph.array(item.elements, item.shape) for item in (xs, ys)]
    _check_data(model, ys)
    choices = [_choice(model, item) for item in (smooth, extrapolation)]
    return graph.call("table1", [graph.constant(0.0), only(x), *data, *choices])


def _table2(model: Model, values: list[Array]) -> Expression:
    if len(values) != 9:
        raise MismatchError("dse_table2 of other than (x, y, xs, size, ys, size, zs, smooth, extrapolation)")
    x, y, xs, rows, ys, columns, zs, smooth, extrapolation = values
    if zs.shape != (_axis(model, xs, rows), _axis(model, ys, columns)):
        raise MismatchError("dse_table2 with other than one row for each x and one column for each y")
    graph = model.graph
    _check_data(model, zs)
    data = [graph.array(item.elements, item.shape) for item in (xs, ys, zs)]
    choices = [_choice(model, item) for item in (smooth, extrapolation)]
    zero = graph.constant(0.0)
    return graph.call("table2", [zero, zero, only(x), only(y), *data, *choices])


def _axis(model: Model, axis: Array, size: Array) -> int:
    if len(axis.shape) != 1 or whole(size) != len(axis.elements) or len(axis.elements) < 2:
        raise MismatchError("a table's axis of fewer than two points, or with another size")
    _check_data(model, axis)
    numbers = [item.value for item in axis.elements if item.is_constant]
    if len(numbers) == len(axis.elements) and any(b <= a for a, b in itertools.pairwise(numbers)):
        raise MismatchError("a table's axis that does not increase")
    return len(axis.elements)


def _check_data(model: Model, data: Array) -> None:
    if not all(model.is_parameter(element) for element in data.elements):
        raise MismatchError("a table whose data change while the model runs")


def _choice(model: Model, value: Array) -> Expression:
    found = only(value)
    if not model.is_parameter(found):
        raise MismatchError("a table whose interpolation changes while the model runs")
    return found


def _random(model: Model, values: list[Array]) -> Expression:
    """A number, or one of the next state, of (state, size, which)."""
    state, size, which = values
    if len(state.elements) not in (2, 4, 33) or whole(size) != len(state.elements):
        raise MismatchError("random numbers from a state of other than 2, 4 or 33 whole numbers")
    graph = model.graph
    return graph.call("random", [only(which), only(size), graph.array(state.elements, state.shape)])


def _random_start(model: Model, values: list[Array]) -> Expression:
    """A number of the state that (local seed, global seed, which) begin."""
    *seeds, which = map(only, values)
    return model.graph.call("random_start", [which, model.graph.array(seeds, (2,))])


_FUNCTIONS = {"dse_table1": _table1, "dse_table2": _table2, "dse_random": _random, "dse_random_start": _random_start}


def _hashed(text: str) -> int:
    """A whole number of 32 bits from *text*, by A. Partow's hash function."""
    found = 0xAAAAAAAA
    for place, byte in enumerate(text.encode()):
        if place % 2:
            found ^= ~((found << 11) + (byte ^ found >> 5)) & 0xFFFFFFFF
        else:
            found ^= (found << 7 ^ byte * (found >> 3)) & 0xFFFFFFFF
    return found - (found >> 31 << 32)
