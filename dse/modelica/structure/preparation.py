"""A flat model made ready to be sorted: parameters that are 0 for good, and rates that are to be states."""

from __future__ import annotations

from dataclasses import replace

from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import replaced, symbols
from dse.modelica.flat_model import Equation, FlatModel, Role, ScalarType, Variable
from dse.modelica.structure.aliases.elimination import rewriter


def without_zeros(flat: FlatModel) -> FlatModel:
    """*flat* with 0 for the parameters that are 0 for good, so that what they multiply is in no equation.

    An ideal component often is a general one of which a parameter is 0: ``i = C*der(v)`` of an absent capacitance.
    """
    zeros = {
        name: flat.graph.constant(0.0)
        for name, one in flat.variables.items()
        if one.role is Role.PARAMETER and (one.is_final or one.is_structural)
        if one.binding is not None and one.binding.is_number(0)
    }
    return flat.mapped(rewriter(flat.graph, zeros)) if zeros else flat


def with_preferred_rates(flat: FlatModel) -> FlatModel:
    """*flat* with an unknown for the derivative of each rate that a preferred state has and that is preferred too.

    The rate is to be a state though no equation has its derivative (``v_rel = der(s_rel)`` with stateSelect.prefer).
    Which variables are states matters to the results where a `reinit` sets a state anew: all other states keep their
    values. So only models that have a `reinit` are changed.
    """
    if not flat.reinitializations:
        return flat
    differentiated = {symbol.name for one in flat.equations for symbol in symbols(one.residual) if symbol.order}
    variables, equations = dict(flat.variables), list(flat.equations)
    for one in flat.equations:
        rate = _preferred_rate(flat, one.residual)
        if rate is not None and rate.name not in differentiated:
            name = f"$rate{len(equations) - len(flat.equations) + 1}"
            variables[name] = Variable(name, ScalarType.REAL, Role.CONTINUOUS, is_protected=True, where=one.where)
            derivative = flat.graph.symbol(rate.derivative)
            equations.append(Equation(flat.graph.variable(name) - derivative, one.where))
    extended = replace(flat, variables=variables, equations=tuple(equations))
    return extended if len(equations) > len(flat.equations) else flat


def _preferred_rate(flat: FlatModel, residual: Expression) -> Symbol | None:
    """The variable ``v`` of the equation ``v = der(x)``, if both are to be states."""
    if residual.operator != "subtract":
        return None
    found = {one.order: one for one in (each.symbol for each in residual.operands) if one and one.is_variable}
    are_wanted = all(flat.variables[one.name].prefers_state > 0 for one in found.values())
    return found[0] if are_wanted and found.keys() == {0, 1} else None


def with_initial(residual: Expression, value: float) -> Expression:
    """*residual* where ``initial()`` is *value*."""
    number = residual.graph.constant(value)

    def new(node: Expression) -> Expression | None:
        return number if node.symbol is not None and node.symbol.referent is Referent.INITIAL else None

    return replaced((residual,), new)[0]
