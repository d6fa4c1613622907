"""External functions that the runtime knows: tables and random numbers. A string's hash is known while building."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Mapping
from functools import partial

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


def _table(model: Model, values: list[Array], count: int) -> Expression:
    """A table over *count* axes: of (x, y …, xs, size, ys, size …, values, smooth, extrapolation)."""
    if len(values) != 3 * count + 3:
        raise MismatchError(f"dse_table{count} of other than {3 * count + 3} arguments")
    *_, table, smooth, extrapolation = values
    axes, sizes = values[count : 3 * count : 2], values[count + 1 : 3 * count : 2]
    if table.shape != tuple(_axis(model, axis, size) for axis, size in zip(axes, sizes, strict=True)):
        raise MismatchError(f"dse_table{count} with other than one value a point")
    graph = model.graph
    _check_fixed(model, table, "data change")
    data = [graph.array(item.elements, item.shape) for item in (*axes, table)]
    for choice in (smooth, extrapolation):
        _check_fixed(model, choice, "interpolation changes")
    orders, point = [graph.constant(0.0)] * count, map(only, values[:count])
    return graph.call(f"table{count}", [*orders, *point, *data, only(smooth), only(extrapolation)])


def _axis(model: Model, axis: Array, size: Array) -> int:
    if len(axis.shape) != 1 or whole(size) != len(axis.elements) or len(axis.elements) < 2:
        raise MismatchError("a table's axis of fewer than two points, or with another size")
    _check_fixed(model, axis, "data change")
    numbers = [item.value for item in axis.elements if item.is_constant]
    if len(numbers) == len(axis.elements) and any(b <= a for a, b in itertools.pairwise(numbers)):
        raise MismatchError("a table's axis that does not increase")
    return len(axis.elements)


def _check_fixed(model: Model, data: Array, what: str) -> None:
    if not all(map(model.is_parameter, data.elements)):
        raise MismatchError(f"a table whose {what} while the model runs")


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


_FUNCTIONS: Mapping[str, Callable[[Model, list[Array]], Expression]] = {
    "dse_table1": partial(_table, count=1),
    "dse_table2": partial(_table, count=2),
    "dse_random": _random,
    "dse_random_start": _random_start,
}


def _hashed(text: str) -> int:
    """A whole number of 32 bits from *text*, by A. Partow's hash function."""
    found = 0xAAAAAAAA
    for place, byte in enumerate(text.encode()):
        if place % 2:
            found ^= ~((found << 11) + (byte ^ found >> 5)) & 0xFFFFFFFF
        else:
            found ^= (found << 7 ^ byte * (found >> 3)) & 0xFFFFFFFF
    return found - (found >> 31 << 32)
