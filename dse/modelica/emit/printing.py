"""One operator as C text, given its operands' texts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dse.modelica.algebra.expression import Expression
from dse.modelica.emit.setting import Setting, is_truth
from dse.modelica.emit.text import literal

LARGEST_POWER = 16
"""Whole constant exponents up to this are multiplied out."""


@dataclass(frozen=True, slots=True)
class Printed:
    """*text* is an operand of anything: a name, a literal, a call or in parentheses. If *is_truth*, it is an int."""

    text: str
    is_truth: bool
    depth: int
    is_wrapped: bool = False

    @property
    def value(self) -> str:
        """As a double, where an operand is wanted."""
        return f"(double){self.text}" if self.is_truth else self.text

    @property
    def truth(self) -> str:
        """As 0 or 1, where an operand is wanted."""
        return self.text if self.is_truth else f"({self.text} != 0.0)"

    @property
    def bare_value(self) -> str:
        """As a double, where a whole expression is wanted."""
        return self._bare

    @property
    def bare_truth(self) -> str:
        """As 0 or 1, where a whole expression is wanted."""
        return self._bare if self.is_truth else f"{self.text} != 0.0"

    @property
    def _bare(self) -> str:
        return self.text[1:-1] if self.is_wrapped else self.text


def cheap(node: Expression) -> bool:
    """Whether writing *node* twice is as good as giving it a name."""
    if not node.operands:
        return True
    return node.operator in ("negate", "not", "abs") and not node.operands[0].operands


_BETWEEN = {
    "add": "+",
    "subtract": "-",
    "multiply": "*",
    "divide": "/",
    "less": "<",
    "less_equal": "<=",
    "greater": ">",
    "greater_equal": ">=",
    "equal": "==",
    "not_equal": "!=",
}
_NAMES = {"minimum": "dse_min", "maximum": "dse_max", "abs": "fabs", "sign": "dse_sign"}


def printed(node: Expression, operands: Sequence[Printed], setting: Setting) -> Printed:
    """*node*, which is a leaf or a scalar operator, over *operands*."""
    if node.symbol is not None:
        return Printed(setting.symbol(node.symbol), is_truth(node), 0)
    if node.is_constant:
        return Printed(literal(node.value), False, 0)
    depth = 1 + max(operand.depth for operand in operands)
    if node.operator in _BETWEEN:
        left, right = (operand.value for operand in operands)
        return Printed(f"({left} {_BETWEEN[node.operator]} {right})", is_truth(node), depth, True)
    match node.operator:
        case "negate":
            return Printed(f"(-{operands[0].value})", False, depth, True)
        case "and" | "or":
            sign = "&&" if node.operator == "and" else "||"
            return Printed(f"({operands[0].truth} {sign} {operands[1].truth})", True, depth, True)
        case "not":
            return Printed(f"!{operands[0].truth}", True, depth)
        case "if":
            condition, yes, no = operands
            return Printed(f"({condition.truth} ? {yes.value} : {no.value})", False, depth, True)
        case "power":
            return Printed(_power(node, operands), False, depth)
    listed = ", ".join(operand.value if not operand.is_wrapped else operand.bare_value for operand in operands)
    return Printed(f"{_NAMES.get(node.operator, node.operator)}({listed})", False, depth)


def _power(node: Expression, operands: Sequence[Printed]) -> str:
    base, exponent = operands[0].value, node.operands[1]
    if exponent.is_constant and exponent.value.is_integer() and abs(exponent.value) <= LARGEST_POWER:
        return f"dse_whole_power({base}, {int(exponent.value)})"
    if exponent.is_number(0.5):
        return f"sqrt({base})"
    return f"pow({base}, {operands[1].value})"
