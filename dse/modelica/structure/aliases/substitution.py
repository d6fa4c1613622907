"""Putting kept variables in the place of eliminated ones, everywhere in a model."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Place, Symbol
from dse.modelica.algebra.traversal import replaced
from dse.modelica.flat_model import FlatModel, Variable

Rewrite = Callable[[Expression], Expression]


def rewriter(graph: Graph, substitutes: Mapping[str, Expression]) -> Rewrite:
    """A function that replaces each variable of *substitutes* by a number or a plus or minus variable.

    Its time derivatives become those of the substitute, its pre-value the substitute's.
    """

    def new(node: Expression) -> Expression | None:
        symbol = node.symbol
        if symbol is None or symbol.place not in (Place.VARIABLE, Place.PRE) or symbol.name not in substitutes:
            return None
        other = substitutes[symbol.name]
        if other.is_constant:
            return other if symbol.order == 0 else graph.constant(0.0)
        kept, is_negative = (other.operands[0], True) if other.operator == "negate" else (other, False)
        if kept.symbol is None:
            raise ValueError(symbol.name)
        moved = graph.symbol(Symbol(symbol.place, kept.symbol.name, symbol.order))
        return -moved if is_negative else moved

    return lambda root: replaced((root,), new)[0]


def rewritten(flat: FlatModel, rewrite: Rewrite) -> FlatModel:
    """*flat* with *rewrite* applied to every expression of it."""
    return replace(
        flat,
        variables={name: _variable(variable, rewrite) for name, variable in flat.variables.items()},
        equations=tuple(replace(one, residual=rewrite(one.residual)) for one in flat.equations),
        initial_equations=tuple(replace(one, residual=rewrite(one.residual)) for one in flat.initial_equations),
        relations=tuple(replace(one, truth=rewrite(one.truth)) for one in flat.relations),
        triggers=tuple(replace(one, conditions=tuple(map(rewrite, one.conditions))) for one in flat.triggers),
        assignments=tuple(replace(one, value=rewrite(one.value)) for one in flat.assignments),
        reinitializations=tuple(replace(one, value=rewrite(one.value)) for one in flat.reinitializations),
        checks=tuple(replace(one, condition=rewrite(one.condition)) for one in flat.checks),
    )


def _variable(variable: Variable, rewrite: Rewrite) -> Variable:
    given = (variable.start, variable.binding, variable.minimum, variable.maximum, variable.nominal)
    if all(one is None or one.is_constant for one in given):
        return variable
    start, binding, minimum, maximum, nominal = (None if one is None else rewrite(one) for one in given)
    return replace(variable, start=start, binding=binding, minimum=minimum, maximum=maximum, nominal=nominal)
