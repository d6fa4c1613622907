"""What can fail inside an expression, as statements: tables, and elements whose index is known at run time only."""

from __future__ import annotations

from collections.abc import Sequence

from dse.errors import fail
from dse.modelica.algebra.expression import Expression
from dse.modelica.emit.setting import Setting

_WHOLE, _AXIS = "i", "a"
# i: a whole number, a: an axis, whose length goes along, d: a double, v: values.
_OPERANDS = {"table1": "idavii", "table2": "iiddaavii"}


def table_axes(node: Expression) -> list[Expression]:
    """The arrays over which *node* interpolates; none if it is no table."""
    meanings = _OPERANDS.get(node.name, "")
    return [operand for operand, meaning in zip(node.operands, meanings, strict=False) if meaning == _AXIS]


def call_lines(node: Expression, name: str, operands: Sequence[str], subject: str, setting: Setting) -> list[str]:
    """``name``, a double, becomes the value of the table call *node*; *operands* are values and pointers."""
    if len(operands) != len(_OPERANDS.get(node.name, "")):
        raise fail(f"'{node.name}' with {len(operands)} operands cannot be translated to C")
    arguments = []
    for operand, text, meaning in zip(node.operands, operands, _OPERANDS[node.name], strict=True):
        arguments.append(f"(int)({text})" if meaning == _WHOLE else text)
        if meaning == _AXIS:
            arguments.append(str(len(operand.operands)))
    failing = setting.failing(f"a table is read outside of its axis, where that is an error: {subject}")
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
