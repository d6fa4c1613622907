"""What kind of value an expression has, and which kinds its operators take: units are checked here."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum
from fractions import Fraction

from dse.domain.expression import Binary, Expression, Node, Number, Span, Unary
from dse.errors import DseError
from dse.expression.tokens import COMPARISON_OPERATORS, LOGIC, error_at
from dse.units import Dimension, describe, divide, multiply, power


class Form(StrEnum):
    """Number, truth value, or an item of an enumeration."""

    NUMBER = "a number"
    TRUTH = "a condition"
    ITEM = "an item"


@dataclass(frozen=True, slots=True)
class Sort:
    """The kind of a value; *varies* says that it is a waveform, one value per row."""

    form: Form
    dimension: Dimension = ()
    varies: bool = False
    items: tuple[str, ...] = ()

    def __str__(self) -> str:
        if self.form is Form.NUMBER:
            return describe(self.dimension)
        return f"one of {', '.join(self.items)}" if self.form is Form.ITEM else str(self.form)


TRUTH = Sort(Form.TRUTH)
PLAIN = Sort(Form.NUMBER)


def error_in(expression: Expression, span: Span, what: str, advice: str) -> DseError:
    """A DseError at *span* of the expression, with a caret under it."""
    return error_at(expression.text, span, what, expression.origin, advice)


def require_number(expression: Expression, node: Node, sort: Sort) -> Sort:
    """*sort* itself; DseError if it is not a number."""
    return _require(expression, node, sort, Form.NUMBER)


def require_truth(expression: Expression, node: Node, sort: Sort) -> Sort:
    """*sort* itself; DseError if it is not a condition."""
    return _require(expression, node, sort, Form.TRUTH)


def require_alike(expression: Expression, span: Span, left: Sort, right: Sort, verb: str) -> None:
    """DseError unless both have the same form and dimension."""
    if left.form is not right.form or left.dimension != right.dimension or left.items != right.items:
        advice = "both sides must have the same unit; a bare number has none"
        raise error_in(expression, span, f"cannot {verb} {left} and {right}", advice)


def unary_sort(expression: Expression, node: Unary, operand: Sort) -> Sort:
    """The sort of ``-x`` or ``not x``. Raises DseError."""
    if node.operator == "not":
        return require_truth(expression, node.operand, operand)
    return require_number(expression, node.operand, operand)


def binary_sort(expression: Expression, node: Binary, left: Sort, right: Sort) -> Sort:
    """The sort of a binary operation on values of the sorts *left* and *right*. Raises DseError."""
    varies = left.varies or right.varies
    if node.operator in LOGIC:
        require_truth(expression, node.left, left)
        require_truth(expression, node.right, right)
        return replace(TRUTH, varies=varies)
    if node.operator not in ("==", "!="):
        require_number(expression, node.left, left)
        require_number(expression, node.right, right)
    if node.operator in COMPARISON_OPERATORS:
        require_alike(expression, _culprit(expression, node), left, right, "compare")
        return replace(TRUTH, varies=varies)
    match node.operator:
        case "+" | "-":
            verb = "add" if node.operator == "+" else "subtract"
            require_alike(expression, _culprit(expression, node), left, right, verb)
            return replace(left, varies=varies)
        case "*":
            return Sort(Form.NUMBER, multiply(left.dimension, right.dimension), varies)
        case "/":
            return Sort(Form.NUMBER, divide(left.dimension, right.dimension), varies)
    return Sort(Form.NUMBER, _power_dimension(expression, node, left, right), varies)


def choice_sort(expression: Expression, span: Span, yes: Sort, no: Sort) -> Sort:
    """The sort of ``if … then yes else no``. Raises DseError if the two differ."""
    require_alike(expression, span, yes, no, "choose between")
    return replace(yes, varies=yes.varies or no.varies)


def _require(expression: Expression, node: Node, sort: Sort, form: Form) -> Sort:
    if sort.form is form:
        return sort
    found = f"a number ({sort})" if sort.form is Form.NUMBER else str(sort)
    advice = "compare it with something" if form is Form.TRUTH else "arithmetic and comparison need numbers"
    raise error_in(expression, node.span, f"expected {form}, found {found}", advice)


def _culprit(expression: Expression, node: Binary) -> Span:
    """What to point at where the two sides do not fit: what is written out, else the operator."""
    for side in (node.right, node.left):
        if _literal(side) is not None:
            return side.span
    gap = (node.left.span[1], node.right.span[0])
    start = expression.text.find(node.operator, *gap)
    return (start, start + len(node.operator)) if start >= 0 else node.span


def _power_dimension(expression: Expression, node: Binary, base: Sort, exponent: Sort) -> Dimension:
    if exponent.dimension:
        raise error_in(expression, node.right.span, f"an exponent has no unit, found {exponent}", "write a bare number")
    if not base.dimension:
        return ()
    value = _literal(node.right)
    if value is None:
        advice = "otherwise the unit of the result is open"
        raise error_in(expression, node.right.span, "the exponent of a value with a unit must be written out", advice)
    return power(base.dimension, value)


def _literal(node: Node) -> Fraction | None:
    match node:
        case Number():
            return node.si
        case Unary("-", operand):
            value = _literal(operand)
            return None if value is None else -value
        case Binary("/", left, right):
            over, under = _literal(left), _literal(right)
            return over / under if over is not None and under else None
    return None
