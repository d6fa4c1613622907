"""Rows that meet preferences, from a decision-DNNF: counting upwards, where only the best alternatives count.

Worth adds up over independent parts and is the greatest of alternatives; ways multiply and add up over the best ones
(Kimmig, Van den Broeck and De Raedt, Algebraic model counting, 2017). A preference is worth twice all that come after
it.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from dse.space.flat import Rows
from dse.space.methods.completion.preferences import Preference
from dse.space.methods.dnnf.cnf import NO_LITERAL, TRUE_LITERAL
from dse.space.methods.dnnf.compile import Dnnf
from dse.space.methods.dnnf.descend import descend
from dse.space.methods.dnnf.graph import GraphBranch
from dse.space.methods.dnnf.selection import RandomSelection
from dse.space.methods.dnnf.simplify import FALSE_LITERAL
from dse.space.methods.dnnf.weigh import Weighed, weigh

Best = tuple[int, int]
"""The greatest worth, and in how many ways it is reached."""

_NEUTRAL: Best = (0, 1)


@dataclass(frozen=True, slots=True, eq=False)
class GraphCompletion:
    """Completes rows by the compiled space that was *weighed*, which has a row."""

    weighed: Weighed

    @classmethod
    def of(cls, dnnf: Dnnf) -> GraphCompletion:
        """By a compiled space."""
        return cls(weigh(dnnf))

    def row(self, preferences: Sequence[Preference], random: np.random.Generator) -> Rows:
        """A row that meets *preferences* in their order, uniform among those that do; shape (variables,)."""
        row: Rows = descend(_best(self.weighed, preferences), RandomSelection(np.zeros(1, np.intp), random))[0]
        return row


def _best(weighed: Weighed, preferences: Sequence[Preference]) -> Weighed:
    """Numbers of rows among the best ones alone; 0 for what is none of them."""
    dnnf = weighed.dnnf
    below, classes = _of_values(weighed, preferences)
    literals = [_NEUTRAL] * (2 * dnnf.booleans)
    for of_variable, bests in zip(dnnf.cnf.values, classes, strict=True):
        for literal, best in zip(of_variable, bests, strict=True):
            # What is worth something wherever there is a row decides nothing, and a part is left out in one way.
            image = FALSE_LITERAL if literal == NO_LITERAL else dnnf.image[literal]
            if image not in (TRUE_LITERAL, FALSE_LITERAL):
                literals[image] = _both(literals[image], best)
    nodes: list[Best] = []
    branches: list[tuple[int, ...]] = []
    free = [_sum(literals[start : start + 2]) for start in range(0, len(literals), 2)]
    for node in dnnf.graph.nodes:
        bests = [_of_branch(branch, literals, free, nodes) for branch in node]
        branches.append(_ways(bests))
        nodes.append(_sum(bests))
    pairs = (_ways(literals[start : start + 2]) for start in range(0, len(literals), 2))
    ways = replace(weighed.ways, below=below)
    return replace(weighed, ways=ways, literals=tuple(way for pair in pairs for way in pair), branches=tuple(branches))


def _of_values(
    weighed: Weighed, preferences: Sequence[Preference]
) -> tuple[tuple[tuple[int, ...], ...], list[list[Best]]]:
    """Ways by variable and value, 0 where an alike value is worth more; and the best of each class of the core."""
    trimmed = weighed.dnnf.trimmed
    variables = trimmed.flat.variables
    bests: list[list[Best]] = [[_NEUTRAL] * len(variable.values) for variable in variables]
    for rank, preference in enumerate(reversed(preferences)):
        for number, marks in preference.marks.items():
            for value in np.flatnonzero(marks).tolist():
                worth, ways = bests[number][value]
                bests[number][value] = worth + int(marks[value]) * (1 << rank), ways
    place = {number: at for at, number in enumerate(trimmed.kept)}
    below: list[tuple[int, ...]] = [()] * len(variables)
    classes: list[list[Best]] = [[] for _ in trimmed.kept]
    for number in reversed(range(len(variables))):
        if number in place:
            amounts = [0] * len(bests[number])
            for group in trimmed.classes[place[number]]:
                alike = [bests[number][value] for value in group]
                classes[place[number]].append(_sum(alike))
                for value, way in zip(group, _ways(alike), strict=True):
                    amounts[value] = way
            below[number] = tuple(amounts)
            continue
        below[number] = _ways(bests[number])
        parent = variables[number].parent
        if parent is not None:
            bests[parent[0]][parent[1]] = _both(bests[parent[0]][parent[1]], _sum(bests[number]))
    return tuple(below), classes


def _of_branch(branch: GraphBranch, literals: Sequence[Best], free: Sequence[Best], nodes: Sequence[Best]) -> Best:
    worth, ways = 0, 1
    for literal in branch.literals:
        worth, ways = worth + literals[literal][0], ways * literals[literal][1]
    for boolean in branch.free:
        worth, ways = worth + free[boolean][0], ways * free[boolean][1]
    for child in branch.children:
        worth, ways = worth + nodes[child][0], ways * nodes[child][1]
    return worth, ways


def _both(one: Best, other: Best) -> Best:
    return one[0] + other[0], one[1] * other[1]


def _sum(bests: Iterable[Best]) -> Best:
    known = list(bests)
    top = max(worth for worth, _ in known)
    return top, sum(ways for worth, ways in known if worth == top)


def _ways(bests: Sequence[Best]) -> tuple[int, ...]:
    top = max(worth for worth, _ in bests)
    return tuple(ways if worth == top else 0 for worth, ways in bests)
