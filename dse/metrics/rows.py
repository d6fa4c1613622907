"""Expressions over parameters, computed for many points at once: what is derived, and which points are allowed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from dse.domain.component import Type
from dse.domain.expression import Expression
from dse.errors import fail
from dse.expression import error_in, require_number, require_truth
from dse.metrics.compiler import MetricCompiler
from dse.metrics.machine import MetricProgram
from dse.units import Dimension, describe

_NAME = "value"


@dataclass(frozen=True, slots=True)
class RowProgram:
    """An expression compiled; it needs *names*."""

    program: MetricProgram

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters it is computed from."""
        return self.program.signals

    def rows(self, columns: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
        """The value for each of the n rows of *columns* (SI, by name); 0 and 1 for truth values."""
        count = len(next(iter(columns.values()))) if columns else 1
        registers: list[Any] = self.program.registers(np.zeros(count), columns, {})
        return np.broadcast_to(np.asarray(registers[self.program.metrics[_NAME]], dtype=np.float64), (count,))


def compile_value(expression: Expression, types: Mapping[str, Type], wanted: Type) -> RowProgram:
    """*expression* over the parameters *types*, of the dimension of *wanted*. Raises DseError."""
    program, dimension = compile_number(expression, types)
    if dimension != wanted.unit.dimension:
        what = f"this is {describe(dimension)}, the parameter is {wanted}"
        raise error_in(expression, expression.root.span, what, "multiply or divide it by a number with a unit")
    return program


def compile_number(expression: Expression, types: Mapping[str, Type]) -> tuple[RowProgram, Dimension]:
    """*expression* over the parameters *types*, and the dimension it has. Raises DseError."""
    compiler = MetricCompiler(types, frozenset(types), (), {})
    sort, register = compiler.compile(expression, expression.root)
    require_number(expression, expression.root, sort)
    return _program(compiler, register), sort.dimension


def compile_rule(expression: Expression, types: Mapping[str, Type]) -> RowProgram:
    """A condition over the parameters *types*. Raises DseError."""
    compiler = MetricCompiler(types, frozenset(types), (), {})
    sort, register = compiler.compile(expression, expression.root)
    require_truth(expression, expression.root, sort)
    if not compiler.inputs:
        raise fail("this condition names no design variable", expression.where, "leave it out")
    return _program(compiler, register)


def _program(compiler: MetricCompiler, register: int) -> RowProgram:
    literals = tuple((at, value) for value, at in compiler.literals.items())
    instructions = tuple(compiler.instructions.values())
    names = tuple(compiler.inputs)
    return RowProgram(
        MetricProgram(names, (), {}, compiler.inputs, literals, instructions, {_NAME: register}, (), compiler.size)
    )
