"""An oracle that shares nothing with the engine: OR-tools CP-SAT, one Boolean for each value of each variable."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from ortools.sat.python import cp_model

from dse.space.flat import ABSENT, Clause, FlatSpace, Ints, Linear, Rows, Table
from dse.space.methods.listing.recheck import recheck

Chosen = Sequence[Sequence["cp_model.LiteralT"]]
"""For each variable what says that it takes a value, `ABSENT` last."""


def optimum(flat: FlatSpace, weights: Mapping[int, Ints], *, largest: bool = False) -> tuple[Rows, int] | None:
    """A valid row, shape (variables,), of least (or largest) sum of weights[variable][value], and that sum."""
    model, chosen = _model(flat)
    total = _sum(weights, chosen)
    (model.maximize if largest else model.minimize)(total)
    row = _solution(flat, model, chosen)
    return None if row is None else (row, sum(int(values[row[variable]]) for variable, values in weights.items()))


def satisfiable(flat: FlatSpace) -> bool:
    """Whether any row is valid."""
    return _solution(flat, *_model(flat)) is not None


def _model(flat: FlatSpace) -> tuple[cp_model.CpModel, Chosen]:
    model = cp_model.CpModel()
    chosen: list[list[cp_model.LiteralT]] = []
    for variable in flat.variables:
        values: list[cp_model.LiteralT] = [model.new_bool_var("") for _ in variable.values]
        parent = variable.parent
        values.append(model.new_constant(0) if parent is None else ~chosen[parent[0]][parent[1]])
        model.add_exactly_one(values)
        chosen.append(values)
    for rule in flat.rules:
        match rule:
            case Table():
                for entry in np.argwhere(~rule.allowed).tolist():
                    model.add_bool_or([~chosen[n][value] for n, value in zip(rule.scope, entry, strict=True)])
            case Linear(weights, low, high):
                if low is not None:
                    model.add(_sum(weights, chosen) >= low)
                if high is not None:
                    model.add(_sum(weights, chosen) <= high)
            case Clause(literals):
                model.add_bool_or([chosen[n][value] for n, mask in literals for value in np.flatnonzero(mask).tolist()])
            case _:
                raise TypeError("CP-SAT is asked about logic and sums only")
    return model, chosen


def _sum(weights: Mapping[int, Ints], chosen: Chosen) -> cp_model.LinearExprT:
    terms = [
        (literal, int(weight))
        for variable, values in weights.items()
        for literal, weight in zip(chosen[variable], values.tolist(), strict=True)
        if weight
    ]
    return cp_model.LinearExpr.weighted_sum([literal for literal, _ in terms], [weight for _, weight in terms])


def _solution(flat: FlatSpace, model: cp_model.CpModel, chosen: Chosen) -> Rows | None:
    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = 1
    solver.parameters.max_deterministic_time = 600.0
    status = solver.solve(model)
    if status == cp_model.INFEASIBLE:
        return None
    assert status == cp_model.OPTIMAL
    row = np.array([_value(solver, values) for values in chosen], np.int16)
    checked: Rows = recheck(flat).insist(row[None, :])[0]
    return checked


def _value(solver: cp_model.CpSolver, values: Sequence[cp_model.LiteralT]) -> int:
    value = next(place for place, literal in enumerate(values) if solver.boolean_value(literal))
    return value if value < len(values) - 1 else ABSENT
