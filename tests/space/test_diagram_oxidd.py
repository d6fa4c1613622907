"""Counts of spaces too large for brute force, against the binary decision diagrams of OxiDD."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from dse.space.flat import Bools, Clause, FlatSpace, Rule, Table, Variable
from dse.space.methods.mdd.diagram import compile_diagram, count, occurrences

bdd: Any = pytest.importorskip("oxidd.bdd")


class Formula:
    """The space over one Boolean for each value of each variable, existence spelled out; ABSENT is none of them."""

    def __init__(self, space: FlatSpace) -> None:
        self.manager = bdd.BDDManager(1 << 20, 1 << 18, 1)
        self.manager.add_vars(sum(len(variable.values) for variable in space.variables))
        self.taken: list[list[Any]] = []  # by variable and value, ABSENT last
        first = 0
        for variable in space.variables:
            literals = [self.manager.var(first + value) for value in range(len(variable.values))]
            first += len(literals)
            none = self.manager.true()
            for literal in literals:
                none &= ~literal
            self.taken.append([*literals, none])
        self.rows = self.manager.true()
        for number, variable in enumerate(space.variables):
            for value, one in enumerate(self.taken[number][:-1]):
                for other in self.taken[number][:value]:
                    self.rows &= ~(one & other)
            exists = self.manager.true()
            if variable.parent is not None:
                exists = self.taken[variable.parent[0]][variable.parent[1]]
            self.rows &= self.taken[number][-1].equiv(~exists)
        for rule in (*space.tables(), *space.clauses()):
            self.rows &= self.table(rule) if isinstance(rule, Table) else self.clause(rule)

    def table(self, table: Table) -> Any:
        found = self.manager.false()
        for entry in np.argwhere(table.allowed).tolist():
            case = self.manager.true()
            for number, value in zip(table.scope, entry, strict=True):
                case &= self.taken[number][value]
            found |= case
        return found

    def clause(self, clause: Clause) -> Any:
        found = self.manager.false()
        for number, mask in clause.literals:
            for value in np.flatnonzero(mask).tolist():
                found |= self.taken[number][value]
        return found

    def count(self, *further: Any) -> int:
        rows = self.rows
        for formula in further:
            rows &= formula
        return int(rows.sat_count(self.manager.num_vars()))


def random_space(seed: int) -> FlatSpace:
    """Forty decisions, a third of them below others, and rules among decisions that are near each other."""
    draw = np.random.default_rng(seed)
    variables: list[Variable] = []
    for number in range(40):
        parent = None
        if number and draw.random() < 0.35:
            above = int(draw.integers(max(0, number - 6), number))
            parent = above, int(draw.integers(len(variables[above].values)))
        variables.append(Variable(f"x{number}", tuple(f"v{n}" for n in range(draw.integers(2, 5))), parent))
    rules: list[Rule] = []
    for _ in range(30):
        start = int(draw.integers(0, 33))
        scope = tuple(sorted((start + draw.choice(7, draw.integers(2, 4), replace=False)).tolist()))
        sizes = [len(variables[number].values) + 1 for number in scope]
        if draw.random() < 0.5:
            rules.append(Table(scope, draw.random(sizes) < 0.85))
        else:
            masks: list[Bools] = [draw.random(size) < 0.6 for size in sizes]
            rules.append(Clause(tuple(zip(scope, masks, strict=True))))
    return FlatSpace("random", tuple(variables), (), tuple(rules))


@pytest.mark.parametrize("seed", range(12))
def test_counts_are_those_of_binary_decision_diagrams(seed: int) -> None:
    space = random_space(seed)
    formula = Formula(space)
    diagram = compile_diagram(space)
    assert count(diagram) == formula.count()
    found = occurrences(diagram)
    for number in (3, 20, 39):
        assert found[number] == tuple(formula.count(literal) for literal in formula.taken[number])


def test_the_random_spaces_are_large_and_mostly_not_empty() -> None:
    counts = [count(compile_diagram(random_space(seed))) for seed in range(12)]
    assert sum(number > 10**9 for number in counts) >= 8
