"""A space as a model of OR-tools CP-SAT: one Boolean for each value, tables and clauses as clauses, sums as they are.

A `Wide` rule has no such form. What breaks it is cut off: the box of its folds around a row that breaks it, grown as
far as the rule surely fails, becomes one more clause, and the model is solved again.

Example: x in {1, 2, 4}, y in {1, 3}, x / y <= 1; the least -x is wanted.

    x = 4, y = 1 breaks the rule, and so does all of x >= 4, y <= 3: add "x <= 3 or y >= 4"
    x = 2, y = 1 breaks it, and so does all of x >= 2, y <= 1: add "x <= 1 or y >= 2"
    x = 2, y = 3 meets it, and is the best of what is left

Exact: all numbers are whole (`Linear`, `Fold`), and every row is checked again. One worker and one seed: the same
model has the same answer. The budget is CP-SAT's deterministic time, which counts work and no seconds.
"""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from math import ceil, gcd
from types import ModuleType
from typing import TYPE_CHECKING, assert_never

import numpy as np

from dse.errors import fail
from dse.space.flat import (
    ABSENT,
    NO_OWNER,
    NO_VALUE,
    Bools,
    Clause,
    FlatSpace,
    Fold,
    Gather,
    Ints,
    Linear,
    Rows,
    Table,
    Wide,
)
from dse.space.lowering.cliques import with_cliques
from dse.space.methods.budget import TooMuchError
from dse.space.methods.dnnf.cnf import boxes
from dse.space.methods.listing.recheck import recheck
from dse.space.methods.mdd.folds import fold_rows, is_bounded, judged

if TYPE_CHECKING:
    from ortools.sat.python import cp_model

    Callback = cp_model.CpSolverSolutionCallback

_SEED = 1

_LARGEST = 1 << 56
"""What a sum may come to in CP-SAT, whose own sums of sums must stay within 64 bits."""

Weights = Mapping[int, Ints]


@dataclass(slots=True)
class Budget:
    """What one question may still cost: deterministic *time* of CP-SAT, of the order of seconds, and boxes cut off."""

    time: float = 300.0
    cuts: int = 2_000


@dataclass(frozen=True, slots=True)
class SolverProgress:
    """The least sum *found* so far, None before the first row, and the *bound* that none is below."""

    found: int | None
    bound: int


Tell = Callable[[SolverProgress], None]


class UnprovenError(TooMuchError):
    """The budget is spent: *progress* is how far the solver came, None if no sum was asked for."""

    def __init__(self, progress: SolverProgress | None = None) -> None:
        super().__init__()
        self.progress = progress


class SolverModel:
    """The valid rows of *flat*; what is added leaves fewer of them.

    Raises DseError if OR-tools is not installed, or if the numbers of a rule are too large for it. Where *switched*,
    the rules of a constraint hold only as far as `blamed` assumes them.
    """

    def __init__(self, flat: FlatSpace, *, switched: bool = False) -> None:
        self.flat = flat
        self._model = cp_sat().CpModel()
        self._recheck = recheck(flat)
        owners = {rule.owner for rule in flat.rules} - {NO_OWNER} if switched else set()
        self._switches = {owner: self._model.new_bool_var("") for owner in sorted(owners)}
        self._taken: list[list[cp_model.LiteralT]] = []
        for number in range(len(flat.variables)):
            self._taken.append(self._decision(number))
        # Owners of what is merged are lost, and nothing switches a rule without one.
        for rule in flat.rules if switched else with_cliques(flat).rules:
            match rule:
                case Clause():
                    self._add_clause(rule.literals, rule.owner)
                case Table():
                    for box in boxes(flat, rule):
                        self._add_clause([(number, ~mask) for number, mask in box], rule.owner)
                case Linear():
                    self.add_bounds(rule.weights, rule.low, rule.high, rule.owner)
                case Wide():
                    pass  # cut off where a row breaks it
                case _:
                    assert_never(rule)

    def copy(self) -> SolverModel:
        """The same rows; what is added to the copy is not added here."""
        other = object.__new__(SolverModel)
        other.__dict__.update(self.__dict__)
        other._model = self._model.clone()
        return other

    def add_bounds(self, weights: Weights, low: int | None, high: int | None, owner: int = NO_OWNER) -> None:
        """The sum of weights[variable][value] is at least *low* and at most *high*, None for no bound."""
        total = self._sum(weights, owner)
        if low is not None:
            self._enforced(self._model.add(total >= low), owner)
        if high is not None:
            self._enforced(self._model.add(total <= high), owner)

    def add_other(self, row: Rows) -> None:
        """Any row but *row*, shape (variables,)."""
        self._model.add_bool_or([~self._taken[number][value] for number, value in enumerate(row.tolist())])

    def least(
        self, weights: Weights | None = None, budget: Budget | None = None, tell: Tell | None = None
    ) -> Rows | None:
        """A row of least sum of weights[variable][value], which is proven; any row without *weights*.

        Shape (variables,); None if there is no row. Raises UnprovenError when the *budget* is spent.
        """
        budget = budget or Budget()
        unit = 1
        if weights:
            unit = gcd(*(weight for values in weights.values() for weight in values.tolist())) or 1
            self._model.minimize(self._sum({number: values // unit for number, values in weights.items()}, NO_OWNER))
        try:
            listener = None if tell is None else _listener(tell, unit)
            while (solver := self._solved(budget, unit if weights else None, listener)) is not None:
                row = self._row(solver)
                if not self._cut_off(row, budget):
                    valid: Rows = self._recheck.insist(row[None, :])[0]
                    return valid
            return None
        finally:
            self._model.clear_objective()

    def rows(self, number: int, budget: Budget | None = None) -> tuple[Rows, bool]:
        """The first *number* rows in an order that is always the same, and whether these are all.

        Shape (rows, variables). Raises UnprovenError when the *budget* is spent.
        """
        found: list[Rows] = []
        solver = cp_sat().CpSolver()
        solver.parameters.enumerate_all_solutions = True

        def keep(row: Callback) -> None:
            one = self._row(row)
            if self._recheck.valid(one[None, :]).all():
                found.append(one)
            if len(found) == number:
                row.stop_search()

        budget = budget or Budget()
        is_complete = self._solved(budget, None, _callback(keep), solver) is None
        is_complete = is_complete or solver.response_proto.status == cp_sat().OPTIMAL
        if not is_complete and len(found) < number:
            raise _ended(budget)
        return np.array(found, np.int16).reshape(len(found), len(self.flat.variables)), is_complete

    def blamed(self, owners: Sequence[int], budget: Budget) -> list[int] | None:
        """Those of *owners* whose rules cannot be met together, ascending, perhaps more than needed; None if all can.

        For a model that is *switched*. Raises UnprovenError when the *budget* is spent.
        """
        numbers = {self._switches[owner].index: owner for owner in owners}
        self._model.clear_assumptions()
        self._model.add_assumptions([self._switches[owner] for owner in owners])
        while True:
            solver = cp_sat().CpSolver()
            if self._solved(budget, None, None, solver) is None:
                return sorted(numbers[index] for index in solver.sufficient_assumptions_for_infeasibility())
            if not self._cut_off(self._row(solver), budget, owners):
                return None

    def _decision(self, number: int) -> list[cp_model.LiteralT]:
        """The literals of the values of a variable, that of `ABSENT` last."""
        model, variable = self._model, self.flat.variables[number]
        exists = None if variable.parent is None else self._taken[variable.parent[0]][variable.parent[1]]
        absent: cp_model.LiteralT = model.new_constant(0) if exists is None else ~exists
        if len(variable.values) == 1:
            return [~absent, absent]
        if len(variable.values) == 2 and exists is None:
            one = model.new_bool_var("")
            return [one, ~one, absent]
        values: list[cp_model.LiteralT] = [*(model.new_bool_var("") for _ in variable.values), absent]
        model.add_exactly_one(values)
        return values

    def _add_clause(self, literals: Sequence[tuple[int, Bools]], owner: int, *more: cp_model.LiteralT) -> None:
        """One of *literals* or *more* holds, if the rules of *owner* do."""
        found = list(more)
        for number, mask in literals:
            taken = self._taken[number]
            barred = np.flatnonzero(~mask).tolist()
            if not barred:
                return
            found += (
                [~taken[barred[0]]] if len(barred) == 1 else [taken[value] for value in np.flatnonzero(mask).tolist()]
            )
        self._enforced(self._model.add_bool_or(found), owner)

    def _enforced(self, constraint: cp_model.Constraint, owner: int) -> None:
        if owner in self._switches:
            constraint.only_enforce_if(self._switches[owner])

    def _sum(self, weights: Weights, owner: int) -> cp_model.LinearExprT:
        if sum(int(np.abs(values).max()) for values in weights.values()) > _LARGEST:
            of = f"constraint '{self.flat.constraints[owner].name}'" if owner != NO_OWNER else "the objective"
            raise fail(f"the numbers of {of} have too many digits", hint="round the properties it is made of")
        terms = [
            (literal, weight)
            for number, values in weights.items()
            for literal, weight in zip(self._taken[number], values.tolist(), strict=True)
            if weight
        ]
        found: cp_model.LinearExprT = cp_sat().LinearExpr.weighted_sum(
            [literal for literal, _ in terms], [weight for _, weight in terms]
        )
        return found

    def _solved(
        self, budget: Budget, unit: int | None, listener: Callback | None, solver: cp_model.CpSolver | None = None
    ) -> cp_model.CpSolver | None:
        """A solver that has a row, None if there is none; *unit* is that of the objective, None without one."""
        cp_model = cp_sat()
        solver = solver or cp_model.CpSolver()
        solver.parameters.num_workers = 1
        solver.parameters.random_seed = _SEED
        solver.parameters.max_deterministic_time = budget.time
        # All rules in linear programs: nothing else proved optima of 60 places with one worker.
        solver.parameters.linearization_level = 2
        status = solver.solve(self._model, listener)
        budget.time -= solver.deterministic_time
        if status == cp_model.INFEASIBLE:
            return None
        if status == cp_model.OPTIMAL or (unit is None and status == cp_model.FEASIBLE):
            return solver
        if unit is None:
            raise _ended(budget)
        found = unit * round(solver.objective_value) if status == cp_model.FEASIBLE else None
        raise _ended(budget, SolverProgress(found, unit * ceil(solver.best_objective_bound)))

    def _row(self, solver: cp_model.CpSolver | Callback) -> Rows:
        places = [next(place for place, one in enumerate(taken) if solver.boolean_value(one)) for taken in self._taken]
        lengths = [len(taken) - 1 for taken in self._taken]
        return np.array([ABSENT if p == length else p for p, length in zip(places, lengths, strict=True)], np.int16)

    def _cut_off(self, row: Rows, budget: Budget, owners: Sequence[int] | None = None) -> bool:
        """Leave out what breaks a `Wide` rule, of *owners* if given, as *row* does; whether it breaks one."""
        is_broken = False
        for wide in self.flat.wides():
            if owners is not None and wide.owner not in (NO_OWNER, *owners):
                continue
            folds = [fold_rows(fold, row[None, :]) for fold in wide.folds]
            if judged(wide, folds).all():
                continue
            is_broken = True
            budget.cuts -= 1
            if budget.cuts < 0:
                raise UnprovenError
            literals: dict[int, Bools] = {}
            outside: list[cp_model.LiteralT] = []
            for fold, (low, high) in zip(wide.folds, _failing(wide, [int(fold[0]) for fold in folds]), strict=True):
                if fold.gather is Gather.SUM:
                    outside += self._beyond(fold, low, high, wide.owner)
                else:
                    for number, mask in _witness(fold, row, low, high):
                        literals[number] = literals.get(number, np.zeros(len(mask), np.bool_)) | ~mask
            self._add_clause(list(literals.items()), wide.owner, *outside)
        return is_broken

    def _beyond(self, fold: Fold, low: int, high: int, owner: int) -> list[cp_model.LiteralT]:
        """Literals that say that a summed fold is below *low* or above *high*."""
        total = self._sum(fold.values, owner)
        below, above = self._model.new_bool_var(""), self._model.new_bool_var("")
        self._model.add(total <= low - fold.start - 1).only_enforce_if(below)
        self._model.add(total >= high - fold.start + 1).only_enforce_if(above)
        return [below, above]


@cache
def cp_sat() -> ModuleType:
    """The module `ortools.sat.python.cp_model`. Raises DseError if it is not installed."""
    try:
        from ortools.sat.python import cp_model
    except ImportError:
        python = f"{platform.python_implementation()} {platform.python_version()} on {platform.system()}"
        hint = f"python -m pip install 'dse-workbench[solver]'; this is {python}, for which OR-tools must have a wheel"
        raise fail("this needs the package ortools, which is not installed", hint=hint) from None
    return cp_model


def is_installed() -> bool:
    """Whether OR-tools can be imported; it is not imported for that."""
    return find_spec("ortools") is not None


def _ended(budget: Budget, progress: SolverProgress | None = None) -> BaseException:
    """Why the solver ended early: CP-SAT takes the interrupt of the keyboard for itself."""
    return UnprovenError(progress) if budget.time <= 0 else KeyboardInterrupt()


def _listener(tell: Tell, unit: int) -> Callback:
    return _callback(
        lambda row: tell(SolverProgress(unit * round(row.objective_value), unit * ceil(row.best_objective_bound)))
    )


def _callback(call: Callable[[Callback], None]) -> Callback:
    """What CP-SAT calls with each row that it finds."""

    class Listener(cp_sat().CpSolverSolutionCallback):  # type: ignore[misc]
        def on_solution_callback(self) -> None:
            call(self)

    return Listener()


def _failing(wide: Wide, folds: Sequence[int]) -> list[tuple[int, int]]:
    """Ends of each fold between which the rule surely fails, around *folds* of a row that breaks it."""
    ends = [(value, value) for value in folds]
    if not is_bounded(wide):
        return ends
    for place, fold in enumerate(wide.folds):
        if fold.gather is Gather.PRODUCT or folds[place] == NO_VALUE:
            continue
        for side, end in enumerate(_ends(fold)):
            ends[place] = _furthest(wide, ends, place, side, end)
    return ends


def _furthest(wide: Wide, ends: Sequence[tuple[int, int]], place: int, side: int, end: int) -> tuple[int, int]:
    """The ends of the fold at *place*, with that on one *side* moved towards *end* as far as the rule surely fails."""

    def moved(to: int) -> list[tuple[int, int]]:
        own = (to, ends[place][1]) if side == 0 else (ends[place][0], to)
        return [own if other == place else pair for other, pair in enumerate(ends)]

    def fails(to: int) -> bool:
        low, high = ([np.array([pair[at]], np.int64) for pair in moved(to)] for at in (0, 1))
        return not wide.judge.bounds(low, high)[0].any()

    good, bad = ends[place][side], end
    if fails(end):
        return moved(end)[place]
    while abs(bad - good) > 1:
        middle = (good + bad) // 2
        good, bad = (middle, bad) if fails(middle) else (good, middle)
    return moved(good)[place]


def _ends(fold: Fold) -> tuple[int, int]:
    """What the fold is at least and at most, if it is something."""
    parts = [values[values != NO_VALUE] for values in fold.values.values()]
    some = [part for part in parts if len(part)]
    if fold.gather is Gather.SUM:
        return fold.start + sum(int(part.min()) for part in some), fold.start + sum(int(part.max()) for part in some)
    every = [int(end) for part in some for end in (part.min(), part.max())]
    every += [] if fold.start == NO_VALUE else [fold.start]
    return min(every), max(every)


def _witness(fold: Fold, row: Rows, low: int, high: int) -> list[tuple[int, Bools]]:
    """What variables may take so that the fold, which is no sum, stays in [low, high] as that of *row* does."""
    if fold.gather is Gather.PRODUCT:
        return [(number, values == values[row[number]]) for number, values in fold.values.items()]
    is_least = fold.gather is Gather.MIN
    found = []
    # One contribution that reaches the nearer end is enough, none may pass the farther one.
    waiting = low != NO_VALUE and not (fold.start != NO_VALUE and low <= fold.start <= high)
    for number, values in fold.values.items():
        nothing = values == NO_VALUE
        within = (values >= low) if is_least else (values <= high)
        mask = nothing if low == NO_VALUE else nothing | within
        taken = int(values[row[number]])
        if waiting and taken != NO_VALUE and low <= taken <= high:
            mask = ~nothing & (values >= low) & (values <= high)
            waiting = False
        found.append((number, mask))
    return found
