"""Clauses to a decision-DNNF: decide, propagate, fall apart into components, never solve one twice.

Example: (a or b), (not a or c), (d or e). The first two clauses share a, the third shares nothing with them.

    component {d, e}: 3 models
    component {a, b, c}: decide a. True: c follows, b is free, 2 models. False: b follows, c is free, 2 models
    components are independent, so their models multiply: 3 * (2 + 2) = 12

A component that occurs again is looked up. Counts, samples and best rows are then passes over the graph.

Cost: the number of components, which in the worst case doubles with each Boolean. The order of the decisions is what
keeps it small: 1,211 nodes for a model of 2,513 features, 9,854 without `dse.space.methods.dnnf.order`
(docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Sequence
from itertools import combinations

from dse.space.methods.dnnf.graph import DecisionGraph, GraphBranch
from dse.space.methods.dnnf.simplify import Simplified
from dse.space.methods.mdd.growth import TooWideError

ClauseComponent = tuple[tuple[int, ...], tuple[int, ...]]
"""Open Booleans, ascending, and the clauses over them that need saying; equal components have equal models."""

_EMPTY = -1
"""In place of the node of a component without models."""

_ENTRIES = 256
"""Booleans, clauses and literals remembered for each component allowed: a bound of memory where they are large."""


def compile_graph(simplified: Simplified, most_nodes: int) -> DecisionGraph:
    """The models as a graph (exhaustive search with component caching: Bayardo and Pehoushek 2000, Thurley 2006).

    Booleans are decided in the order of their numbers. Raises TooWideError beyond *most_nodes* components,
    or fewer if they are large.
    """
    if not simplified.consistent:
        return DecisionGraph((), None)
    return _Compiler(simplified.booleans, simplified.clauses, most_nodes).run()


class _Frame:
    """A component being solved: which literal is next, and the branch that waits for its children."""

    __slots__ = ("branches", "children", "component", "free", "mark", "untried", "waiting")

    def __init__(self, component: ClauseComponent) -> None:
        self.component = component
        first = component[0][0]
        self.untried = [2 * first + 1, 2 * first]
        self.branches: list[GraphBranch] = []
        self.children: list[int] = []
        self.waiting: list[ClauseComponent] = []
        self.free: tuple[int, ...] = ()
        self.mark = -1


class _Compiler:
    """Booleans are numbered in the order of decision."""

    def __init__(self, booleans: int, clauses: Sequence[tuple[int, ...]], most_nodes: int) -> None:
        self._booleans = booleans
        self._most_nodes = most_nodes
        self._entries_left = _ENTRIES * most_nodes
        self._nodes: list[tuple[GraphBranch, ...]] = []
        self._cache: dict[ClauseComponent, int] = {}
        self._trail: list[int] = []
        # By literal: what it implies, and the longer clauses it stands in.
        self._implied: list[list[int]] = [[] for _ in range(2 * booleans)]
        self._standing: list[list[int]] = [[] for _ in range(2 * booleans)]
        self._long = [clause for clause in clauses if len(clause) > 2]
        for clause in clauses:
            if len(clause) == 2:
                one, other = clause
                self._implied[one ^ 1].append(other)
                self._implied[other ^ 1].append(one)
        for number, clause in enumerate(self._long):
            for literal in clause:
                self._standing[literal].append(number)
        # By longer clause: how many literals are true, and how many are not false.
        self._true = array("i", [0]) * len(self._long)
        self._left = [len(clause) for clause in self._long]
        self._is_true = bytearray(2 * booleans)
        self._is_set = bytearray(booleans)
        self._connect(clauses)

    def _connect(self, clauses: Iterable[tuple[int, ...]]) -> None:
        """By Boolean: its neighbours in two-literal clauses, and the longer clauses it stands in."""
        implied = [set(literals) for literals in self._implied]
        # Exactly one literal of a choice holds, and any one decides the others: while one of its Booleans is open
        # the clause is open too. Hence it follows from the open Booleans and joins all of them.
        self._is_choice = [
            all(other ^ 1 in implied[one] for one, other in combinations(clause, 2)) for clause in self._long
        ]
        joined: list[set[int]] = [set() for _ in range(self._booleans)]
        for clause, is_choice in zip(self._long, self._is_choice, strict=True):
            if is_choice:
                members = [literal >> 1 for literal in clause]
                for boolean in members:
                    joined[boolean].update(members)
        beside: list[set[int]] = [set() for _ in range(self._booleans)]
        for clause in clauses:
            if len(clause) == 2:
                one, other = clause[0] >> 1, clause[1] >> 1
                if other not in joined[one]:
                    beside[one].add(other)
                    beside[other].add(one)
        self._beside = [tuple(others) for others in beside]
        self._around = [
            (*self._standing[2 * boolean], *self._standing[2 * boolean + 1]) for boolean in range(self._booleans)
        ]
        self._members = [tuple(literal >> 1 for literal in clause) for clause in self._long]

    def run(self) -> DecisionGraph:
        """The whole graph."""
        waiting, free = self._components(range(1, self._booleans))
        children = []
        for component in waiting:
            node = self._solve(component)
            if node == _EMPTY:
                return DecisionGraph((), None)
            children.append(node)
        return DecisionGraph(tuple(self._nodes), GraphBranch((), tuple(children), free))

    def _solve(self, whole: ClauseComponent) -> int:
        """The node of a component, _EMPTY if it has no model."""
        cache = self._cache
        known = cache.get(whole)
        if known is not None:
            return known
        stack = [_Frame(whole)]
        node = _EMPTY
        while stack:
            frame = stack[-1]
            if frame.mark >= 0:
                # A branch is open; go on with its components.
                failed = False
                while frame.waiting:
                    component = frame.waiting[-1]
                    known = cache.get(component)
                    if known is None:
                        stack.append(_Frame(component))
                        break
                    if known == _EMPTY:
                        failed = True
                        break
                    frame.children.append(known)
                    frame.waiting.pop()
                if stack[-1] is not frame:
                    continue
                if not failed:
                    literals = tuple(self._trail[frame.mark :])
                    frame.branches.append(GraphBranch(literals, tuple(frame.children), frame.free))
                self._undo(frame.mark)
                frame.mark = -1
            elif frame.untried:
                mark = len(self._trail)
                if self._propagate(frame.untried.pop()):
                    frame.waiting, frame.free = self._components(frame.component[0])
                    frame.children = []
                    frame.mark = mark
                else:
                    self._undo(mark)
            else:
                node = self._store(frame)
                stack.pop()
        return node

    def _store(self, frame: _Frame) -> int:
        self._entries_left -= sum(map(len, frame.component)) + sum(len(branch.literals) for branch in frame.branches)
        if len(self._cache) >= self._most_nodes or self._entries_left < 0:
            raise TooWideError
        node = _EMPTY
        if frame.branches:
            node = len(self._nodes)
            self._nodes.append(tuple(frame.branches))
        self._cache[frame.component] = node
        return node

    def _propagate(self, literal: int) -> bool:
        """Make a literal true with all that follows; False if something contradicts."""
        is_true, is_set, trail = self._is_true, self._is_set, self._trail
        true, left, standing, implied = self._true, self._left, self._standing, self._implied
        fits = True
        at = len(trail)
        if is_set[literal >> 1]:
            return bool(is_true[literal])
        is_true[literal] = is_set[literal >> 1] = 1
        trail.append(literal)
        while at < len(trail):
            literal = trail[at]
            at += 1
            for number in standing[literal]:
                true[number] += 1
            for number in standing[literal ^ 1]:
                left[number] -= 1
                if left[number] <= 1 and not true[number]:
                    for other in self._long[number]:
                        if not is_set[other >> 1]:
                            is_true[other] = is_set[other >> 1] = 1
                            trail.append(other)
                            break
                        if is_true[other]:
                            break
                    else:
                        fits = False
            for other in implied[literal]:
                if not is_true[other]:
                    if is_set[other >> 1]:
                        fits = False
                    else:
                        is_true[other] = is_set[other >> 1] = 1
                        trail.append(other)
            if not fits:
                # Undoing takes back what was counted, so what is on the trail must have been counted.
                for rest in trail[at:]:
                    is_true[rest] = is_set[rest >> 1] = 0
                del trail[at:]
                return False
        return True

    def _undo(self, mark: int) -> None:
        is_true, is_set, true, left, standing = self._is_true, self._is_set, self._true, self._left, self._standing
        for literal in self._trail[mark:]:
            is_true[literal] = is_set[literal >> 1] = 0
            for number in standing[literal]:
                true[number] -= 1
            for number in standing[literal ^ 1]:
                left[number] += 1
        del self._trail[mark:]

    def _components(self, booleans: Iterable[int]) -> tuple[list[ClauseComponent], tuple[int, ...]]:
        """What is open among the Booleans, in independent parts; and those that no clause holds any more."""
        is_set, true, beside, around = self._is_set, self._true, self._beside, self._around
        members, is_choice = self._members, self._is_choice
        seen = bytearray(is_set)
        closed = true[:]
        found: list[ClauseComponent] = []
        free: list[int] = []
        for start in booleans:
            if seen[start]:
                continue
            seen[start] = 1
            part = [start]
            clauses: list[int] = []
            for boolean in part:
                for other in beside[boolean]:
                    if not seen[other]:
                        seen[other] = 1
                        part.append(other)
                for number in around[boolean]:
                    if not closed[number]:
                        closed[number] = 1
                        if not is_choice[number]:
                            clauses.append(number)
                        for other in members[number]:
                            if not seen[other]:
                                seen[other] = 1
                                part.append(other)
            if len(part) == 1:
                # Clauses over a single open Boolean are propagated or met.
                free.append(start)
            else:
                part.sort()
                clauses.sort()
                found.append((tuple(part), tuple(clauses)))
        return found, tuple(free)
