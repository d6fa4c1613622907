"""From the root of a graph down to rows: selections decide at every node which branch to take."""

from __future__ import annotations

from typing import Generic

import numpy as np

from dse.space.flat import ABSENT, Bools, Rows
from dse.space.methods.dnnf.cnf import NO_LITERAL, TRUE_LITERAL
from dse.space.methods.dnnf.graph import GraphBranch
from dse.space.methods.dnnf.selection import SelectionT
from dse.space.methods.dnnf.weigh import Weighed

_Choice = tuple[int, tuple[int, ...]]
"""A variable of the space, and the values it may take here."""


def descend(weighed: Weighed, selection: SelectionT) -> Rows:
    """The rows that a selection among all results of *weighed* stands for, shape (rows, variables)."""
    cut = _cut_off(weighed)
    open_choices = _open_choices(weighed, cut)
    descent = _Descent(weighed, open_choices, selection)
    found = np.full((len(weighed.dnnf.flat.variables), len(selection.rows)), ABSENT, np.int16)
    _write_kept(weighed, descent.holds, found)
    for literal, selections in descent.settled.items():
        _fill(weighed, selections[0].joined(selections), open_choices[literal], cut, found)
    return np.ascontiguousarray(found.T)


class _Descent(Generic[SelectionT]):
    """Which Booleans hold, shape (Booleans, rows), and selections for what is still open where a literal holds."""

    def __init__(self, weighed: Weighed, open_choices: dict[int, list[_Choice]], selection: SelectionT) -> None:
        self.weighed = weighed
        self.open_choices = open_choices
        self.holds = np.zeros((weighed.dnnf.booleans, len(selection.rows)), bool)
        self.settled: dict[int, list[SelectionT]] = {}
        self._reaching: dict[int, list[SelectionT]] = {}
        graph = weighed.dnnf.graph
        outside, rest = selection.part(weighed.outer)
        self.settled[TRUE_LITERAL] = [outside]
        if graph.root is not None:
            self._take(graph.root, rest)
        for number in range(len(graph.nodes) - 1, -1, -1):
            if number in self._reaching:
                arrived = self._reaching.pop(number)
                for index, chosen in arrived[0].joined(arrived).choose(weighed.branches[number]):
                    self._take(graph.nodes[number][index], chosen)

    def _take(self, branch: GraphBranch, selection: SelectionT) -> None:
        amounts = self.weighed.literals
        positive = [literal >> 1 for literal in branch.literals if not literal & 1]
        if positive:
            self.holds[np.array(positive)[:, None], selection.rows] = True
        for literal in branch.literals:
            if literal in self.open_choices:
                digit, selection = selection.part(amounts[literal])
                self.settled.setdefault(literal, []).append(digit)
        for boolean in branch.free:
            both = amounts[2 * boolean], amounts[2 * boolean + 1]
            digit, selection = selection.part(sum(both))
            for negative, chosen in digit.choose(both):
                self.holds[boolean, chosen.rows] = not negative
                if 2 * boolean + negative in self.open_choices:
                    self.settled.setdefault(2 * boolean + negative, []).append(chosen)
        for child in branch.children:
            digit, selection = selection.part(self.weighed.nodes[child])
            self._reaching.setdefault(child, []).append(digit)


def _write_kept(weighed: Weighed, holds: Bools, found: Rows) -> None:
    """The variables of the core, each class by its first value."""
    dnnf = weighed.dnnf

    def where(literal: int) -> Bools:
        image = dnnf.image[literal]
        if image >> 1 == TRUE_LITERAL >> 1:
            return np.full(holds.shape[1], image == TRUE_LITERAL)
        held: Bools = holds[image >> 1]
        return ~held if image & 1 else held

    for number, groups, exists, literals in zip(
        dnnf.trimmed.kept, dnnf.trimmed.classes, dnnf.cnf.exists, dnnf.cnf.values, strict=True
    ):
        for group, literal in sorted(zip(groups, literals, strict=True), key=lambda each: each[1]):
            # Left out comes first and is overwritten where the part stands.
            found[number, where(exists if literal == NO_LITERAL else literal)] = group[0]


def _cut_off(weighed: Weighed) -> dict[tuple[int, int] | None, list[_Choice]]:
    """The trees that were cut off, by the value they hang below; None are the roots."""
    kept = set(weighed.dnnf.trimmed.kept)
    cut: dict[tuple[int, int] | None, list[_Choice]] = {}
    for number, variable in enumerate(weighed.dnnf.flat.variables):
        if number not in kept:
            cut.setdefault(variable.parent, []).append((number, tuple(range(len(variable.values)))))
    return cut


def _open_choices(weighed: Weighed, cut: dict[tuple[int, int] | None, list[_Choice]]) -> dict[int, list[_Choice]]:
    """By literal: what is still to be chosen where it holds."""
    dnnf = weighed.dnnf
    choices: dict[int, list[_Choice]] = {TRUE_LITERAL: list(cut.get(None, []))}
    for number, groups, literals in zip(dnnf.trimmed.kept, dnnf.trimmed.classes, dnnf.cnf.values, strict=True):
        for group, literal in zip(groups, literals, strict=True):
            if literal != NO_LITERAL and (len(group) > 1 or (number, group[0]) in cut):
                choices.setdefault(dnnf.image[literal], []).append((number, group))
    return choices


def _fill(
    weighed: Weighed,
    selection: SelectionT,
    choices: list[_Choice],
    cut: dict[tuple[int, int] | None, list[_Choice]],
    found: Rows,
) -> None:
    """Make choices and all that hang below them."""
    pending = [(selection, choices, 0)]
    while pending:
        each, several, at = pending.pop()
        if at == len(several):
            continue
        variable, values = several[at]
        amounts = [weighed.ways.below[variable][value] for value in values]
        digit, rest = each.part(sum(amounts))
        pending.append((rest, several, at + 1))
        for index, chosen in digit.choose(amounts):
            found[variable, chosen.rows] = values[index]
            if (variable, values[index]) in cut:
                pending.append((chosen, cut[variable, values[index]], 0))
