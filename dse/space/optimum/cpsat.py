"""A second opinion from OR-tools CP-SAT, the optional extra ``dse[solver]``: an optimum, and whether there is a row.

Nothing of the engine is shared: the model is made from the flat space, one Boolean for each value of each variable.
One worker and a fixed seed: the same question gets the same answer from the same version of OR-tools.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from dse.errors import fail
from dse.space.flat import ABSENT, NOBODY, FlatSpace, Ints, Linear, Rows, Rule, Table, Wide
from dse.space.listing.recheck import recheck

if TYPE_CHECKING:
    from ortools.sat.python import cp_model

MOST_WORK = 600.0
"""CP-SAT's deterministic time, about seconds, after which it is given up."""

_SEED = 1


def optimum(
    flat: FlatSpace, weights: Mapping[int, Ints], *, largest: bool = False, most_work: float = MOST_WORK
) -> tuple[Rows, int] | None:
    """A valid row, shape (variables,), of least (or largest) sum of weights[variable][value], and that sum.

    Weights are as in `Linear`. None if no row is valid. Which one of equally good rows it is depends on the version
    of OR-tools. Raises DseError without OR-tools, for wide rules, and if *most_work* is not enough.
    """
    model, chosen = _model(flat)
    total = _sum(weights, chosen)
    (model.maximize if largest else model.minimize)(total)
    row = _solution(flat, model, chosen, most_work)
    if row is None:
        return None
    return row, sum(int(values[row[variable]]) for variable, values in weights.items())


def satisfiable(flat: FlatSpace, most_work: float = MOST_WORK) -> bool:
    """Whether any row is valid. Raises like `optimum`."""
    model, chosen = _model(flat)
    return _solution(flat, model, chosen, most_work) is not None


Chosen = Sequence[Sequence["cp_model.LiteralT"]]
"""For each variable what says that it takes a value, `ABSENT` last."""


def _model(flat: FlatSpace) -> tuple[cp_model.CpModel, Chosen]:
    try:
        from ortools.sat.python import cp_model
    except ImportError as error:
        raise fail("OR-tools is not installed", hint="pip install 'dse-workbench[solver]'") from error
    if flat.wides():
        raise _refusal(flat, flat.wides()[0])
    model = cp_model.CpModel()
    chosen: list[list[cp_model.LiteralT]] = []
    for number, variable in enumerate(flat.variables):
        values: list[cp_model.LiteralT] = [
            model.new_bool_var(f"{number}:{value}") for value in range(len(variable.values))
        ]
        parent = variable.parent
        values.append(model.new_constant(0) if parent is None else ~chosen[parent[0]][parent[1]])
        model.add_exactly_one(values)
        chosen.append(values)
    for rule in flat.rules:
        _post(flat, model, chosen, rule)
    return model, chosen


def _post(flat: FlatSpace, model: cp_model.CpModel, chosen: Chosen, rule: Rule) -> None:
    match rule:
        case Table():
            for entry in _forbidden(rule):
                literals = [~chosen[variable][value] for variable, value in zip(rule.scope, entry, strict=True)]
                model.add_bool_or(literals)
        case Linear(weights, low, high):
            total = _sum(weights, chosen)
            if low is not None:
                model.add(total >= low)
            if high is not None:
                model.add(total <= high)
        case Wide():
            raise _refusal(flat, rule)
        case _:
            model.add_bool_or(
                [chosen[variable][value] for variable, mask in rule.literals for value in np.flatnonzero(mask).tolist()]
            )


def _forbidden(table: Table) -> Iterator[list[int]]:
    entries: list[list[int]] = np.argwhere(~table.allowed).tolist()
    yield from entries


def _sum(weights: Mapping[int, Ints], chosen: Chosen) -> cp_model.LinearExprT:
    from ortools.sat.python import cp_model

    terms = [
        (literal, int(weight))
        for variable, values in weights.items()
        for literal, weight in zip(chosen[variable], values.tolist(), strict=True)
        if weight
    ]
    return cp_model.LinearExpr.weighted_sum([literal for literal, _ in terms], [weight for _, weight in terms])


def _solution(flat: FlatSpace, model: cp_model.CpModel, chosen: Chosen, most_work: float) -> Rows | None:
    from ortools.sat.python import cp_model

    solver = cp_model.CpSolver()
    solver.parameters.num_workers = 1
    solver.parameters.random_seed = _SEED
    solver.parameters.max_deterministic_time = most_work
    status = solver.solve(model)
    if status == cp_model.INFEASIBLE:
        return None
    if status == cp_model.MODEL_INVALID:
        hint = "round the properties that are summed up"
        raise fail(f"the numbers of '{flat.name}' have too many digits for CP-SAT", None, hint)
    # A row that is only feasible satisfies nobody who asked for the optimum.
    if status != cp_model.OPTIMAL:
        raise fail(f"CP-SAT has not solved '{flat.name}' within its budget", None, "allow it more work")
    row = np.array([_value(solver, values) for values in chosen], np.int16)
    checked: Rows = recheck(flat).insist(row[None, :])[0]
    return checked


def _value(solver: cp_model.CpSolver, values: Sequence[cp_model.LiteralT]) -> int:
    value = next(place for place, literal in enumerate(values) if solver.boolean_value(literal))
    return value if value < len(values) - 1 else ABSENT


def _refusal(flat: FlatSpace, rule: Wide) -> Exception:
    named = rule.owner != NOBODY and rule.owner < len(flat.constraints)
    what = f"constraint '{flat.constraints[rule.owner].name}'" if named else f"a rule of '{flat.name}'"
    return fail(f"{what} is neither logical nor a sum, which is all that CP-SAT can be asked", None, "leave it out")
