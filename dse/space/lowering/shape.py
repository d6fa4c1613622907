"""The variables of a design space by number: how many values they take, and what they hang below."""

from __future__ import annotations

import heapq
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from dse.domain.design import DesignSpace
from dse.space.decisions import decisions, flat
from dse.space.flat import Bools, Variable

VariableValue = tuple[int, int]
"""A variable and one of its values."""


@dataclass(frozen=True, slots=True, eq=False)
class SpaceShape:
    """*widths* are the lengths of arrays over the values of each variable, one more than it has values."""

    variables: tuple[Variable, ...]
    widths: tuple[int, ...]

    def is_root(self, variable: int) -> bool:
        """Whether the variable always exists."""
        return self.variables[variable].parent is None

    def mask(self, variable: int, values: Iterable[int]) -> Bools:
        """True at *values*; shape (values + 1,)."""
        mask = np.zeros(self.widths[variable], bool)
        mask[list(values)] = True
        return mask

    def cells(self, scope: Iterable[int], most: int) -> bool:
        """Whether the variables of *scope* have at most *most* combinations of values."""
        product = 1
        for variable in scope:
            product *= self.widths[variable]
            if product > most:
                return False
        return True

    def is_certain(self, branches: Iterable[VariableValue]) -> bool:
        """Whether one of *branches* is taken in every row: each value of a root variable is one or leads to one."""
        taken: dict[int, set[int]] = {}
        for variable, value in branches:
            taken.setdefault(variable, set()).add(value)
        # Children come after their parents, so the last variable has nothing below it that is still to come.
        pending = [-variable for variable in taken]
        heapq.heapify(pending)
        while pending:
            variable = -heapq.heappop(pending)
            if len(taken[variable]) < self.widths[variable] - 1:
                continue
            parent = self.variables[variable].parent
            if parent is None:
                return True
            if parent[0] not in taken:
                heapq.heappush(pending, -parent[0])
            taken.setdefault(parent[0], set()).add(parent[1])
        return False


def shape_of(space: DesignSpace) -> SpaceShape:
    """The variables of *space*, one for each decision, numbered by its position."""
    variables: list[Variable] = []
    parents: dict[int, VariableValue] = {}
    for decision in flat(decisions(space)):
        for number, branch in enumerate(decision.branches):
            parents.update((below.position, (decision.position, number)) for below in branch.decisions)
        values = tuple(branch.choice for branch in decision.branches)
        variables.append(Variable(decision.path, values, parents.get(decision.position)))
    return SpaceShape(tuple(variables), tuple(len(variable.values) + 1 for variable in variables))
