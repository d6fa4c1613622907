"""A design space as the engine sees it: variables, and rules over them as tables, clauses and sums.

A row is one way to make the decisions: a vector of value numbers, one per variable, `ABSENT` where the
variable does not exist because another architecture was chosen. Arrays over the values of a variable have one
entry more than it has values; the last, which index -1 finds, belongs to `ABSENT`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import StrEnum
from fractions import Fraction
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from dse.domain.design import Constraint

ABSENT = -1
"""The value of a variable that does not exist."""

NO_OWNER = -1
"""Owner of a rule that belongs to the structure or to a question, not to a constraint of the user."""

Bools = NDArray[np.bool_]
Ints = NDArray[np.int64]
Floats = NDArray[np.float64]
Rows = NDArray[np.int16]
"""Shape (rows, variables)."""


@dataclass(frozen=True, slots=True)
class Variable:
    """A decision; value ``None`` leaves the part out. It exists iff variable *parent*[0] takes value *parent*[1]."""

    path: str
    values: tuple[str | None, ...]
    parent: tuple[int, int] | None = None


@dataclass(frozen=True, slots=True, eq=False)
class Table:
    """A rule over few variables: *allowed* has one axis of length values + 1 for each of *scope*, ascending.

    An empty scope and a false scalar say that nothing is allowed at all.
    """

    scope: tuple[int, ...]
    allowed: Bools
    owner: int = NO_OWNER


@dataclass(frozen=True, slots=True, eq=False)
class Clause:
    """At least one literal holds; a literal is a variable and the mask, shape (values + 1,), of what it may take.

    Variables ascend and are distinct.
    """

    literals: tuple[tuple[int, Bools], ...]
    owner: int = NO_OWNER


@dataclass(frozen=True, slots=True, eq=False)
class Linear:
    """low <= sum over variables of weights[variable][value] <= high, in whole numbers; None is no bound.

    Every weights array has shape (values + 1,) and its last entry is 0. *scale* is what one stands for in SI.
    All partial sums stay below 2^62.
    """

    weights: Mapping[int, Ints]
    low: int | None
    high: int | None
    owner: int = NO_OWNER
    scale: Fraction = field(default=Fraction(1))


class Gather(StrEnum):
    """How a `Fold` puts the contributions of what is chosen together."""

    SUM = "sum"
    MIN = "min"
    MAX = "max"
    PRODUCT = "product"


NO_VALUE = np.iinfo(np.int64).max
"""In a MIN, MAX or PRODUCT fold: the entry of a value that contributes nothing; also the fold of nothing at all."""


@dataclass(frozen=True, slots=True, eq=False)
class Fold:
    """A quantity gathered over what is chosen: *start*, and values[variable][value] of every variable.

    Whole numbers; one stands for *scale*, the fold of a PRODUCT of n contributions for scale^n. Those of a MIN or MAX
    may be ranks, which only their judge can turn into values.
    """

    gather: Gather
    values: Mapping[int, Ints]
    start: int
    scale: Fraction = field(default=Fraction(1))


class Judge(Protocol):
    """What a `Wide` rule says of its folds."""

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        """May hold, may fail, for folds known to lie in [low, high]; arrays of one shape. Never wrong, may be vague."""

    def holds(self, folds: Sequence[int]) -> bool:
        """Whether the rule holds for these folds, in exact arithmetic."""


@dataclass(frozen=True, slots=True, eq=False)
class Wide:
    """A rule over many variables that is no sum: roll-ups under conditions, ratios, products, extremes."""

    folds: tuple[Fold, ...]
    judge: Judge
    owner: int = NO_OWNER


Rule = Table | Clause | Linear | Wide


@dataclass(frozen=True, slots=True, eq=False)
class FlatSpace:
    """Variables, parents before children in the order of the file, and the rules that rows must meet.

    The hierarchy is not among the rules: a variable is `ABSENT` exactly when its parent says so.
    """

    name: str
    variables: tuple[Variable, ...]
    constraints: tuple[Constraint, ...]
    rules: tuple[Rule, ...]

    def tables(self) -> tuple[Table, ...]:
        """The rules over few variables."""
        return tuple(rule for rule in self.rules if isinstance(rule, Table))

    def clauses(self) -> tuple[Clause, ...]:
        """The rules that are clauses."""
        return tuple(rule for rule in self.rules if isinstance(rule, Clause))

    def linears(self) -> tuple[Linear, ...]:
        """The rules that are sums."""
        return tuple(rule for rule in self.rules if isinstance(rule, Linear))

    def wides(self) -> tuple[Wide, ...]:
        """The rules that are neither."""
        return tuple(rule for rule in self.rules if isinstance(rule, Wide))

    def only(self, owners: Collection[int]) -> FlatSpace:
        """With the rules of these constraints alone (numbers in *constraints*) and those that nobody owns."""
        return replace(self, rules=tuple(rule for rule in self.rules if rule.owner in owners or rule.owner == NO_OWNER))

    def having(self, *rules: Rule) -> FlatSpace:
        """With further rules."""
        return replace(self, rules=(*self.rules, *rules))

    def taking(self, variable: int, value: int) -> Table:
        """The rule that *variable* takes *value*; one more than its last stands for `ABSENT`."""
        mask = np.zeros(len(self.variables[variable].values) + 1, np.bool_)
        mask[value] = True
        return single(variable, mask)

    def row(self, choices: Mapping[str, str]) -> Rows:
        """Complete choices as a row, shape (variables,)."""
        row = np.full(len(self.variables), ABSENT, np.int16)
        for number, variable in enumerate(self.variables):
            if variable.parent is None or row[variable.parent[0]] == variable.parent[1]:
                row[number] = variable.values.index(choices.get(variable.path))
        return row

    def choices(self, row: Rows) -> dict[str, str]:
        """A row of shape (variables,) as choices; parts that are left out are not in it."""
        chosen: dict[str, str] = {}
        for variable, value in zip(self.variables, row.tolist(), strict=True):
            name = variable.values[value] if value != ABSENT else None
            if name is not None:
                chosen[variable.path] = name
        return chosen


def by_path(variables: Sequence[Variable]) -> dict[str, list[int]]:
    """The numbers of the variables of each path; several if architectures have decisions of one name."""
    found: dict[str, list[int]] = {}
    for number, variable in enumerate(variables):
        found.setdefault(variable.path, []).append(number)
    return found


def single(variable: int, allowed: Bools) -> Table:
    """The rule that *variable* takes one of *allowed*, a mask of shape (values + 1,)."""
    return Table((variable,), allowed)
