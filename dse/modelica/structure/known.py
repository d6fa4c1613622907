"""What is known before a run: which symbols are parameters, and the values everything has at the start."""

from __future__ import annotations

from dataclasses import dataclass

from dse.modelica.algebra.evaluate import evaluate
from dse.modelica.algebra.expression import Expression, Place, Symbol
from dse.modelica.flat import FlatModel, Role
from dse.modelica.structure.incidence import occurring
from dse.modelica.structure.parameters import Starts, is_free


@dataclass(frozen=True, slots=True)
class Known:
    """Parameters of *flat* and values at the start."""

    flat: FlatModel
    starts: Starts

    def is_parameter(self, symbol: Symbol) -> bool:
        """Whether *symbol* has its value before the initialization and keeps it."""
        if symbol.place is not Place.VARIABLE or symbol.order:
            return False
        variable = self.flat.variables[symbol.name]
        return variable.role is Role.PARAMETER and not is_free(variable)

    def has_start(self, symbol: Symbol) -> bool:
        """Whether the model gives *symbol* a start value."""
        return not symbol.order and self.flat.variables[symbol.name].start is not None

    def of_parameters(self, *roots: Expression) -> bool:
        """Whether *roots* are made of numbers and parameters only."""
        return all(map(self.is_parameter, occurring(*roots)))

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
                self.of_parameters(node) and evaluate((node,), self.starts)[0] != 0
            ):
                return False
        return True
