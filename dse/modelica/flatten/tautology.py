"""Truth whatever the parts are: for guards of if-branches, which exclude one another or cover everything."""

from __future__ import annotations

import itertools

from dse.modelica.algebra.arithmetic import FUNCTIONS
from dse.modelica.algebra.expression import Expression, walk

_MOST_ATOMS = 10
_JUNCTIONS = frozenset({"and", "or", "not"})


def is_tautology(truth: Expression) -> bool:
    """Whether *truth* holds for all truth values of what and, or, not join in it; False also if that is too much."""
    nodes = list(walk((truth,)))
    reached = {truth.number}
    for node in reversed(nodes):
        if node.number in reached and node.operator in _JUNCTIONS:
            reached |= {operand.number for operand in node.operands}
    inner = [node for node in nodes if node.number in reached]
    atoms = [node for node in inner if node.operator not in _JUNCTIONS and not node.is_constant]
    if len(atoms) > _MOST_ATOMS:
        return False
    for values in itertools.product((0.0, 1.0), repeat=len(atoms)):
        known = {atom.number: value for atom, value in zip(atoms, values, strict=True)}
        for node in inner:
            if node.is_constant:
                known[node.number] = node.value
            elif node.operator in _JUNCTIONS:
                known[node.number] = FUNCTIONS[node.operator](*(known[operand.number] for operand in node.operands))
        if known[truth.number] == 0:
            return False
    return True
