"""External functions: the two table look-ups that the runtime knows; nothing else."""

from __future__ import annotations

import itertools
from collections.abc import Generator

from dse.modelica.algebra.expression import Expression
from dse.modelica.flatten.document import Document, Record, fields, single
from dse.modelica.flatten.evaluation.context import Frame, Request
from dse.modelica.flatten.model import Model
from dse.modelica.flatten.values import Array, MismatchError, Value, array, only, scalar, whole

_HINT = "external functions other than dse_table1 and dse_table2 cannot be translated; write it in Modelica"


def called(
    document: Document, model: Model, frame: Frame, function: Record, number: int
) -> Generator[Request, Value, tuple[Value, ...]]:
    """The output of the external *function* whose arguments *frame* has."""
    external = function["external"]
    where = document.where(function.get("declaration")) or document.at(number)
    fields(external, "purity language symbol arguments result linkage", f"the function '{function['name']}'", where)
    symbol = external["symbol"]
    if symbol not in ("dse_table1", "dse_table2") or external["language"].lower() != "c":
        raise document.refused(f"the external function '{symbol}'", number, _HINT)
    if external["result"] != 0 or len(function["outputs"]) != 1 or function["statements"]:
        raise document.refused(f"the external function '{symbol}' in this form", number, _HINT)
    values = []
    for argument in external["arguments"]:
        kind, node = single(argument, "an argument of an external function", where)
        if kind != "input":
            raise document.refused(f"an argument of kind '{kind}' of '{symbol}'", number)
        values.append(array((yield Request(frame, node))))
    made = _table1(model, values) if symbol == "dse_table1" else _table2(model, values)
    return (scalar(made),)


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
