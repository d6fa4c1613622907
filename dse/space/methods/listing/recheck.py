"""Whether complete rows are valid, from the rules themselves and nothing that was compiled from them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce

import numpy as np

from dse.space.flat import ABSENT, Bools, FlatSpace, Linear, Rows, Rule, Table
from dse.space.methods.mdd.folds import fold_rows, judged


@dataclass(frozen=True, slots=True, eq=False)
class Recheck:
    """The rules of a space, ready to be asked of many rows: tables over the same variables are one."""

    flat: FlatSpace
    tables: tuple[Table, ...]

    def valid(self, rows: Rows) -> Bools:
        """Which rows meet the hierarchy and every rule, in exact arithmetic; shape (rows,)."""
        # In the order of the list most decisions are the same throughout a block: what depends on these
        # alone is decided by one row.
        answer = np.ones(len(rows), np.bool_)
        if not len(rows):
            return answer
        columns = np.ascontiguousarray(rows.T)
        varies = (columns != columns[:, :1]).any(axis=1)
        self._hierarchy(columns, varies, answer)
        for table in self.tables:
            if not table.scope:
                answer &= bool(table.allowed)
            elif varies[list(table.scope)].any():
                answer &= _allowed(table, columns)
            else:
                answer &= _allowed(table, columns[:, :1])
        for clause in self.flat.clauses():
            answer &= reduce(np.logical_or, (mask[columns[variable]] for variable, mask in clause.literals), False)
        for linear in self.flat.linears():
            answer &= _within(linear, columns, varies)
        for wide in self.flat.wides():
            left = np.flatnonzero(answer)
            answer[left] = judged(wide, [fold_rows(fold, rows[left]) for fold in wide.folds])
        return answer

    def _hierarchy(self, columns: Rows, varies: Bools, answer: Bools) -> None:
        for number, variable in enumerate(self.flat.variables):
            column = columns[number] if varies[number] else columns[number, :1]
            if variable.parent is None:
                answer &= (column >= 0) & (column < len(variable.values))
                continue
            parent, value = variable.parent
            above = columns[parent] if varies[parent] else columns[parent, :1]
            exists = (column >= 0) & (column < len(variable.values))
            answer &= np.where(above == value, exists, column == ABSENT)

    def insist(self, rows: Rows) -> Rows:
        """*rows* again. Raises RuntimeError that names the rule if one is not valid: the engine has a fault."""
        answer = self.valid(rows)
        if answer.all():
            return rows
        row = rows[~answer][:1]
        raise RuntimeError(f"internal error: {self.flat.name}: row {row[0].tolist()} breaks {_broken(self.flat, row)}")


def recheck(flat: FlatSpace) -> Recheck:
    """The checker of the rows of a space."""
    merged: dict[tuple[int, ...], Table] = {}
    for table in flat.tables():
        before = merged.get(table.scope)
        allowed = table.allowed if before is None else before.allowed & table.allowed
        merged[table.scope] = Table(table.scope, allowed, table.owner)
    return Recheck(flat, tuple(merged.values()))


def valid(flat: FlatSpace, rows: Rows) -> Bools:
    """Which rows meet the hierarchy and every rule of the space, in exact arithmetic; shape (rows,)."""
    return recheck(flat).valid(rows)


def _allowed(table: Table, columns: Rows) -> Bools:
    found: Bools = table.allowed[tuple(columns[variable] for variable in table.scope)]
    return found


def _within(linear: Linear, columns: Rows, varies: Bools) -> Bools:
    total = np.zeros(columns.shape[1], np.int64)
    fixed = 0
    for variable, weights in linear.weights.items():
        if varies[variable]:
            total += weights[columns[variable]]
        else:
            fixed += int(weights[columns[variable, 0]])
    total += fixed
    answer = np.ones(len(total), np.bool_)
    if linear.low is not None:
        answer &= total >= linear.low
    if linear.high is not None:
        answer &= total <= linear.high
    return answer


def _broken(flat: FlatSpace, row: Rows) -> str:
    for number, rule in enumerate(flat.rules):
        if not valid(_alone(flat, rule), row)[0]:
            kind = type(rule).__name__.lower()
            named = 0 <= rule.owner < len(flat.constraints)
            return f"constraint '{flat.constraints[rule.owner].name}'" if named else f"rule {number}, a {kind}"
    return "the hierarchy"


def _alone(flat: FlatSpace, rule: Rule) -> FlatSpace:
    return FlatSpace(flat.name, flat.variables, flat.constraints, (rule,))
