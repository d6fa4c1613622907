"""Rules as automata that read the variables they touch, layer by layer, and remember only what still matters.

The state of a table is the part of it that is left (Moore's equivalence of states, by construction), a clause is
pending or satisfied, the hierarchy remembers of a parent which of its children exist.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from dse.space.flat import Bools, Clause, FlatSpace, Ints, Table

REJECT = -1

_SMALL = 1 << 12
"""Clauses over two variables become tables up to this size, so that rules over the same two variables are one."""


@dataclass(frozen=True, slots=True, eq=False)
class Automaton:
    """Starts in state 0 before the first of *layers*; steps[j][state, value] is the state after layers[j] or `REJECT`.

    After the last layer it has accepted, in state 0.
    """

    layers: tuple[int, ...]
    steps: tuple[Ints, ...]

    def states(self) -> int:
        """The most states between two layers."""
        return max(len(step) for step in self.steps)


@dataclass(frozen=True, slots=True, eq=False)
class RuleAutomata:
    """The rules of a space along an order: a mask of the values of each layer, and automata over two layers or more."""

    masks: tuple[Bools, ...]
    automata: tuple[Automaton, ...]
    contradiction: bool


def read(flat: FlatSpace, order: Sequence[int]) -> RuleAutomata:
    """Hierarchy, tables and clauses of *flat* along *order*; ValueError unless it is a permutation, parents first."""
    variables = flat.variables
    layer_of = {variable: layer for layer, variable in enumerate(order)}
    if sorted(order) != list(range(len(variables))):
        raise ValueError("the order must name every variable once")
    masks = [np.ones(len(variable.values) + 1, np.bool_) for variable in variables]
    children: dict[int, list[int]] = {}
    for number, variable in enumerate(variables):
        if variable.parent is None:
            masks[number][-1] = False
            continue
        if layer_of[variable.parent[0]] > layer_of[number]:
            raise ValueError("the order must name parents before children")
        children.setdefault(variable.parent[0], []).append(number)

    tables: dict[tuple[int, ...], Bools] = {}
    contradiction = False
    for table in flat.tables():
        if not table.scope:
            contradiction |= not table.allowed
        elif len(table.scope) == 1:
            masks[table.scope[0]] &= table.allowed
        else:
            _merge(tables, table)
    long_clauses: list[Clause] = []
    for clause in _by_length(flat.clauses()):
        literals = [(number, mask) for number, mask in clause.literals if (mask & masks[number]).any()]
        if any(not (masks[number] & ~mask).any() for number, mask in literals):
            continue
        if not literals:
            contradiction = True
        elif len(literals) == 1:
            masks[literals[0][0]] &= literals[0][1]
        elif len(literals) == 2 and len(literals[0][1]) * len(literals[1][1]) <= _SMALL:
            (one, of_one), (other, of_other) = literals
            _merge(tables, Table((one, other), np.logical_or.outer(of_one, of_other)))
        else:
            long_clauses.append(Clause(tuple(literals)))

    automata = [_of_parent(flat, layer_of, parent, below) for parent, below in children.items()]
    automata += [_of_table(layer_of, scope, _possible(flat, masks, scope, ok)) for scope, ok in tables.items()]
    automata += [_of_clause(layer_of, clause) for clause in long_clauses]
    return RuleAutomata(tuple(masks[variable] for variable in order), tuple(automata), contradiction)


def _by_length(clauses: Sequence[Clause]) -> list[Clause]:
    # Short ones first: what they forbid outright shortens the others.
    return sorted(clauses, key=lambda clause: len(clause.literals))


def _merge(tables: dict[tuple[int, ...], Bools], table: Table) -> None:
    seen = tables.get(table.scope)
    tables[table.scope] = table.allowed if seen is None else seen & table.allowed


def _possible(flat: FlatSpace, masks: Sequence[Bools], scope: tuple[int, ...], allowed: Bools) -> Bools:
    """Without what masks and hierarchy rule out anyway, so that rows that differ only there become equal."""
    for axis, number in enumerate(scope):
        shape = [1] * len(scope)
        shape[axis] = -1
        allowed = allowed & masks[number].reshape(shape)
        parent = flat.variables[number].parent
        if parent is not None and parent[0] in scope:
            exists = np.zeros(len(masks[parent[0]]), np.bool_)
            exists[parent[1]] = True
            absent = np.zeros(len(masks[number]), np.bool_)
            absent[-1] = True
            shape[axis], at = len(absent), scope.index(parent[0])
            shape[at] = len(exists)
            pairs = exists[:, None] ^ absent[None, :]
            allowed = allowed & (pairs if at < axis else pairs.T).reshape(shape)
    return allowed


def _of_table(layer_of: dict[int, int], scope: tuple[int, ...], allowed: Bools) -> Automaton:
    axes = sorted(range(len(scope)), key=lambda axis: layer_of[scope[axis]])
    left = np.ascontiguousarray(allowed.transpose(axes))
    sizes = left.shape
    steps: list[Ints] = []
    left = left.reshape(1, -1)
    for size in sizes[:-1]:
        parts = left.reshape(len(left) * size, left.shape[1] // size)
        numbers: dict[bytes, int] = {}
        first: list[int] = []
        step = np.full(len(parts), REJECT, np.int64)
        for row in np.flatnonzero(parts.any(axis=1)).tolist():
            state = numbers.setdefault(parts[row].tobytes(), len(first))
            if state == len(first):
                first.append(row)
            step[row] = state
        steps.append(step.reshape(len(left), size))
        left = parts[first]
    steps.append(np.where(left.reshape(len(left), sizes[-1]), 0, REJECT))
    return Automaton(tuple(layer_of[scope[axis]] for axis in axes), tuple(steps))


def _of_clause(layer_of: dict[int, int], clause: Clause) -> Automaton:
    literals = sorted(clause.literals, key=lambda literal: layer_of[literal[0]])
    steps = [np.stack([mask.astype(np.int64), np.ones(len(mask), np.int64)]) for _, mask in literals]
    steps[0] = steps[0][:1]
    last = literals[-1][1]
    steps[-1] = np.stack([np.where(last, 0, REJECT), np.zeros(len(last), np.int64)])
    return Automaton(tuple(layer_of[number] for number, _ in literals), tuple(steps))


def _of_parent(flat: FlatSpace, layer_of: dict[int, int], parent: int, children: Sequence[int]) -> Automaton:
    """State 0: no child that is still to come exists; state s: the children of the s-th value held do."""
    below = sorted(children, key=lambda number: layer_of[number])
    owners = [_owner(flat, number) for number in below]
    last = {value: j for j, value in enumerate(owners)}
    held = list(dict.fromkeys(owners))
    step = np.zeros((1, len(flat.variables[parent].values) + 1), np.int64)
    step[0, held] = np.arange(1, len(held) + 1)
    steps = [step]
    for j, (number, owner) in enumerate(zip(below, owners, strict=True)):
        kept = [value for value in held if value != owner or last[owner] > j]
        state_of = {value: state for state, value in enumerate(kept, start=1)}
        step = np.full((len(held) + 1, len(flat.variables[number].values) + 1), REJECT, np.int64)
        step[:, -1] = [0, *(state_of.get(value, 0) for value in held)]
        exists = held.index(owner) + 1
        step[exists, :-1], step[exists, -1] = step[exists, -1], REJECT
        steps.append(step)
        held = kept
    return Automaton((layer_of[parent], *(layer_of[number] for number in below)), tuple(steps))


def _owner(flat: FlatSpace, number: int) -> int:
    parent = flat.variables[number].parent
    assert parent is not None  # noqa: S101  only children are asked for
    return parent[1]
