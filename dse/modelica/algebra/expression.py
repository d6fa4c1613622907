"""Scalar expressions of a flat model: immutable, shared, one object for equal expressions of one graph.

Every value is a number: a truth value is 0 or 1, an enumeration's item its number from 1, an integer a whole double.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from enum import StrEnum

from dse.modelica.algebra.simplify import simplified


class Place(StrEnum):
    """What a symbol stands for."""

    VARIABLE = "variable"
    """A continuous or discrete variable, input or parameter; with *order* > 0 its time derivative."""
    PRE = "pre"
    """Value of a discrete variable (or of a state at an event) just before."""
    HELD = "held"
    """Truth of relation number *name*, as it was at the last event."""
    TIME = "time"
    INITIAL = "initial"
    """True during the initialization only."""


@dataclass(frozen=True, slots=True)
class Symbol:
    """What a leaf refers to. *order* counts time derivatives, of variables only."""

    place: Place
    name: str = ""
    order: int = 0

    def __str__(self) -> str:
        match self.place:
            case Place.VARIABLE:
                return "der(" * self.order + self.name + ")" * self.order
            case Place.PRE | Place.HELD:
                return f"{self.place}({self.name})"
        return str(self.place)


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
        return self.symbol(Symbol(Place.VARIABLE, name, order))

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


def walk(roots: Iterable[Expression]) -> Iterator[Expression]:
    """Every expression below and including *roots* once, operands before what uses them."""
    seen: set[int] = set()
    stack: list[tuple[Expression, bool]] = [(root, False) for root in reversed(list(roots))]
    while stack:
        node, is_open = stack.pop()
        if is_open:
            yield node
        elif node.number not in seen:
            seen.add(node.number)
            stack.append((node, True))
            stack.extend((operand, False) for operand in reversed(node.operands) if operand.number not in seen)


def symbols(root: Expression) -> set[Symbol]:
    """What *root* refers to."""
    return {node.symbol for node in walk((root,)) if node.symbol is not None}


def replaced(roots: Iterable[Expression], new: Callable[[Expression], Expression | None]) -> list[Expression]:
    """*roots* with every expression for which *new* gives another replaced, from the leaves up."""
    done: dict[int, Expression] = {}
    listed = list(roots)
    for node in walk(listed):
        other = new(node)
        if other is None and node.operands:
            operands = tuple(done[operand.number] for operand in node.operands)
            if all(a is b for a, b in zip(operands, node.operands, strict=True)):
                other = node
            elif node.operator in ("array", "call"):
                other = node.graph.node(node.operator, operands, node.name, node.shape)
            else:
                other = node.graph.make(node.operator, *operands)
        done[node.number] = node if other is None else other
    return [done[root.number] for root in listed]


def shown(root: Expression) -> str:
    """*root* in words of Modelica, for messages; long ones are cut."""
    if root.symbol is not None:
        return str(root.symbol)
    if root.is_constant:
        return f"{root.value:g}"
    inside = ", ".join(shown(operand) if operand.symbol or operand.is_constant else "…" for operand in root.operands)
    return f"{root.name or root.operator}({inside})"[:120]
