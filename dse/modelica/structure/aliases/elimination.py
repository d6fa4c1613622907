"""Alias elimination: variables that equal another one, plus or minus, or a number."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import replaced, symbols
from dse.modelica.flat_model import Equation, FlatModel, Role, ScalarType, Variable


@dataclass(frozen=True, slots=True)
class Eliminated:
    """*aliases*: name -> (kept name, +1 or -1). *numbers*: name -> value. *equations*: those that remain, rewritten."""

    aliases: Mapping[str, tuple[str, int]]
    numbers: Mapping[str, float]
    equations: tuple[Equation, ...]

    def substitutes(self, graph: Graph) -> dict[str, Expression]:
        """What stands for each eliminated variable."""
        found: dict[str, Expression] = {}
        for name, (kept, sign) in self.aliases.items():
            kept_variable = graph.variable(kept)
            found[name] = kept_variable if sign > 0 else -kept_variable
        return found | {name: graph.constant(value) for name, value in self.numbers.items()}


def without_aliases(flat: FlatModel) -> Eliminated:
    """Eliminate every ``a = b``, ``a = -b``, ``a + b = 0`` and ``a = number`` of *flat*'s equations.

    Of two variables the better known is kept: an input, then a differentiated one, then by stateSelect, a fixed start,
    a given start, an output; then the first. An equation that says nothing new or something impossible stays, to be
    refused as singular.
    """
    ranks = _ranks(flat)
    parents: dict[str, tuple[str, int]] = {}
    numbers: dict[str, float] = {}
    equations = [Equation(cancelled(one.residual), one.where) for one in flat.equations]
    while True:
        kept: list[Equation] = []
        is_changed = False
        for equation in equations:
            pair = _pair(equation.residual, flat.variables)
            if pair is None or not _joined(pair, parents, numbers, ranks):
                kept.append(equation)
            else:
                is_changed = True
        aliases = {name: _root(name, parents) for name in parents}
        known = {**numbers, **{name: sign * numbers[root] for name, (root, sign) in aliases.items() if root in numbers}}
        found = Eliminated({name: pair for name, pair in aliases.items() if name not in known}, known, tuple(kept))
        rewrite = rewriter(flat.graph, found.substitutes(flat.graph))
        equations = [Equation(cancelled(rewrite(one.residual)), one.where) for one in kept]
        if not is_changed:
            return Eliminated(found.aliases, found.numbers, tuple(equations))


_Ranks = Mapping[str, tuple[int, ...]]
"""How much each variable should be kept rather than another; the least first."""


def _ranks(flat: FlatModel) -> _Ranks:
    differentiated = {symbol.name for symbol in symbols(*(one.residual for one in flat.equations)) if symbol.order > 0}
    return {
        name: (
            -(variable.role is Role.INPUT),
            -(name in differentiated),
            -variable.prefers_state,
            -variable.is_fixed,
            -(variable.start is not None),
            -variable.is_output,
            place,
        )
        for place, (name, variable) in enumerate(flat.variables.items())
    }


_Term = tuple[str, int]
"""A variable and its sign."""


def _pair(residual: Expression, variables: Mapping[str, Variable]) -> tuple[_Term, _Term | float] | None:
    """Two terms, or a term and a number, whose sum vanishes."""
    terms = _terms(residual.operands[0] if residual.operator == "negate" else residual)
    found: list[_Term] = []
    number = 0.0
    for term, sign in terms if len(terms) <= 2 else ():
        if term.is_constant:
            number += sign * term.value
        elif term.symbol is not None and _is_eliminable(term.symbol, variables):
            found.append((term.symbol.name, sign))
        else:
            return None
    if not found:
        return None
    return found[0], found[1] if len(found) > 1 else number


def _is_eliminable(symbol: Symbol, variables: Mapping[str, Variable]) -> bool:
    if not symbol.is_variable or symbol.order:
        return False
    variable = variables[symbol.name]
    return variable.kind is ScalarType.REAL and variable.role in (Role.CONTINUOUS, Role.INPUT)


def _joined(
    pair: tuple[_Term, _Term | float],
    parents: dict[str, tuple[str, int]],
    numbers: dict[str, float],
    ranks: _Ranks,
) -> bool:
    """Enter what *pair* says; False if nothing can be eliminated by it."""
    first, second = pair
    root, sign = _root(first[0], parents)
    sign *= first[1]
    if not isinstance(second, tuple):
        if root in numbers or ranks[root][0]:
            return False
        numbers[root] = -second / sign
        return True
    other, other_sign = _root(second[0], parents)
    other_sign *= second[1]
    # sign * root + other_sign * other = 0
    if root == other:
        return False
    if root in numbers or other in numbers:
        return False
    if ranks[other] < ranks[root]:
        root, other = other, root
    if ranks[other][0]:
        return False
    parents[other] = (root, -sign * other_sign)
    return True


def _root(name: str, parents: Mapping[str, tuple[str, int]]) -> tuple[str, int]:
    sign = 1
    while name in parents:
        name, own = parents[name]
        sign *= own
    return name, sign


def cancelled(residual: Expression) -> Expression:
    """*residual* without terms that occur with both signs, like ``(a + b) - a``; the same object if there are none.

    After aliases were put in, balances of flows are full of them; they would pass for terms that can be solved for.
    """
    terms = _terms(residual)
    if len({term for term, _ in terms}) == len(set(terms)):
        return residual
    balance: dict[int, int] = {}
    for term, sign in terms:
        balance[term.number] = balance.get(term.number, 0) + sign
    total = residual.graph.constant(0.0)
    for term, sign in terms:
        left = balance[term.number]
        if left * sign > 0:
            balance[term.number] = left - sign
            total = total + term if sign > 0 else total - term
    return total


def _terms(root: Expression) -> list[tuple[Expression, int]]:
    """The terms of the sum *root*, with their signs."""
    terms: list[tuple[Expression, int]] = []
    stack = [(root, 1)]
    while stack:
        node, sign = stack.pop()
        match node.operator:
            case "negate":
                stack.append((node.operands[0], -sign))
            case "add":
                stack.extend([(node.operands[1], sign), (node.operands[0], sign)])
            case "subtract":
                stack.extend([(node.operands[1], -sign), (node.operands[0], sign)])
            case _:
                terms.append((node, sign))
    return terms


def rewriter(graph: Graph, substitutes: Mapping[str, Expression]) -> Callable[[Expression], Expression]:
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
