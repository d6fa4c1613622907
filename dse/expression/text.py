"""Writes expressions as text that reads back as the same tree."""

from __future__ import annotations

from fractions import Fraction

from dse.domain.expression import (
    Between,
    Binary,
    Call,
    Chosen,
    Conditional,
    Expression,
    Name,
    Node,
    Number,
    Truth,
    Unary,
)
from dse.errors import DseError
from dse.expression.parse import parse_expression
from dse.expression.tokens import COMPARISON_OPERATORS, FROM_THE_RIGHT, STRENGTH
from dse.expression.tree import same


def show_expression(node: Node) -> str:
    """*node* in the language of `dse.expression.parse`, on one line, with few brackets.

    The tree that reads back has other spans, and a quotient where a number has no finite decimals.
    """
    match node:
        case Number():
            return _number(node)
        case Truth():
            return str(node.value).lower()
        case Name():
            return node.path
        case Chosen():
            return f"{node.place} is {node.options[0]}" if len(node.options) == 1 else _in(node)
        case Call():
            named = [f"{name} = {show_expression(value)}" for name, value in node.options]
            return f"{node.function}({', '.join([*map(show_expression, node.arguments), *named])})"
        case Unary("not"):
            return f"not {_within(node.operand, STRENGTH['not'])}"
        case Unary():
            return f"-{_within(node.operand, STRENGTH['negative'])}"
        case Between():
            value, low, high = (_within(part, STRENGTH["+"]) for part in (node.value, node.low, node.high))
            return f"{value} between {low} and {high}"
        case Conditional():
            yes, no = show_expression(node.yes), show_expression(node.no)
            return f"if {show_expression(node.condition)} then {yes} else {no}"
        case Binary():
            own = STRENGTH[node.operator]
            from_the_right = node.operator in FROM_THE_RIGHT
            left = _within(node.left, own + 1 if from_the_right or node.operator in COMPARISON_OPERATORS else own)
            right = _within(node.right, own if from_the_right else own + 1)
            return f"{left} {node.operator} {right}"


def text_of(expression: Expression) -> str:
    """The text of *expression* if it stands for its tree in our language, else the tree written out."""
    try:
        if same(parse_expression(expression.text).root, expression.root):
            return expression.text
    except DseError:
        pass  # The user wrote it in another language.
    return show_expression(expression.root)


def decimal(value: Fraction) -> str | None:
    """*value* written out exactly; None if its decimals never end."""
    rest, twos, fives = value.denominator, 0, 0
    while rest % 2 == 0:
        rest, twos = rest // 2, twos + 1
    while rest % 5 == 0:
        rest, fives = rest // 5, fives + 1
    if rest != 1:
        return None
    digits = max(twos, fives)
    whole = str(abs(value.numerator) * 10**digits // value.denominator).zfill(digits + 1)
    text = f"{whole[:-digits]}.{whole[-digits:]}" if digits else whole
    return f"-{text}" if value < 0 else text


def _number(node: Number) -> str:
    magnitude = (node.si - node.unit.offset) / node.unit.factor
    text = decimal(magnitude)
    if text is None:
        return f"({f'{magnitude.numerator} {node.unit}'.strip()} / {magnitude.denominator})"
    return f"{text} {node.unit}".strip()


def _in(node: Chosen) -> str:
    return f"{node.place} in [{', '.join(node.options)}]"


def _within(node: Node, least: int) -> str:
    # A prefix that could swallow what follows, or be swallowed, always has brackets as an operand.
    loose = isinstance(node, Conditional) or (isinstance(node, Unary) and least > STRENGTH["not"])
    text = show_expression(node)
    return f"({text})" if loose or _strength(node) < least else text


def _strength(node: Node) -> int:
    match node:
        case Binary():
            return STRENGTH[node.operator]
        case Unary():
            return STRENGTH["not" if node.operator == "not" else "negative"]
        case Chosen() | Between():
            return STRENGTH["is"]
        case Number():
            return STRENGTH["negative"] if node.si < 0 else STRENGTH["atom"]
    return STRENGTH["atom"]
