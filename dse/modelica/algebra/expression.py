"""Scalar expressions of a flat model: immutable, shared, in their simplest form, one object for equal expressions.

Every value is a number: a truth value is 0 or 1, an enumeration's item its number from 1, an integer a whole double.

The rules of simplification keep every finite value to the bit, apart from the sign of a zero. What a rule may lose is a
value that is not finite: ``0 * x``, ``0 / x`` and ``x - x`` become 0 although they are NaN where x is not finite (or
where ``0 / x`` divides by 0); without this no Jacobian would have a structural zero. ``x / x`` stays, since its 0 / 0
is a singular equation to be told. Sums and products are never regrouped: that would round differently. Numbers are
folded unless the result is not finite, so that ``1 / 0`` stays visible to whoever has a file and a line for it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

from dse.modelica.algebra.arithmetic import FUNCTIONS
from dse.modelica.algebra.symbol import Symbol

ORDERINGS = frozenset({"less", "less_equal", "greater", "greater_equal"})
COMPARISONS = ORDERINGS | {"equal", "not_equal"}
TRUTHS = COMPARISONS | {"and", "or", "not"}
"""Operators whose values are 0 or 1."""
STEPS = TRUTHS | {"sign", "floor", "ceil"}
"""Operators whose values jump and rest between: their derivative is 0."""


@dataclass(slots=True, eq=False, repr=False)
class Expression:
    """A node. *symbol* is given for leaves that are no constants, *value* for constants, *name* for calls.

    Operators are those of `FUNCTIONS`, over scalars, and three more. ``prescribed`` is its first operand with the
    second one as its time derivative; there are none after the index reduction. ``array``: the elements, row by row,
    only as an operand of the other two; its shape is the expression's *shape*. ``select``: array, then one whole index
    from 1 for each dimension; outside the array it is an error at run time. ``call``: of the primitive *name*, with
    scalars and arrays.
    """

    graph: Graph
    number: int
    operator: str
    operands: tuple[Expression, ...]
    symbol: Symbol | None
    value: float
    name: str
    shape: tuple[int, ...]

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
Operands = tuple[Expression, ...]


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
        return self._keep(("constant", number.hex()), "constant", value=number)

    def symbol(self, symbol: Symbol) -> Expression:
        """The leaf that refers to *symbol*."""
        return self._keep(("symbol", symbol), "symbol", symbol=symbol)

    def knows(self, symbol: Symbol) -> bool:
        """Whether any expression refers to *symbol*."""
        return ("symbol", symbol) in self._nodes

    def uses(self, operator: str) -> bool:
        """Whether any expression is made by *operator*."""
        return any(node.operator == operator for node in self._nodes.values())

    def variable(self, name: str, order: int = 0) -> Expression:
        """The variable *name*, or its time derivative."""
        return self.symbol(Symbol(name, order))

    def array(self, elements: Iterable[Expression], shape: tuple[int, ...]) -> Expression:
        """An operand for ``select`` or ``call``: *elements* row by row."""
        return self.node("array", tuple(elements), shape=shape)

    def call(self, name: str, operands: Iterable[Expression]) -> Expression:
        """A call of the primitive *name*."""
        return self.node("call", tuple(operands), name=name)

    def make(self, operator: str, *operands: Expression) -> Expression:
        """*operator* over *operands*, in its simplest form. Truth operands are taken to be 0 or 1."""
        if operator in FUNCTIONS and all(operand.is_constant for operand in operands):
            value = FUNCTIONS[operator](*(operand.value for operand in operands))
            if math.isfinite(value):
                return self.constant(value)
        rule = _RULES.get(operator)
        found = rule(self, operands) if rule else None
        return self.node(operator, operands) if found is None else found

    def node(self, operator: str, operands: Operands, name: str = "", shape: tuple[int, ...] = ()) -> Expression:
        """The node as it is, not simplified."""
        key = (operator, *(operand.number for operand in operands), name, shape)
        return self._keep(key, operator, operands, name=name, shape=shape)

    def _keep(
        self,
        key: tuple[object, ...],
        operator: str,
        operands: Operands = (),
        symbol: Symbol | None = None,
        value: float = math.nan,
        name: str = "",
        shape: tuple[int, ...] = (),
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


_Rule = Callable[[Graph, Operands], Expression | None]


def _is_negated(node: Expression) -> bool:
    return node.operator == "negate"


def _add(graph: Graph, operands: Operands) -> Expression | None:
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


def _subtract(graph: Graph, operands: Operands) -> Expression | None:
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


def _negate(graph: Graph, operands: Operands) -> Expression | None:
    (inner,) = operands
    if _is_negated(inner):
        return inner.operands[0]
    if inner.operator == "subtract":
        return graph.make("subtract", inner.operands[1], inner.operands[0])
    return None


def _multiply(graph: Graph, operands: Operands) -> Expression | None:
    left, right = operands
    for one, other in ((left, right), (right, left)):
        if one.is_number(0):
            return graph.constant(0.0)
        if one.is_number(1):
            return other
        if one.is_number(-1):
            return graph.make("negate", other)
    return _without_signs(graph, "multiply", left, right)


def _divide(graph: Graph, operands: Operands) -> Expression | None:
    left, right = operands
    if right.is_number(1):
        return left
    if right.is_number(-1):
        return graph.make("negate", left)
    if left.is_number(0) and not right.is_number(0):
        return graph.constant(0.0)
    return _without_signs(graph, "divide", left, right)


def _without_signs(graph: Graph, operator: str, left: Expression, right: Expression) -> Expression | None:
    """The signs of a product's or a quotient's operands before it as a whole."""
    if _is_negated(left) and _is_negated(right):
        return graph.make(operator, left.operands[0], right.operands[0])
    if _is_negated(left):
        return graph.make("negate", graph.make(operator, left.operands[0], right))
    if _is_negated(right):
        return graph.make("negate", graph.make(operator, left, right.operands[0]))
    return None


def _power(graph: Graph, operands: Operands) -> Expression | None:
    base, exponent = operands
    if exponent.is_number(0):
        return graph.constant(1.0)
    return base if exponent.is_number(1) else None


def _same(_: Graph, operands: Operands) -> Expression | None:
    return operands[0] if operands[0] is operands[1] else None


def _reflexive(value: float) -> _Rule:
    return lambda graph, operands: graph.constant(value) if operands[0] is operands[1] else None


def _junction(neutral: float) -> _Rule:
    def rule(graph: Graph, operands: Operands) -> Expression | None:
        left, right = operands
        for one, other in ((left, right), (right, left)):
            if one.is_constant:
                return other if (one.value != 0) == (neutral != 0) else graph.constant(1.0 - neutral)
        return left if left is right else None

    return rule


def _not(_: Graph, operands: Operands) -> Expression | None:
    (inner,) = operands
    return inner.operands[0] if inner.operator == "not" else None


def _if(graph: Graph, operands: Operands) -> Expression | None:
    condition, yes, no = operands
    if condition.is_constant:
        return yes if condition.value != 0 else no
    if yes is no:
        return yes
    if condition.operator == "not":
        return graph.make("if", condition.operands[0], no, yes)
    if condition.operator in TRUTHS and yes.is_number(1) and no.is_number(0):
        return condition
    return None


def _abs(graph: Graph, operands: Operands) -> Expression | None:
    (inner,) = operands
    if inner.operator == "abs":
        return inner
    return graph.make("abs", inner.operands[0]) if _is_negated(inner) else None


def _select(_: Graph, operands: Operands) -> Expression | None:
    array, *indices = operands
    if not indices or array.operator != "array" or not all(index.is_constant for index in indices):
        return None
    place = 0
    for index, size in zip(indices, array.shape, strict=True):
        if not (index.value.is_integer() and 1 <= index.value <= size):
            return None
        place = place * size + int(index.value) - 1
    return array.operands[place]


# fmt: off
_RULES: Mapping[str, _Rule] = {
    "add": _add, "subtract": _subtract, "negate": _negate, "multiply": _multiply, "divide": _divide, "power": _power,
    "minimum": _same, "maximum": _same, "less": _reflexive(0.0), "less_equal": _reflexive(1.0),
    "greater": _reflexive(0.0), "greater_equal": _reflexive(1.0), "equal": _reflexive(1.0),
    "not_equal": _reflexive(0.0), "and": _junction(1.0), "or": _junction(0.0), "not": _not, "if": _if, "abs": _abs,
    "select": _select,
}
# fmt: on
