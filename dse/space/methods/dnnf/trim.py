"""Trimming a space to what its rules can tell apart; what is cut off stays as numbers of ways to fill it in."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from dse.space.flat import Clause, FlatSpace, Linear, Rule, Table, Variable, Wide


class UnsupportedError(Exception):
    """A rule has no small form in clauses; internal, callers use another engine."""


@dataclass(frozen=True, slots=True, eq=False)
class Trimmed:
    """*core* keeps the variables that rules look at and those above them.

    Core variable i is variable *kept*[i] of *flat*; its value k stands for all the values *classes*[i][k], which no
    rule and no kept variable tells apart. Every row of *flat* belongs to exactly one row of *core*.
    """

    flat: FlatSpace
    core: FlatSpace
    kept: tuple[int, ...]
    classes: tuple[tuple[tuple[int, ...], ...], ...]


@dataclass(frozen=True, slots=True)
class ValueWays:
    """In how many ways what was cut off can be filled in.

    *below*[variable][value] of the whole space counts what hangs below a value;
    *classes*[variable][value] of the core sums it over a class; *apart* belongs to the trees cut off as a whole.
    """

    below: tuple[tuple[int, ...], ...]
    classes: tuple[tuple[int, ...], ...]
    apart: int


def trim(flat: FlatSpace) -> Trimmed:
    """The space with everything taken out that is free of rules. Raises UnsupportedError if it has a `Wide` rule."""
    views = _views(flat)
    has_kept_child: list[set[int]] = [set() for _ in flat.variables]
    keep = [bool(seen) for seen in views]
    for number in reversed(range(len(flat.variables))):
        parent = flat.variables[number].parent
        if parent is not None and flat.variables[parent[0]].values[parent[1]] is None:
            raise UnsupportedError(f"{flat.variables[number].path} hangs below a part that is left out")
        if keep[number] and parent is not None:
            keep[parent[0]] = True
            has_kept_child[parent[0]].add(parent[1])
    kept = tuple(number for number, keeps in enumerate(keep) if keeps)
    classes = tuple(_classes(flat.variables[number], views[number], has_kept_child[number]) for number in kept)
    place = {number: at for at, number in enumerate(kept)}
    variables = tuple(
        _core_variable(flat.variables[number], groups, place, classes)
        for number, groups in zip(kept, classes, strict=True)
    )
    firsts = {
        number: [*(group[0] for group in groups), len(flat.variables[number].values)]
        for number, groups in zip(kept, classes, strict=True)
    }
    rules = tuple(_core_rule(rule, place, firsts) for rule in flat.rules)
    return Trimmed(flat, FlatSpace(flat.name, variables, flat.constraints, rules), kept, classes)


def ways_of(trimmed: Trimmed) -> ValueWays:
    """Ways to fill in what was cut off."""
    variables = trimmed.flat.variables
    below = [[1] * len(variable.values) for variable in variables]
    is_kept = set(trimmed.kept)
    apart = 1
    for number in reversed(range(len(variables))):
        if number in is_kept:
            continue
        parent = variables[number].parent
        if parent is None:
            apart *= sum(below[number])
        else:
            below[parent[0]][parent[1]] *= sum(below[number])
    sums = tuple(
        tuple(sum(below[number][value] for value in group) for group in groups)
        for number, groups in zip(trimmed.kept, trimmed.classes, strict=True)
    )
    return ValueWays(tuple(map(tuple, below)), sums, apart)


def _views(flat: FlatSpace) -> list[list[Sequence[Hashable]]]:
    """For each variable what each rule that looks at it sees, per value."""
    views: list[list[Sequence[Hashable]]] = [[] for _ in flat.variables]
    for rule in flat.rules:
        match rule:
            case Clause():
                for number, mask in rule.literals:
                    views[number].append(mask.tolist())
            case Linear():
                for number, weights in rule.weights.items():
                    views[number].append(weights.tolist())
            case Table():
                for axis, number in enumerate(rule.scope):
                    slices = np.moveaxis(rule.allowed, axis, 0)
                    views[number].append([part.tobytes() for part in slices])
            case Wide():
                raise UnsupportedError(f"rule {rule.owner} is no clause, no table and no count")
    return views


def _classes(
    variable: Variable, views: Sequence[Sequence[Hashable]], has_kept_child: set[int]
) -> tuple[tuple[int, ...], ...]:
    groups: dict[Hashable, list[int]] = {}
    for value in range(len(variable.values)):
        key = value if value in has_kept_child else tuple(view[value] for view in views)
        groups.setdefault(key, []).append(value)
    return tuple(tuple(group) for group in groups.values())


def _core_variable(
    variable: Variable,
    groups: tuple[tuple[int, ...], ...],
    place: Mapping[int, int],
    classes: tuple[tuple[tuple[int, ...], ...], ...],
) -> Variable:
    parent = variable.parent
    if parent is not None:
        above = place[parent[0]]
        value = next(k for k, group in enumerate(classes[above]) if parent[1] in group)
        parent = (above, value)
    # A class that holds more than the left-out part is named by its first value that is a part.
    names = tuple(
        next((name for value in group if (name := variable.values[value]) is not None), None) for group in groups
    )
    return Variable(variable.path, names, parent)


def _core_rule(rule: Rule, place: Mapping[int, int], firsts: Mapping[int, list[int]]) -> Rule:
    """The rule over core variables; *firsts* has a value of each class, and absence, by variable."""
    match rule:
        case Clause():
            literals = ((place[number], mask[firsts[number]]) for number, mask in rule.literals)
            return Clause(tuple(literals), rule.owner)
        case Linear():
            weights = {place[number]: weights[firsts[number]] for number, weights in rule.weights.items()}
            return Linear(weights, rule.low, rule.high, rule.owner, rule.scale)
        case Table():
            allowed = rule.allowed
            for axis, number in enumerate(rule.scope):
                allowed = allowed.take(firsts[number], axis=axis)
            return Table(tuple(place[number] for number in rule.scope), allowed, rule.owner)
        case Wide():
            raise UnsupportedError(f"rule {rule.owner} is no clause, no table and no count")
