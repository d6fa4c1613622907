"""What is known before a run: which symbols are parameters, and the values everything has at the start."""

from __future__ import annotations

import math
from dataclasses import dataclass

from dse.errors import Problem, raise_if_any
from dse.graphs import components
from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression
from dse.modelica.algebra.symbol import Referent, Symbol
from dse.modelica.algebra.traversal import symbols
from dse.modelica.flat_model import FlatModel, Role, ScalarType, Variable
from dse.modelica.solved_model import Explicit
from dse.modelica.structure.rows import listed


@dataclass(frozen=True, slots=True)
class Known:
    """Parameters of *flat* and values at the start."""

    flat: FlatModel
    starts: Starts

    def is_parameter(self, symbol: Symbol) -> bool:
        """Whether *symbol* has its value before the initialization and keeps it."""
        if not symbol.is_variable or symbol.order:
            return False
        variable = self.flat.variables[symbol.name]
        return variable.role is Role.PARAMETER and not is_free(variable)

    def has_start(self, symbol: Symbol) -> bool:
        """Whether the model gives *symbol* a start value."""
        return not symbol.order and self.flat.variables[symbol.name].start is not None

    def of_parameters(self, *roots: Expression) -> bool:
        """Whether *roots* are made of numbers and parameters only."""
        return all(map(self.is_parameter, symbols(*roots)))

    def is_never_zero(self, factor: Expression) -> bool:
        """Whether one may divide by *factor*: a number but 0, made of parameters, or positive by its form.

        A parameter that starts at 0 counts as 0. If one is set to 0 later, that is told at run time, by a value that
        is not finite.
        """
        stack = [factor]
        while stack:
            node = stack.pop()
            if node.is_constant:
                if node.value == 0:
                    return False
            elif node.operator in ("multiply", "divide", "negate", "abs", "sqrt"):
                stack.extend(node.operands)
            elif node.operator == "power":
                stack.append(node.operands[0])
            elif node.operator == "if":
                stack.extend(node.operands[1:])
            elif node.operator not in ("exp", "cosh") and not (
                self.of_parameters(node) and evaluate((node,), self.starts.of)[0] != 0
            ):
                return False
        return True


def is_dependent(variable: Variable) -> bool:
    """Whether *variable* is a parameter that follows from others and cannot be set."""
    return variable.role is Role.PARAMETER and variable.binding is not None and not variable.binding.is_constant


def is_free(variable: Variable) -> bool:
    """Whether *variable* is a parameter that the initial equations determine."""
    return variable.role is Role.PARAMETER and variable.binding is None and not variable.is_fixed


def dependent_parameters(flat: FlatModel) -> list[Explicit]:
    """Dependent parameters, each after those it needs.

    Raises DseError for parameters that depend on each other, on themselves or on what is no parameter.
    """
    bindings = {
        Symbol(name): variable.binding
        for name, variable in flat.variables.items()
        if variable.binding is not None and is_dependent(variable)
    }
    number = {symbol: place for place, symbol in enumerate(bindings)}
    needs: list[list[int]] = []
    problems: list[Problem] = []
    for parameter, binding in bindings.items():
        refers = symbols(binding)
        strange = [
            one
            for one in refers
            if not (one.is_variable and not one.order and flat.variables[one.name].role is Role.PARAMETER)
        ]
        if strange:
            what = f"the parameter '{parameter}' depends on {listed(strange)}, which is not a parameter"
            problems.append(Problem(what, flat.variables[parameter.name].where))
        needs.append([number[symbol] for symbol in refers if symbol in number])
    order: list[Explicit] = []
    parameters = list(bindings)
    for component in components(needs):
        own = [parameters[place] for place in component]
        if len(own) > 1 or component[0] in needs[component[0]]:
            what = f"parameters depend on themselves: {listed(own)}"
            problems.append(Problem(what, flat.variables[own[0].name].where))
        order.extend(Explicit(symbol, bindings[symbol]) for symbol in own)
    raise_if_any(problems)
    return order


class Starts:
    """The value of each symbol at the starting values, 0 where nothing is given; of a pre-value its variable's.

    A held relation is its truth there. What does not come out finite counts as not given.
    """

    def __init__(self, flat: FlatModel, parameters: list[Explicit]) -> None:
        self._flat = flat
        self._known: dict[Symbol, float] = {}
        for variable in flat.variables.values():
            if variable.role is Role.PARAMETER and not is_dependent(variable):
                given = variable.start if variable.binding is None else variable.binding
                self._known[Symbol(variable.name)] = self._value(given, default(variable))
        for one in parameters:
            self._known[one.unknown] = self._value(one.value, 0.0)

    def of(self, symbol: Symbol) -> float:
        """The value of *symbol*."""
        if symbol not in self._known:
            self._known[symbol] = self._computed(symbol)
        return self._known[symbol]

    def _computed(self, symbol: Symbol) -> float:
        if symbol.referent is Referent.HELD:
            self._known[symbol] = 0.0
            return self._value(self._flat.relations[int(symbol.name)].truth, 0.0)
        if symbol.referent not in (Referent.VARIABLE, Referent.PRE) or symbol.order:
            return 0.0
        variable = self._flat.variables[symbol.name]
        self._known[symbol] = default(variable)
        return self._value(variable.start, default(variable))

    def _value(self, given: Expression | None, default: float) -> float:
        value = default if given is None else evaluate((given,), self.of)[0]
        return value if math.isfinite(value) else default


def default(variable: Variable) -> float:
    """The start value of *variable* if none is given."""
    if variable.kind is ScalarType.ENUMERATION:
        return 1.0
    for bound, is_below in ((variable.minimum, False), (variable.maximum, True)):
        # Without a start value it is 0, or the bound next to it (Modelica 3.6, 4.9).
        if bound is not None and bound.is_constant and (bound.value < 0 if is_below else bound.value > 0):
            return bound.value
    return 0.0
