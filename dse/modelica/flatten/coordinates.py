"""References to variables and conditions."""

from __future__ import annotations

from dse.modelica.algebra.expression import Expression, Place, Symbol, shown as shown_expression
from dse.modelica.flatten.document import Document, single
from dse.modelica.flatten.model import Model
from dse.modelica.flatten.values import Array, Text, Value, array

_CURRENT = frozenset({"parameter", "state", "algebraic", "output", "input", "discrete_real", "discrete_value"})
_BEFORE = frozenset({"pre_discrete_real", "pre_discrete_value", "pre_state"})


def variable(document: Document, model: Model, kind: str, index: int, number: int, makes_events: bool) -> Array:
    """Current value, derivative or value before the event of variable number *index*.

    A state's value before has a meaning in a when-clause only, that is, where nothing *makes_events*.
    """
    if kind == "pre_state" and makes_events:
        raise document.refused(f"pre() of the state '{model.declared[index].name}' outside a when-clause", number)
    if kind not in _CURRENT | _BEFORE | {"derivative"}:
        raise document.refused(f"a reference of kind '{kind}'", number)
    declared = model.declared[index]
    if declared.scalar == "string":
        raise document.refused(f"the string '{declared.name}', which is not known while the model is built,", number)
    if kind in _BEFORE:
        elements = [model.graph.symbol(Symbol(Place.PRE, name)) for name in declared.names]
    else:
        elements = [model.graph.variable(name, int(kind == "derivative")) for name in declared.names]
    return Array(tuple(elements), declared.shape)


def constant_binding(document: Document, kind: str, index: int) -> int | None:
    """The node of a constant's or a string parameter's value, which takes its place; None for everything else."""
    if kind not in ("parameter", "constant"):
        return None
    record = document.lists["variables"][index]
    is_string = document.lists["value_types"][record["value_type"]]["scalar"] == "string"
    if record["role"] != "constant" and not is_string:
        return None
    attributes = record["attributes"]
    binding = attributes["start"] if attributes["binding"] is None else attributes["binding"]
    return int(binding) if binding is not None else None


def spread(document: Document, index: int, value: Value) -> Value:
    """*value* in the size of variable number *index*: a scalar goes to every element."""
    record = document.lists["variables"][index]
    shape = tuple(document.lists["value_types"][record["value_type"]]["dimensions"])
    if isinstance(value, Text) or not shape or array(value).shape == shape:
        return value
    elements = array(value).elements
    return Array(elements * _count(shape), shape) if len(elements) == 1 else value


def condition(document: Document, model: Model, index: int, number: int) -> Expression:
    """A condition used as a truth value: ``initial()``, or a sample that ticks."""
    record = document.lists["conditions"][index]
    kind, data = single(record["node"], "a condition", document.where(record.get("provenance")))
    if kind == "initial":
        return model.graph.symbol(Symbol(Place.INITIAL))
    if kind == "clock":
        return model.ticks(data, document.at(number))
    raise document.refused(f"a condition of kind '{kind}' as a value", number)


def shown(value: Value) -> Text:
    """*value* as text of a message."""
    if isinstance(value, Text):
        return value
    return Text(", ".join(_shown(element) for element in array(value).elements))


def _shown(expression: Expression) -> str:
    text = shown_expression(expression)
    return text if expression.is_constant else f"<{text}>"


def _count(shape: tuple[int, ...]) -> int:
    count = 1
    for size in shape:
        count *= size
    return count
