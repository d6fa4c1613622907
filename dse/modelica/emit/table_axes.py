"""The look at every table's axis before it is used."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise

from dse.errors import fail
from dse.modelica.algebra.expression import Expression, shown
from dse.modelica.algebra.traversal import walk
from dse.modelica.emit.expressions.printing import table_axes
from dse.modelica.emit.expressions.scope import Store, scope_lines
from dse.modelica.emit.expressions.setting import Setting


def axis_checks(roots: Iterable[Expression], setting: Setting) -> Iterator[list[str]]:
    """Statements that fail unless every table's axis has at least two numbers, each greater than the one before.

    Raises DseError for an axis of constants that is wrong already.
    """
    axes = {axis.number: axis for node in walk(roots) for axis in table_axes(node)}
    for axis in axes.values():
        if all(element.is_constant for element in axis.operands):
            _refuse_unordered(axis)
        else:
            yield _check(axis, setting)


def _text(axis: Expression) -> str:
    ends = ", …, ".join(shown(element) for element in (*axis.operands[:1], *axis.operands[1:][-1:]))
    return f"the axis of a table ({ends}) must have at least two numbers, each greater than the one before"


def _refuse_unordered(axis: Expression) -> None:
    numbers = [element.value for element in axis.operands]
    if len(numbers) < 2 or any(not left < right for left, right in pairwise(numbers)):
        raise fail(_text(axis))


def _check(axis: Expression, setting: Setting) -> list[str]:
    size = len(axis.operands)
    place = setting.array(axis)
    failing = setting.failing(_text(axis))
    if place is not None:
        return [f"    if (dse_axis({place}, {size})) {{ {failing} }}"]
    stores = [Store(f"axis[{k}]", element, "in the axis of a table") for k, element in enumerate(axis.operands)]
    lines = ["    {", f"        double axis[{size}];", *scope_lines(stores, setting)]
    return [*lines, f"        if (dse_axis(axis, {size})) {{ {failing} }}", "    }"]
