"""Functions that jump (Modelica 3.6, 3.7.2): held between events, and the events that change them.

``floor(x)`` becomes a discrete variable f with the event-making relations x < f and x >= f + 1, so that it is
constant while time goes on and the jump is located like every other event. The rest is made of it.
"""

from __future__ import annotations

from dse.errors import Location
from dse.modelica.algebra.expression import Expression
from dse.modelica.flat_model import Assignment, ScalarType
from dse.modelica.flatten.model import Model

ROUNDINGS = frozenset({"floor", "ceil", "integer"})
QUOTIENTS = frozenset({"div", "mod", "rem"})


def sign(model: Model, value: Expression, is_held: bool, where: Location | None) -> Expression:
    """-1, 0 or 1."""
    if not is_held or model.is_discrete(value):
        return model.graph.make("sign", value)
    graph, zero = model.graph, model.graph.constant(0.0)
    is_positive = model.held(graph.make("greater", value, zero), where)
    is_negative = model.held(graph.make("less", value, zero), where)
    return graph.make("if", is_positive, graph.of(1.0), graph.make("if", is_negative, graph.of(-1.0), zero))


def rounded(model: Model, function: str, value: Expression, is_held: bool, where: Location | None) -> Expression:
    """``floor``, ``ceil`` or ``integer`` (which is floor) of *value*."""
    operator = "ceil" if function == "ceil" else "floor"
    return _held(model, operator, value, where) if is_held else model.graph.make(operator, value)


def quotient(
    model: Model, function: str, left: Expression, right: Expression, is_held: bool, where: Location | None
) -> Expression:
    """``div`` (rounded to zero), ``mod`` (of the floor) or ``rem`` (of div) of *left* and *right* (Modelica 3.7.2)."""
    ratio = left / right
    kind = "floor" if function == "mod" else "truncate"
    whole = _held(model, kind, ratio, where) if is_held else _direct(kind, ratio)
    return whole if function == "div" else left - whole * right


def _direct(kind: str, value: Expression) -> Expression:
    graph = value.graph
    if kind != "truncate":
        return graph.make(kind, value)
    is_negative = graph.make("less", value, graph.constant(0.0))
    return graph.make("if", is_negative, graph.make("ceil", value), graph.make("floor", value))


def _held(model: Model, kind: str, value: Expression, where: Location | None) -> Expression:
    if model.is_discrete(value):
        return _direct(kind, value)
    name = model.rounded.get((kind, value))
    graph = model.graph
    if name is None:
        name = model.rounded[kind, value] = model.internal(kind, ScalarType.REAL, where)
        kept = graph.variable(name)
        model.assignments.append(Assignment(name, _direct(kind, value), None, where))
        bounds = {
            "floor": (("less", kept), ("greater_equal", kept + 1.0)),
            "ceil": (("greater", kept), ("less_equal", kept - 1.0)),
            "truncate": (("less", kept), ("less_equal", kept - 1.0), ("greater", kept), ("greater_equal", kept + 1.0)),
        }[kind]
        for operator, bound in bounds:
            model.held(graph.make(operator, value, bound), where)
    return graph.variable(name)
