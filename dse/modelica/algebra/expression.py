"""Scalar expressions of a flat model: immutable, shared, one object for equal expressions of one graph.

Every value is a number: a truth value is 0 or 1, an enumeration's item its number from 1, an integer a whole double.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping

from dse.modelica.algebra.arithmetic import FUNCTIONS
from dse.modelica.algebra.symbol import Symbol, variable

# fmt: off
OPERATORS = frozenset({
    "add", "subtract", "multiply", "divide", "negate", "power", "minimum", "maximum", "less", "less_equal",
    "greater", "greater_equal", "equal", "not_equal", "and", "or", "not", "if", "abs", "sign", "sqrt", "sin",
    "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "log10", "floor", "ceil",
    "array", "select", "call",
})
# fmt: on
"""All operators. Operands are scalars, except:

``if``: condition, value, value. ``array``: the elements, row by row; only as an operand of ``select`` or ``call``;
its shape is the expression's *shape*. ``select``: array, then one whole index from 1 for each dimension; outside the
array it is an error at run time. ``call``: *name* is one of `PRIMITIVES`; operands are scalars and arrays.
"""


# fmt: off
STEPS = frozenset({
    "sign", "floor", "ceil", "less", "less_equal", "greater", "greater_equal", "equal", "not_equal", "and", "or", "not",
})
# fmt: on
"""Operators whose values jump and rest between: their derivative is 0."""


class Expression:
    """A node. *symbol* is given for leaves that are no constants, *value* for constants, *name* for calls."""

    __slots__ = ("graph", "name", "number", "operands", "operator", "shape", "symbol", "value")

    def __init__(
        self,
        graph: Graph,
        number: int,
        operator: str,
        operands: tuple[Expression, ...],
        symbol: Symbol | None,
        value: float,
        name: str,
        shape: tuple[int, ...],
    ) -> None:
        self.graph, self.number, self.operator, self.operands = graph, number, operator, operands
        self.symbol, self.value, self.name, self.shape = symbol, value, name, shape

    @property
    def is_constant(self) -> bool:
        """Whether it is a number."""
        return self.operator == "constant"

    def is_number(self, value: float) -> bool:
        """Whether it is the number *value*."""
        return self.operator == "constant" and self.value == value

    def __add__(self, other: Operand) -> Expression:
        return self.graph.make("add", self, self.graph.of(other))

    def __radd__(self, other: Operand) -> Expression:
        return self.graph.of(other) + self

    def __sub__(self, other: Operand) -> Expression:
        return self.graph.make("subtract", self, self.graph.of(other))

    def __rsub__(self, other: Operand) -> Expression:
        return self.graph.of(other) - self

    def __mul__(self, other: Operand) -> Expression:
        return self.graph.make("multiply", self, self.graph.of(other))

    def __rmul__(self, other: Operand) -> Expression:
        return self.graph.of(other) * self

    def __truediv__(self, other: Operand) -> Expression:
        return self.graph.make("divide", self, self.graph.of(other))

    def __rtruediv__(self, other: Operand) -> Expression:
        return self.graph.of(other) / self

    def __neg__(self) -> Expression:
        return self.graph.make("negate", self)

    def __repr__(self) -> str:
        return shown(self)


Operand = Expression | float


class Graph:
    """All expressions of one model; equal expressions are one object, so ``is`` compares."""

    def __init__(self) -> None:
        self._nodes: dict[tuple[object, ...], Expression] = {}

    def __len__(self) -> int:
        """How many expressions there are."""
        return len(self._nodes)

    def of(self, value: Operand) -> Expression:
        """*value* as an expression of this graph."""
        return value if isinstance(value, Expression) else self.constant(value)

    def constant(self, value: float) -> Expression:
        """The number *value*. -0 and 0 are told apart, as C does."""
        number = float(value)
        key = ("constant", number.hex())
        return self._keep(key, "constant", (), None, number, "", ())

    def symbol(self, symbol: Symbol) -> Expression:
        """The leaf that refers to *symbol*."""
        return self._keep(("symbol", symbol), "symbol", (), symbol, math.nan, "", ())

    def variable(self, name: str, order: int = 0) -> Expression:
        """The variable *name*, or its time derivative."""
        return self.symbol(variable(name, order))

    def array(self, elements: Iterable[Expression], shape: tuple[int, ...]) -> Expression:
        """An operand for ``select`` or ``call``: *elements* row by row."""
        return self.node("array", tuple(elements), shape=shape)

    def call(self, name: str, operands: Iterable[Expression]) -> Expression:
        """A call of the primitive *name*."""
        return self.node("call", tuple(operands), name=name)

    def make(self, operator: str, *operands: Expression) -> Expression:
        """*operator* over *operands*, in its simplest form. Simplifying never changes a finite value by a bit."""
        return simplified(self, operator, operands)

    def node(
        self, operator: str, operands: tuple[Expression, ...], name: str = "", shape: tuple[int, ...] = ()
    ) -> Expression:
        """The node as it is, not simplified."""
        key = (operator, *(operand.number for operand in operands), name, shape)
        return self._keep(key, operator, operands, None, math.nan, name, shape)

    def _keep(
        self,
        key: tuple[object, ...],
        operator: str,
        operands: tuple[Expression, ...],
        symbol: Symbol | None,
        value: float,
        name: str,
        shape: tuple[int, ...],
    ) -> Expression:
        found = self._nodes.get(key)
        if found is None:
            found = Expression(self, len(self._nodes), operator, operands, symbol, value, name, shape)
            self._nodes[key] = found
        return found


def shown(root: Expression) -> str:
    """*root* in words of Modelica, for messages; long ones are cut."""
    if root.symbol is not None:
        return str(root.symbol)
    if root.is_constant:
        return f"{root.value:g}"
    inside = ", ".join(shown(operand) if operand.symbol or operand.is_constant else "…" for operand in root.operands)
    return f"{root.name or root.operator}({inside})"[:120]


_TRUTH = frozenset({"less", "less_equal", "greater", "greater_equal", "equal", "not_equal", "and", "or", "not"})


def simplified(graph: Graph, operator: str, operands: tuple[Expression, ...]) -> Expression:
    """*operator* over *operands* in its simplest form. Truth operands are taken to be 0 or 1."""
    if operator in FUNCTIONS and all(operand.is_constant for operand in operands):
        value = FUNCTIONS[operator](*(operand.value for operand in operands))
        if math.isfinite(value):
            return graph.constant(value)
    rule = _RULES.get(operator)
    found = rule(graph, operands) if rule else None
    return graph.node(operator, operands) if found is None else found


def _is_negated(node: Expression) -> bool:
    return node.operator == "negate"


def _add(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    if left.is_number(0):
        return right
    if right.is_number(0):
        return left
    if _is_negated(right):
        return graph.make("subtract", left, right.operands[0])
    if _is_negated(left):
        return graph.make("subtract", right, left.operands[0])
    return None


def _subtract(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    if right.is_number(0):
        return left
    if left is right:
        return graph.constant(0.0)
    if left.is_number(0):
        return graph.make("negate", right)
    if _is_negated(right):
        return graph.make("add", left, right.operands[0])
    return None


def _negate(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    (inner,) = operands
    if _is_negated(inner):
        return inner.operands[0]
    if inner.operator == "subtract":
        return graph.make("subtract", inner.operands[1], inner.operands[0])
    return None


def _multiply(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    for one, other in ((left, right), (right, left)):
        if one.is_number(0):
            return graph.constant(0.0)
        if one.is_number(1):
            return other
        if one.is_number(-1):
            return graph.make("negate", other)
    if _is_negated(left) and _is_negated(right):
        return graph.make("multiply", left.operands[0], right.operands[0])
    if _is_negated(left):
        return graph.make("negate", graph.make("multiply", left.operands[0], right))
    if _is_negated(right):
        return graph.make("negate", graph.make("multiply", left, right.operands[0]))
    return None


def _divide(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    left, right = operands
    if right.is_number(1):
        return left
    if right.is_number(-1):
        return graph.make("negate", left)
    if left.is_number(0) and not right.is_number(0):
        return graph.constant(0.0)
    if _is_negated(left) and _is_negated(right):
        return graph.make("divide", left.operands[0], right.operands[0])
    if _is_negated(left):
        return graph.make("negate", graph.make("divide", left.operands[0], right))
    if _is_negated(right):
        return graph.make("negate", graph.make("divide", left, right.operands[0]))
    return None


def _power(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    base, exponent = operands
    if exponent.is_number(0):
        return graph.constant(1.0)
    return base if exponent.is_number(1) else None


def _same(_: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    return operands[0] if operands[0] is operands[1] else None


def _reflexive(value: float) -> Callable[[Graph, tuple[Expression, ...]], Expression | None]:
    def rule(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
        return graph.constant(value) if operands[0] is operands[1] else None

    return rule


def _junction(neutral: float) -> Callable[[Graph, tuple[Expression, ...]], Expression | None]:
    def rule(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
        left, right = operands
        for one, other in ((left, right), (right, left)):
            if one.is_constant:
                return other if (one.value != 0) == (neutral != 0) else graph.constant(1.0 - neutral)
        return left if left is right else None

    return rule


def _not(_: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    (inner,) = operands
    return inner.operands[0] if inner.operator == "not" else None


def _if(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    condition, yes, no = operands
    if condition.is_constant:
        return yes if condition.value != 0 else no
    if yes is no:
        return yes
    if condition.operator == "not":
        return graph.make("if", condition.operands[0], no, yes)
    if condition.operator in _TRUTH and yes.is_number(1) and no.is_number(0):
        return condition
    return None


def _abs(graph: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    (inner,) = operands
    if inner.operator == "abs":
        return inner
    return graph.make("abs", inner.operands[0]) if _is_negated(inner) else None


def _select(_: Graph, operands: tuple[Expression, ...]) -> Expression | None:
    array, *indices = operands
    if not indices or array.operator != "array" or not all(index.is_constant for index in indices):
        return None
    place = 0
    for index, size in zip(indices, array.shape, strict=True):
        if not (index.value.is_integer() and 1 <= index.value <= size):
            return None
        place = place * size + int(index.value) - 1
    return array.operands[place]


_RULES: Mapping[str, Callable[[Graph, tuple[Expression, ...]], Expression | None]] = {
    "add": _add,
    "subtract": _subtract,
    "negate": _negate,
    "multiply": _multiply,
    "divide": _divide,
    "power": _power,
    "minimum": _same,
    "maximum": _same,
    "less": _reflexive(0.0),
    "less_equal": _reflexive(1.0),
    "greater": _reflexive(0.0),
    "greater_equal": _reflexive(1.0),
    "equal": _reflexive(1.0),
    "not_equal": _reflexive(0.0),
    "and": _junction(1.0),
    "or": _junction(0.0),
    "not": _not,
    "if": _if,
    "abs": _abs,
    "select": _select,
}
