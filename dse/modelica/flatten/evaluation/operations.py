"""Rules for single values: references, operators, functions."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping

from dse.modelica.algebra.expression import COMPARISONS, Expression, shown
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.flatten.document import Document, single
from dse.modelica.flatten.evaluation import inlining
from dse.modelica.flatten.evaluation.builtins import BUILTINS, Given, binary
from dse.modelica.flatten.evaluation.context import Frame, Request, Rule, Steps, Visit, requested
from dse.modelica.flatten.evaluation.rounding import QUOTIENTS, ROUNDINGS, quotient, rounded, sign
from dse.modelica.flatten.values import Array, MismatchError, Structure, Text, Value, array, mapped, only, scalar
from dse.modelica.frontend.literal import WRAPPER


def _literal(visit: Visit) -> Steps:
    kind, value = single(visit.node.data, "a literal", visit.where)
    if kind == "string":
        simulated = visit.document.result.model.rpartition(".")[2]
        return Text(re.sub(rf"^{WRAPPER}(?=\.|$)", simulated, value))  # of getInstanceName
    if kind not in ("real", "integer", "boolean", "enumeration") or not isinstance(value, int | float):
        raise visit.document.refused(f"a literal of kind '{kind}'", visit.number)
    return scalar(visit.graph.constant(float(value)))
    yield  # a generator without requests


_CURRENT = frozenset({"parameter", "state", "algebraic", "output", "input", "discrete_real", "discrete_value"})
_BEFORE = frozenset({"pre_discrete_real", "pre_discrete_value", "pre_state"})


def _coordinate(visit: Visit) -> Steps:
    kind, data = single(visit.node.data, "a reference", visit.where)
    graph = visit.graph
    if kind == "time":
        return scalar(graph.symbol(Symbol(referent=Referent.TIME)))
    if kind == "binder":
        return scalar(graph.constant(float(visit.frame.binders[data["domain"]][data["ordinal"]])))
    if kind == "function_parameter":
        if data["function"] != visit.frame.function:
            raise visit.document.refused("an argument of another function", visit.number)
        ordinal: int = data["ordinal"]
        return visit.frame.arguments[ordinal]
    if kind == "condition":
        return scalar(_condition(visit, data))
    binding = _constant_binding(visit.document, kind, data)
    if binding is None:
        return _variable(visit, kind, data)
    value = visit.model.constants.get(binding)
    if value is None:
        value = yield Request(Frame(False, visit.frame.asserts), binding)
        value = visit.model.constants[binding] = _spread(visit.document, data, value)
    return value


def _condition(visit: Visit, index: int) -> Expression:
    """A condition used as a truth value: ``initial()``, or a sample that ticks."""
    record = visit.document.lists["conditions"][index]
    kind, data = single(record["node"], "a condition", visit.document.where(record.get("provenance")))
    if kind == "initial":
        return visit.graph.symbol(Symbol(referent=Referent.INITIAL))
    if kind == "clock":
        return visit.model.ticks(data, visit.where)
    raise visit.document.refused(f"a condition of kind '{kind}' as a value", visit.number)


def _constant_binding(document: Document, kind: str, index: int) -> int | None:
    """The node of a constant's or a string parameter's value, which takes its place; None for everything else."""
    if kind not in ("parameter", "constant"):
        return None
    record = document.lists["variables"][index]
    if record["role"] != "constant" and document.value_type(record)["scalar"] != "string":
        return None
    attributes = record["attributes"]
    binding = attributes["start"] if attributes["binding"] is None else attributes["binding"]
    return int(binding) if binding is not None else None


def _spread(document: Document, index: int, value: Value) -> Value:
    """*value* in the size of variable number *index*: a scalar goes to every element."""
    shape = tuple(document.value_type(document.lists["variables"][index])["dimensions"])
    if isinstance(value, Text) or not shape or array(value).shape == shape:
        return value
    elements = array(value).elements
    return Array(elements * math.prod(shape), shape) if len(elements) == 1 else value


def _variable(visit: Visit, kind: str, index: int) -> Array:
    """Current value, derivative or value before the event of variable number *index*.

    A state's value before has a meaning in a when-clause only, that is, where nothing makes events.
    """
    declared = visit.model.declared[index]
    if kind == "pre_state" and visit.frame.makes_events:
        raise visit.document.refused(f"pre() of the state '{declared.name}' outside a when-clause", visit.number)
    if kind not in _CURRENT | _BEFORE | {"derivative"}:
        raise visit.document.refused(f"a reference of kind '{kind}'", visit.number)
    if declared.scalar == "string":
        what = f"the string '{declared.name}', which is not known while the model is built,"
        raise visit.document.refused(what, visit.number)
    if kind in _BEFORE:
        elements = [visit.graph.symbol(Symbol(name, referent=Referent.PRE)) for name in declared.names]
    else:
        elements = [visit.graph.variable(name, int(kind == "derivative")) for name in declared.names]
    return Array(tuple(elements), declared.shape)


def _unary(visit: Visit) -> Steps:
    value = array((yield visit.request(visit.node.data["operand"])))
    operator = visit.node.data["operator"]
    if operator == "plus":
        return value
    if operator not in ("negate", "not"):
        raise visit.document.refused(f"the operator '{operator}'", visit.number)
    return mapped(value, lambda element: visit.graph.make(operator, element))


def _binary(visit: Visit) -> Steps:
    left = yield visit.request(visit.node.data["lhs"])
    right = yield visit.request(visit.node.data["rhs"])
    operator = visit.node.data["operator"]
    if isinstance(left, Text) and isinstance(right, Text):
        if operator == "add":
            return Text(left.text + right.text)
        if operator in ("equal", "not_equal"):
            return scalar(visit.graph.constant(float((left.text == right.text) == (operator == "equal"))))
    try:
        value = binary(visit.graph, operator, array(left), array(right))
    except KeyError:
        raise visit.document.refused(f"the operator '{operator}'", visit.number) from None
    if operator not in COMPARISONS or not visit.frame.makes_events:
        return value
    truth = value.elements[0]
    model = visit.model
    if all(model.is_discrete(array(side).elements[0]) for side in (left, right)) or truth.is_constant:
        return value
    if operator in ("equal", "not_equal"):
        raise visit.document.refused("comparing quantities that change continuously for equality", visit.number)
    return scalar(model.held(truth, visit.where))


def _conditional(visit: Visit) -> Steps:
    """Branches after a condition that is true while the model is built are not looked at: that ends recursion."""
    *pairs, last = visit.node.operands
    if len(pairs) % 2:
        raise visit.document.refused("an if-expression without an else", visit.number)
    graph, frame = visit.graph, visit.frame
    cases: list[tuple[Expression, Value]] = []
    rest: Value | None = None
    for condition_node, value_node in zip(pairs[::2], pairs[1::2], strict=True):
        condition = only((yield Request(frame, condition_node)))
        if condition.is_constant and condition.value == 0:
            continue
        if condition.is_constant:
            rest = yield Request(frame, value_node)
            break
        value = yield Request(frame.under(condition), value_node)
        cases.append((condition, value))
        frame = frame.under(graph.make("not", condition))
    if rest is None:
        rest = yield Request(frame, last)
    for condition, value in reversed(cases):
        rest = _chosen(condition, value, rest)
    return rest


def _chosen(condition: Expression, yes: Value, no: Value) -> Value:
    """``if condition then yes else no``, element by element and field by field."""
    if isinstance(yes, Array) and isinstance(no, Array) and yes.shape == no.shape:
        pairs = zip(yes.elements, no.elements, strict=True)
        return Array(tuple(condition.graph.make("if", condition, a, b) for a, b in pairs), yes.shape)
    if isinstance(yes, Structure) and isinstance(no, Structure):
        return Structure(tuple(_chosen(condition, a, b) for a, b in zip(yes.fields, no.fields, strict=True)))
    if isinstance(yes, Text) and yes == no:
        return yes
    raise MismatchError("an if-expression whose branches differ in size or are strings")


def _builtin(visit: Visit) -> Steps:
    name, operands = visit.node.data["builtin"], visit.node.operands
    if name in ("no_event", "smooth"):
        # smooth(p, e): the front-end lists no relations inside either; the integrator finds the kink by its error.
        return (yield Request(visit.frame.quiet(), operands[-1]))
    if name == "homotopy":
        return (yield from _homotopy(visit))
    values = yield from requested(visit.frame, operands)
    where = visit.where
    if name in ROUNDINGS or name == "sign":
        (value,) = (array(item) for item in values)
        held = visit.frame.makes_events
        if name == "sign":
            return mapped(value, lambda item: sign(visit.model, item, held, where))
        return mapped(value, lambda item: rounded(visit.model, name, item, held, where))
    if name in QUOTIENTS and len(values) == 2:
        left, right = map(only, values)
        return scalar(quotient(visit.model, name, left, right, visit.frame.makes_events, where))
    function = BUILTINS.get(name)
    if function is None:
        raise visit.document.refused(f"the function '{name}'", visit.number)
    try:
        return function(Given(visit.graph, values))
    except ValueError:
        raise MismatchError(f"'{name}' of {len(values)} arguments") from None


def _homotopy(visit: Visit) -> Steps:
    """The actual value, with a share of the simplified one while a system is continued."""
    actual = array((yield visit.request(visit.node.operands[0])))
    simplified = array((yield Request(visit.frame.quiet(), visit.node.operands[1])))
    if all(map(visit.model.is_parameter, actual.elements)):
        return actual
    share = visit.graph.symbol(Symbol(referent=Referent.CONTINUED))
    one = visit.graph.constant(1.0)
    pairs = zip(actual.elements, simplified.elements, strict=True)
    return Array(tuple(share * a + (one - share) * b for a, b in pairs), actual.shape)


def _quotient(visit: Visit) -> Steps:
    name = visit.node.data["builtin"]
    if name not in QUOTIENTS:
        raise visit.document.refused(f"the function '{name}'", visit.number)
    left = only((yield visit.request(visit.node.data["lhs"])))
    right = only((yield visit.request(visit.node.data["rhs"])))
    return scalar(quotient(visit.model, name, left, right, visit.frame.makes_events, visit.where))


def _call(visit: Visit) -> Steps:
    outputs = yield from inlining.call(visit)
    place: int = visit.node.data["output"]
    return outputs[place]


def _function_value(visit: Visit) -> Steps:
    return inlining.definition(visit)
    yield  # a generator without requests


def _string(visit: Visit) -> Steps:
    """Text of a number in a message: the number itself if it is known, else its name in angle brackets."""
    value = yield Request(visit.frame.quiet(), visit.node.data["value"])
    if isinstance(value, Text):
        return value
    return Text(", ".join(shown(one) if one.is_constant else f"<{shown(one)}>" for one in array(value).elements))


# fmt: off
RULES: Mapping[str, Rule] = {
    "literal": _literal, "coordinate": _coordinate, "unary": _unary, "binary": _binary, "conditional": _conditional,
    "builtin": _builtin, "runtime_quotient_owner": _quotient, "call": _call, "function_value": _function_value,
    "string_conversion": _string
}
# fmt: on
"""Rules by kind of node."""
