"""Which expressions are needed in one branch of an ``if`` only, and which ifs are worth a branch in the code.

An ``if`` (and the second operand of ``and``, ``or``) opens a region for each operand that may not be needed. A node
lies in the innermost region that holds all its uses. Where a region holds nothing expensive and nothing that can fail,
both sides are simply computed, which is what processors do best.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from dse.modelica.algebra.expression import Expression

ROOT = 0

# In additions, roughly; only the order of magnitude matters.
_COSTS = {"divide": 5, "sqrt": 5, "floor": 2, "ceil": 2, "power": 40, "call": 100, "select": 100}
_FUNCTIONS = ("sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sinh", "cosh", "tanh", "exp", "log", "log10")
_COSTS |= dict.fromkeys(_FUNCTIONS, 20)
_WORTH_A_BRANCH = 20


def cost(node: Expression) -> int:
    """What it costs to compute *node* from its operands."""
    if node.operator == "power" and node.operands[1].is_constant and node.operands[1].value.is_integer():
        return 3
    return 0 if not node.operands or node.operator == "array" else _COSTS.get(node.operator, 1)


def optional_operands(node: Expression) -> range:
    """The places of the operands whose value may not be needed."""
    return {"if": range(1, 3), "and": range(1, 2), "or": range(1, 2)}.get(node.operator, range(0))


def can_fail(node: Expression) -> bool:
    """Whether computing *node* itself may end the run: an index outside, a table that must not be extrapolated."""
    if node.operator == "call":
        extrapolation = node.operands[-1]
        return not (extrapolation.is_number(1) or extrapolation.is_number(2))
    return node.operator == "select"


@dataclass(frozen=True, slots=True)
class Regions:
    """*of* gives the regions in which a node is computed, by its number: one, or several of which none holds another.
    *branches* gives the regions of a node's optional operands by number and region, where it becomes a branch."""

    of: Mapping[int, tuple[int, ...]]
    branches: Mapping[tuple[int, int], tuple[int, ...]]


def regions(nodes: Sequence[Expression], roots: Sequence[Expression]) -> Regions:
    """Regions of *nodes*, which are listed operands first and are all that *roots* need.

    What two branches share is computed before both. Unless it can fail: that is computed in each, for perhaps none is
    taken.
    """
    return _Analysis(nodes, roots).result()


_MOST_COPIES = 20000


class _Analysis:
    def __init__(self, nodes: Sequence[Expression], roots: Sequence[Expression]) -> None:
        self.parents, self.depths, self.costs = [ROOT], [0], [0]
        self.owners: list[tuple[int, int]] = [(-1, ROOT)]
        self.opened: dict[tuple[int, int], tuple[int, ...]] = {}
        self.of: dict[int, tuple[int, ...]] = {root.number: (ROOT,) for root in roots}
        failing = _failing(nodes)
        for node in reversed(nodes):
            self._visit(node, failing)
        for region in range(len(self.parents) - 1, ROOT, -1):
            self.costs[self.parents[region]] += self.costs[region]

    def _visit(self, node: Expression, failing: set[int]) -> None:
        optional = optional_operands(node)
        for region in self.of[node.number]:
            self.costs[region] += cost(node)
            if optional:
                self.opened[node.number, region] = tuple(self._open(node.number, region) for _ in optional)
        for place, operand in enumerate(node.operands):
            used = self.of[node.number]
            if place in optional:
                used = tuple(self.opened[node.number, region][place - optional.start] for region in used)
            found = {*self.of.get(operand.number, ()), *used}
            is_single = operand.number not in failing or len(self.parents) > _MOST_COPIES
            self.of[operand.number] = (self._common(found),) if is_single else self._outermost(found)

    def _open(self, number: int, region: int) -> int:
        self.parents.append(region)
        self.depths.append(self.depths[region] + 1)
        self.costs.append(0)
        self.owners.append((number, region))
        return len(self.parents) - 1

    def _common(self, found: Iterable[int]) -> int:
        """The innermost region that holds all of *found*."""
        one, *others = found
        for each in others:
            other = each
            while one != other:
                if self.depths[one] < self.depths[other]:
                    one, other = other, one
                one = self.parents[one]
        return one

    def _outermost(self, found: set[int]) -> tuple[int, ...]:
        """Those of *found* that lie in no other of them."""
        kept = []
        for region in sorted(found):
            around = region
            while around != ROOT:
                around = self.parents[around]
                if around in found:
                    break
            else:
                kept.append(region)
        return tuple(kept)

    def result(self) -> Regions:
        """Regions that are not worth a branch are dissolved in what is around them."""
        branches = {
            key: regions
            for key, regions in self.opened.items()
            if max(self.costs[region] for region in regions) >= _WORTH_A_BRANCH
        }
        around = [ROOT] * len(self.parents)
        for region in range(1, len(self.parents)):
            around[region] = region if self.owners[region] in branches else around[self.parents[region]]
        of = {number: self._outermost({around[region] for region in found}) for number, found in self.of.items()}
        # A node that stood in a dissolved region opens its branches in what was around it.
        moved = {(number, around[region]): regions for (number, region), regions in branches.items()}
        return Regions(of, moved)


def _failing(nodes: Iterable[Expression]) -> set[int]:
    """Numbers of nodes that can fail themselves or need one that can."""
    found: set[int] = set()
    for node in nodes:
        if can_fail(node) or any(operand.number in found for operand in node.operands):
            found.add(node.number)
    return found
