"""From the root of a graph down to rows: lots decide at every node which branch to take."""

from __future__ import annotations

from collections.abc import Container, Iterable
from typing import TypeVar

import numpy as np

from dse.space.dnnf.cnf import NO_LITERAL, TRUE
from dse.space.dnnf.graph import Branch
from dse.space.dnnf.lots import Chance, Rank
from dse.space.dnnf.weigh import Weighed
from dse.space.flat import ABSENT, Bools, Rows

LotT = TypeVar("LotT", Chance, Rank)

_Choice = tuple[int, tuple[int, ...]]
"""A variable of the space, and the values it may take here."""


def descend(weighed: Weighed, lot: LotT) -> Rows:
    """The rows that a lot over all results of *weighed* stands for, shape (rows, variables)."""
    cut = _cut_off(weighed)
    open_choices = _open_choices(weighed, cut)
    holds, settled = _walk(weighed, lot, open_choices)
    found = np.full((len(weighed.dnnf.flat.variables), len(lot.rows)), ABSENT, np.int16)
    _write_kept(weighed, holds, found)
    for literal, lots in settled.items():
        for each in lots[0].together(lots):
            _fill(weighed, each, open_choices[literal], cut, found)
    return np.ascontiguousarray(found.T)


def _walk(weighed: Weighed, lot: LotT, open_choices: Container[int]) -> tuple[Bools, dict[int, list[LotT]]]:
    """Which Booleans hold, shape (Booleans, rows), and lots for what is left to be filled in where a literal holds."""
    graph = weighed.dnnf.graph
    holds = np.zeros((weighed.dnnf.booleans, len(lot.rows)), bool)
    settled: dict[int, list[LotT]] = {}
    reaching: dict[int, list[LotT]] = {}
    outside = lot.part(weighed.outer)
    settled[TRUE] = [digit for digit, _ in outside]
    if graph.root is not None:
        for _, rest in outside:
            _take(weighed, graph.root, rest, open_choices, holds, settled, reaching)
    for number in range(len(graph.nodes) - 1, -1, -1):
        lots = reaching.pop(number, [])
        for each in lots[0].together(lots) if lots else []:
            for index, chosen in each.choose(weighed.branches[number]):
                _take(weighed, graph.nodes[number][index], chosen, open_choices, holds, settled, reaching)
    return holds, settled


def _take(
    weighed: Weighed,
    branch: Branch,
    lot: LotT,
    open_choices: Container[int],
    holds: Bools,
    settled: dict[int, list[LotT]],
    reaching: dict[int, list[LotT]],
) -> None:
    positive = [literal >> 1 for literal in branch.literals if not literal & 1]
    if positive:
        holds[np.array(positive)[:, None], lot.rows] = True
    lots = [lot]
    for literal in branch.literals:
        if literal in open_choices:
            lots = _divide(lots, weighed.literals[literal], settled.setdefault(literal, []))
    for boolean in branch.free:
        amounts = weighed.literals[2 * boolean], weighed.literals[2 * boolean + 1]
        digits: list[LotT] = []
        lots = _divide(lots, sum(amounts), digits)
        for digit in digits:
            for negative, chosen in digit.choose(amounts):
                holds[boolean, chosen.rows] = not negative
                if 2 * boolean + negative in open_choices:
                    settled.setdefault(2 * boolean + negative, []).append(chosen)
    for child in branch.children:
        lots = _divide(lots, weighed.nodes[child], reaching.setdefault(child, []))


def _divide(lots: Iterable[LotT], amount: int, digits: list[LotT]) -> list[LotT]:
    """Take a factor out of lots: what decides it goes to *digits*, the rest is returned."""
    rests: list[LotT] = []
    for lot in lots:
        for digit, rest in lot.part(amount):
            digits.append(digit)
            rests.append(rest)
    return rests


def _write_kept(weighed: Weighed, holds: Bools, found: Rows) -> None:
    """The variables of the core, each class by its first value."""
    dnnf = weighed.dnnf

    def where(literal: int) -> Bools:
        image = dnnf.image[literal]
        if image >> 1 == TRUE >> 1:
            return np.full(holds.shape[1], image == TRUE)
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
    choices: dict[int, list[_Choice]] = {TRUE: list(cut.get(None, []))}
    for number, groups, literals in zip(dnnf.trimmed.kept, dnnf.trimmed.classes, dnnf.cnf.values, strict=True):
        for group, literal in zip(groups, literals, strict=True):
            if literal != NO_LITERAL and (len(group) > 1 or (number, group[0]) in cut):
                choices.setdefault(dnnf.image[literal], []).append((number, group))
    return choices


def _fill(
    weighed: Weighed,
    lot: LotT,
    choices: list[_Choice],
    cut: dict[tuple[int, int] | None, list[_Choice]],
    found: Rows,
) -> None:
    """Make choices and all that hang below them."""
    pending = [(lot, choices, 0)]
    while pending:
        each, several, at = pending.pop()
        if at == len(several):
            continue
        variable, values = several[at]
        amounts = [weighed.ways.below[variable][value] for value in values]
        for digit, rest in each.part(sum(amounts)):
            pending.append((rest, several, at + 1))
            for index, chosen in digit.choose(amounts):
                found[variable, chosen.rows] = values[index]
                if (variable, values[index]) in cut:
                    pending.append((chosen, cut[variable, values[index]], 0))
