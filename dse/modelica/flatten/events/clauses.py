"""Discrete equations and actions collected by what they write, and put in the order in which they hold."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from dse.errors import Location, fail
from dse.modelica.algebra.arithmetic import FUNCTIONS
from dse.modelica.algebra.expression import Expression, Graph
from dse.modelica.algebra.traversal import symbols, walk
from dse.modelica.flat_model import Assignment
from dse.modelica.flatten.events.chains import BranchNumber, Chains, Span


@dataclass(frozen=True, slots=True)
class Item:
    """One thing written: *value* for *target* (a scalar of variable *owner*) when condition *trigger* becomes true
    (None: at every event) and *guard* holds then."""

    target: str
    owner: str
    value: Expression
    trigger: int | None
    guard: Expression
    where: Location | None


@dataclass(frozen=True, slots=True)
class Clauses:
    """The when-clauses: *spans*, where each trigger's condition stands, and *triggers*, by clause and branch."""

    chains: Chains
    spans: Mapping[int, Span | None]
    triggers: Mapping[BranchNumber, int]

    def ordered(self, graph: Graph, items: Sequence[Item], kept: Expression) -> list[Assignment]:
        """The assignments of one target, of which the first active one holds; *kept* is the value where none gives one.

        Their triggers are still numbers of conditions. A branch of a when-clause that leaves the target alone keeps it
        from later branches by an assignment of its own. Of several when-clauses in an algorithm, the last one in the
        text holds; the front-end refuses what reads the target between them. Raises DseError where the order cannot be
        told.
        """
        groups: dict[int | None, list[Item]] = {}
        for item in items:
            groups.setdefault(item.trigger, []).append(item)
        owner = frozenset({items[0].owner})
        places = {
            trigger: None if trigger is None else self.chains.find(self.spans.get(trigger), owner) for trigger in groups
        }
        steps = {trigger: self._merged(graph, group, kept, places[trigger]) for trigger, group in groups.items()}
        known = [place for place in places.values() if place is not None]
        clauses = sorted({place.clause for place in known}, reverse=True)
        unordered = fail(
            f"'{items[0].target}' assigned under several conditions that are not one when-clause is not supported",
            list(steps.values())[-1].where,
            "write one when-clause with elsewhen",
        )
        if len(known) < len(groups) > 1 or (len(clauses) > 1 and any(map(self.chains.is_equation, known))):
            raise unordered
        if not known:
            (trigger,) = groups
            if trigger is not None and self.chains.may_follow(self.spans.get(trigger)):
                raise fail(f"this elsewhen that writes '{items[0].target}' is not supported", items[0].where)
            return list(steps.values())
        found: list[Assignment] = []
        for clause in clauses:
            by_branch = {
                place.branch: steps[trigger] for trigger, place in places.items() if place and place[0] == clause
            }
            own = [
                by_branch[branch] if branch in by_branch else self._silent(BranchNumber(clause, branch), items[0], kept)
                for branch in range(max(by_branch) + 1)
            ]
            if clause != clauses[-1] and kept.symbol in symbols(*(step.value for step in own)):
                raise unordered  # what is kept there is what the clauses before give
            found += own
        return found

    def _silent(self, place: BranchNumber, item: Item, kept: Expression) -> Assignment:
        trigger = self.triggers.get(place)
        if trigger is None:
            raise fail(f"this elsewhen that writes '{item.target}' is not supported", item.where)
        return Assignment(item.target, kept, trigger, item.where)

    def _merged(self, graph: Graph, items: Sequence[Item], kept: Expression, place: BranchNumber | None) -> Assignment:
        """One step for *items* of one trigger."""
        ranked = self._ranked(items, kept, place)
        covered = graph.constant(0.0)
        for item in ranked:
            covered = graph.make("or", covered, item.guard)
        is_complete = is_tautology(covered)
        value = ranked[-1].value if is_complete else kept
        for item in reversed(ranked[:-1] if is_complete else ranked):
            value = graph.make("if", item.guard, item.value, value)
        return Assignment(items[0].target, value, items[0].trigger, items[0].where)

    def _ranked(self, items: Sequence[Item], kept: Expression, place: BranchNumber | None) -> Sequence[Item]:
        """*items* of one trigger, the one that holds first. In an algorithm the last one in the text holds.

        Of a when-clause with an `if`, the front-end lists an equation for each branch, and one for none of them.
        """
        if len(items) == 1 or _exclude(items):
            return items
        *branches, last = sorted(items, key=lambda item: item.guard.is_number(1))
        values = {item.value.number for item in branches}
        is_rest = last.guard.is_number(1) and (last.value is kept or values == {last.value.number})
        if place is not None and self.chains.is_equation(place) and is_rest and _exclude(branches):
            return [*branches, last]
        by_place = {item.where: item for item in items if item.where is not None}
        if place is None or self.chains.is_equation(place) or len(by_place) != len(items):
            what = f"'{items[0].target}' assigned several times under one condition is not supported"
            raise fail(what, items[0].where)
        return [by_place[where] for where in sorted(by_place, key=lambda one: (one.line, one.column), reverse=True)]


def _exclude(items: Sequence[Item]) -> bool:
    """Whether no two guards of *items* can hold together."""
    return all(
        is_tautology(one.guard.graph.make("not", one.guard.graph.make("and", one.guard, other.guard)))
        for one, other in itertools.combinations(items, 2)
    )


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
