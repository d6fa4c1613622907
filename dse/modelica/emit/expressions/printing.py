"""One operator as C text, given its operands' texts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from dse.errors import fail
from dse.modelica.algebra.expression import Expression
from dse.modelica.emit.expressions.setting import Setting, is_truth, literal

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
        return self.text[1:-1] if self.is_wrapped else self.text

    @property
    def bare_truth(self) -> str:
        """As 0 or 1, where a whole expression is wanted."""
        return self.bare_value if self.is_truth else f"{self.text} != 0.0"


def cheap(node: Expression) -> bool:
    """Whether writing *node* twice is as good as giving it a name."""
    if not node.operands:
        return True
    return node.operator in ("negate", "not", "abs") and not node.operands[0].operands


# fmt: off
_BETWEEN = {
    "add": "+", "subtract": "-", "multiply": "*", "divide": "/", "less": "<", "less_equal": "<=", "greater": ">",
    "greater_equal": ">=", "equal": "==", "not_equal": "!=",
}
# fmt: on
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


_OUTSIDE = "a table is read outside of its axis, where that is an error"
_WHOLE, _AXIS = "i", "a"
# i: a whole number, a: an axis, whose length goes along, d: a double, v: values.
_OPERANDS = {"table1": "idavii", "table2": "iiddaavii", "random": "iiv", "random_start": "iv"}


def table_axes(node: Expression) -> list[Expression]:
    """The arrays over which *node* interpolates; none if it is no table."""
    meanings = _OPERANDS.get(node.name, "")
    return [operand for operand, meaning in zip(node.operands, meanings, strict=False) if meaning == _AXIS]


def call_lines(node: Expression, name: str, operands: Sequence[str], subject: str, setting: Setting) -> list[str]:
    """``name``, a double, becomes the value of the call *node*; *operands* are values and pointers."""
    if len(operands) != len(_OPERANDS.get(node.name, "")):
        raise fail(f"'{node.name}' with {len(operands)} operands cannot be translated to C")
    arguments = []
    for operand, text, meaning in zip(node.operands, operands, _OPERANDS[node.name], strict=True):
        arguments.append(f"(int)({text})" if meaning == _WHOLE else text)
        if meaning == _AXIS:
            arguments.append(str(len(operand.operands)))
    is_random = node.name.startswith("random")
    what = "a seed or state of random numbers is not of whole numbers of 32 bits" if is_random else _OUTSIDE
    failing = setting.failing(f"{what}: {subject}")
    return [f"double {name};", f"if (dse_{node.name}(&{name}, {', '.join(arguments)})) {{ {failing} }}"]


def select_lines(node: Expression, name: str, operands: Sequence[str], subject: str, setting: Setting) -> list[str]:
    """``name``, a double, becomes the element that *operands*, a pointer and whole numbers from 1, tell."""
    shape = node.operands[0].shape or (len(node.operands[0].operands),)
    if len(shape) != len(operands) - 1:
        raise fail(f"an array of {len(shape)} dimensions cannot have {len(operands) - 1} indices: {subject}")
    text = f"an index is not in 1:{', 1:'.join(str(size) for size in shape)}: {subject}"
    failing = setting.failing(text)
    lines, place = [], "0"
    for dimension, (size, index) in enumerate(zip(shape, operands[1:], strict=True)):
        lines.append(f"const int {name}_{dimension} = dse_index({index}, {size});")
        lines.append(f"if ({name}_{dimension} < 0) {{ {failing} }}")
        place = f"{name}_{dimension}" if dimension == 0 else f"({place}) * {size} + {name}_{dimension}"
    return [*lines, f"const double {name} = {operands[0]}[{place}];"]
