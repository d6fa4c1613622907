"""The configurations of a small design space by looking at every combination: what the engine is compared with."""

from __future__ import annotations

from dse.space.decisions import decisions
from dse.space.language.evaluate import compile_in
from dse.space.language.places import Places


def every_way(tree):
    """All ways to make the decisions of *tree*, in the order of the file."""
    if not tree:
        yield {}
        return
    first, *others = tree
    for branch in first.branches:
        for below in every_way(branch.decisions):
            for rest in every_way(tuple(others)):
                yield ({first.path: branch.choice} if branch.choice else {}) | below | rest


def valid(space):
    """The choices that meet all constraints, in the order of the file."""
    places = Places(space)
    rules = [compile_in(constraint.rule, places) for constraint in space.constraints]
    ways = every_way(decisions(space))
    return [choices for choices in ways if all(rule.outcome(choices) is not False for rule in rules)]
