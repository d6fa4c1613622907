"""Repeated places: ``radar: {times: 0..4, alternatives: […]}`` is a compound of instances ``n1``, ``n2``, …"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from dse.domain.design import Compound, Constraint, Node, Optional
from dse.errors import fail
from dse.formats import Entry
from dse.loading.design.located_text import Passage, added
from dse.loading.design.scope import Scope, constraint_name, inside

REPETITION = ("times", "of", "unordered", "all_different")
"""The keys of a repetition beside those of what is repeated."""

MOST_INSTANCES = 1000
_RANGE = re.compile(r"([0-9]{1,6})(?:\.\.([0-9]{1,6}|\*))?")


@dataclass(frozen=True, slots=True)
class StructureRule:
    """A condition that the structure itself imposes, in the names of the compound at *scope*, which has *parts*."""

    scope: Scope
    parts: Collection[str]
    name: str
    rule: Passage
    because: str

    def constraint(self) -> Constraint:
        """It as a constraint of the design. Raises DseError where a name in it means nothing."""
        rule = inside(self.scope, self.parts, self.rule).parse()
        return Constraint(constraint_name(self.scope, self.name), rule, self.because, self.rule.where, form={})


@dataclass(frozen=True, slots=True)
class Bounds:
    """From *least* to *most*; None is no bound."""

    least: int
    most: int | None

    def __str__(self) -> str:
        return (
            str(self.least) if self.least == self.most else f"{self.least}..{'*' if self.most is None else self.most}"
        )


ANY_NUMBER = Bounds(0, None)


def read_bounds(entry: Entry, raw: object, *, finite: bool = False) -> Bounds:
    """``2``, ``1..3`` or, unless it must be *finite*, ``1..*``. Raises DseError."""
    match = _RANGE.fullmatch(str(raw)) if isinstance(raw, str | int) and not isinstance(raw, bool) else None
    form = "write it as 2 or 1..3" if finite else "write it as 2, 1..3 or 1..*"
    if match is None or (finite and match[2] == "*"):
        raise fail(f"'{raw}' is not a number or a range of numbers", entry.where, form)
    least = int(match[1])
    most = least if match[2] is None else None if match[2] == "*" else int(match[2])
    if most is not None and most < least:
        raise fail(f"the range {raw} is empty", entry.where, "the smaller number first")
    return Bounds(least, most)


@dataclass(frozen=True, slots=True)
class Repetition:
    """How often something is repeated, and which instances are told apart."""

    least: int
    most: int
    unordered: bool
    all_different: bool


def read_repetition(entry: Entry, written: Mapping[str, Any]) -> Repetition:
    """The keys of a repetition. Raises DseError."""
    bounds = read_bounds(entry["times"], written["times"], finite=True)
    most = bounds.most or 0
    if not 1 <= most <= MOST_INSTANCES:
        raise fail(f"{most} instances", entry["times"].where, f"1 to {MOST_INSTANCES:,} are possible")
    for key in ("unordered", "all_different"):
        if not isinstance(written.get(key, False), bool):
            raise fail(f"'{key}': expected true or false", entry[key].where, f"write {key}: true")
    return Repetition(bounds.least, most, written.get("unordered", False), written.get("all_different", False))


def repetition_rules(entry: Entry, times: Repetition, scope: Scope, names: Collection[str]) -> list[StructureRule]:
    """The rules that the instances *names* of the place at *scope* follow."""
    rules: list[tuple[str, str, str]] = []
    places = list(names)
    optional = places[times.least :]
    if times.unordered and len(places) > 1:
        rules.append(("unordered", f"ordered({', '.join(places)})", "the order of the instances makes no difference"))
    elif len(optional) > 1:
        text = " and ".join(f"({after} is present implies {first} is present)" for first, after in pairwise(optional))
        rules.append(("in_order", text, "the instances are numbered without gaps"))
    if times.all_different and len(places) > 1:
        rules.append(("different", f"all_different({', '.join(places)})", "the instances are all different"))
    where = entry["times"].where
    return [StructureRule(scope, places, name, added(text, where), because) for name, text, because in rules]


def instance(node: Node, name: str) -> Node:
    """*node* as an instance of the place *name*: a compound is called so, that all are called the same."""
    match node:
        case Compound():
            return replace(node, name=name)
        case Optional(content, where):
            return Optional(instance(content, name), where)
    return node
