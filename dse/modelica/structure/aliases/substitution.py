"""Putting kept variables in the place of eliminated ones, everywhere in a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Referent
from dse.modelica.algebra.traversal import replaced

Rewrite = Callable[[Expression], Expression]


def rewriter(graph: Graph, substitutes: Mapping[str, Expression]) -> Rewrite:
    """A function that replaces each variable of *substitutes* by a number or a plus or minus variable.

    Its time derivatives become those of the substitute, its pre-value the substitute's.
    """

    def new(node: Expression) -> Expression | None:
        symbol = node.symbol
        if symbol is None or symbol.referent not in (Referent.VARIABLE, Referent.PRE) or symbol.name not in substitutes:
            return None
        other = substitutes[symbol.name]
        if other.is_constant:
            return other if symbol.order == 0 else graph.constant(0.0)
        kept, is_negative = (other.operands[0], True) if other.operator == "negate" else (other, False)
        if kept.symbol is None:
            raise ValueError(symbol.name)
        moved = graph.symbol(replace(kept.symbol, order=symbol.order, referent=symbol.referent))
        return -moved if is_negative else moved

    return lambda root: replaced((root,), new)[0]
