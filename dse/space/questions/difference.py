"""What two design spaces have in common, and what only one of them has."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import (
    ABSENT,
    NO_OWNER,
    NO_VALUE,
    Clause,
    FlatSpace,
    Fold,
    Gather,
    Ints,
    Linear,
    Rule,
    Table,
    Variable,
    Wide,
    single,
)
from dse.space.methods.engine import Engine
from dse.space.methods.tally import Tally


@dataclass(frozen=True, slots=True)
class Difference:
    """Alternatives as (path, choice), None for leaving a part out; constraints by name; configurations by number.

    *changed*: constraints of one name that say different things. *common* configurations make the same choices.
    """

    removed: tuple[tuple[str, str | None], ...]
    added: tuple[tuple[str, str | None], ...]
    constraints_removed: tuple[str, ...]
    constraints_added: tuple[str, ...]
    changed: tuple[str, ...]
    before: Tally
    after: Tally
    common: Tally


def difference(old: Engine, new: Engine, seed: int = 0) -> Difference:
    """How *new* differs from *old*. Raises DseError if nothing can be counted."""
    gone, fresh = _alternatives(old.flat), _alternatives(new.flat)
    old_rules, new_rules = _texts(old.flat), _texts(new.flat)
    return Difference(
        tuple(entry for entry in gone if entry not in fresh),
        tuple(entry for entry in fresh if entry not in gone),
        tuple(name for name in old_rules if name not in new_rules),
        tuple(name for name in new_rules if name not in old_rules),
        tuple(name for name, text in old_rules.items() if new_rules.get(name, text) != text),
        old.count(seed),
        new.count(seed),
        Engine(overlay(old.flat, new.flat), old).count(seed),
    )


def _alternatives(flat: FlatSpace) -> dict[tuple[str, str | None], None]:
    return {(variable.path, value): None for variable in flat.variables for value in variable.values}


def _texts(flat: FlatSpace) -> Mapping[str, str]:
    return {constraint.name: constraint.rule.text for constraint in flat.constraints}


@dataclass(frozen=True, slots=True, eq=False)
class _View:
    """A variable of the other space as seen here: *values*[value of *variable*] is its value there.

    Without a variable it always has the one value.
    """

    variable: int | None
    values: NDArray[np.intp]


def overlay(here: FlatSpace, there: FlatSpace) -> FlatSpace:
    """*here* with further rules, so that its rows are those that make the same choices as a row of *there*."""
    numbers = {_signature(here, number): number for number in range(len(here.variables))}
    rules: list[Rule] = []
    views: list[_View] = []
    for number, variable in enumerate(there.variables):
        own = numbers.pop(_signature(there, number), None)
        if own is None:
            views.append(_unseen(views, variable, rules))
        else:
            views.append(_seen(own, here.variables[own], variable, rules))
    for own in numbers.values():
        # A decision that the other space does not have: only what leaves its part out can be in both.
        left_out = [value is None for value in here.variables[own].values]
        rules.append(single(own, np.array([*left_out, True])))
    translated = [_translated(rule, views, here) for rule in there.rules]
    return here.having(*rules, *translated)


def _signature(flat: FlatSpace, number: int) -> tuple[tuple[str, str | None], ...]:
    """The path of a variable and the choices that make it exist, which tell it from others of its path."""
    variable = flat.variables[number]
    steps: list[tuple[str, str | None]] = [(variable.path, None)]
    while variable.parent is not None:
        number, value = variable.parent
        variable = flat.variables[number]
        steps.append((variable.path, variable.values[value]))
    return tuple(steps)


def _seen(own: int, here: Variable, there: Variable, rules: list[Rule]) -> _View:
    places = [there.values.index(value) if value in there.values else ABSENT for value in here.values]
    rules.append(single(own, np.array([*(place != ABSENT for place in places), True])))
    return _View(own, np.array([*places, ABSENT]))


def _unseen(views: list[_View], there: Variable, rules: list[Rule]) -> _View:
    """A variable that does not exist here: left out wherever it exists there, which must be possible."""
    left_out = there.values.index(None) if None in there.values else ABSENT
    if there.parent is None:
        if left_out == ABSENT:
            rules.append(Table((), np.array(False)))
        return _View(None, np.array([left_out]))
    parent = views[there.parent[0]]
    exists = parent.values == there.parent[1]
    if left_out == ABSENT and exists.any():
        if parent.variable is None:
            rules.append(Table((), np.array(False)))
        else:
            rules.append(single(parent.variable, ~exists))
    return _View(parent.variable, np.where(exists, left_out, ABSENT))


def _translated(rule: Rule, views: list[_View], here: FlatSpace) -> Rule:
    match rule:
        case Table():
            return _table(rule, views)
        case Clause():
            # A clause is the opposite of "no literal holds", which is a sum of truth values here.
            weights = {variable: mask.astype(np.int64) - int(mask[-1]) for variable, mask in rule.literals}
            constant = sum(int(mask[-1]) for _, mask in rule.literals)
            return _linear(Linear(weights, 1 - constant, None), views, here)
        case Linear():
            return _linear(rule, views, here)
        case Wide():
            return Wide(tuple(_fold(fold, views, here) for fold in rule.folds), rule.judge)


def _table(table: Table, views: list[_View]) -> Table:
    seen = [views[number] for number in table.scope]
    scope = tuple(sorted({view.variable for view in seen if view.variable is not None}))
    index = []
    for view in seen:
        shape = [1] * len(scope)
        if view.variable is not None:
            shape[scope.index(view.variable)] = len(view.values)
        index.append(view.values.reshape(shape))
    allowed = np.asarray(table.allowed[tuple(index)]) if index else table.allowed
    return Table(scope, allowed.reshape(allowed.shape if scope else ()), NO_OWNER)


def _linear(linear: Linear, views: list[_View], here: FlatSpace) -> Linear:
    weights, constant = _gathered(linear.weights, views, here)
    low = None if linear.low is None else linear.low - constant
    high = None if linear.high is None else linear.high - constant
    return replace(linear, weights=weights, low=low, high=high, owner=NO_OWNER)


def _fold(fold: Fold, views: list[_View], here: FlatSpace) -> Fold:
    if fold.gather is Gather.SUM:
        values, constant = _gathered(fold.values, views, here)
        return replace(fold, values=values, start=fold.start + constant)
    # What is left out contributes nothing, so only variables that exist here matter.
    values = {}
    for number, there in fold.values.items():
        view = views[number]
        seen = there[view.values]
        if view.variable is not None and (seen != NO_VALUE).any():
            values[view.variable] = seen
    return replace(fold, values=values)


def _gathered(weights: Mapping[int, Ints], views: list[_View], here: FlatSpace) -> tuple[dict[int, Ints], int]:
    found: dict[int, Ints] = {}
    constant = 0
    for number, there in weights.items():
        view = views[number]
        if view.variable is None:
            constant += int(there[view.values[0]])
            continue
        known = found.setdefault(view.variable, np.zeros(len(here.variables[view.variable].values) + 1, np.int64))
        known += there[view.values]
    return found, constant
