"""The rows that break a constraint."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from dse.space.flat import NOBODY, Bools, Clause, FlatSpace, Ints, Judge, Linear, Rule, Table, Wide, single


def breaking(flat: FlatSpace, owner: int) -> tuple[FlatSpace, ...]:
    """Disjoint spaces: together the rows that break constraint *owner* and meet the other rules of *flat*.

    Empty for a constraint that has no rule, as one that always holds.
    """
    own = [rule for rule in flat.rules if rule.owner == owner]
    others = replace(flat, rules=tuple(rule for rule in flat.rules if rule.owner != owner))
    # Rows that break the first rule; rows that meet it and break the second; and so on.
    return tuple(others.having(*own[:number], *case) for number, rule in enumerate(own) for case in _opposites(rule))


def _opposites(rule: Rule) -> tuple[tuple[Rule, ...], ...]:
    """Disjoint cases, each several rules to be met together, whose union is the opposite of *rule*."""
    match rule:
        case Table():
            return ((replace(rule, allowed=~rule.allowed, owner=NOBODY),),)
        case Linear():
            below = () if rule.low is None else ((replace(rule, low=None, high=rule.low - 1, owner=NOBODY),),)
            above = () if rule.high is None else ((replace(rule, low=rule.high + 1, high=None, owner=NOBODY),),)
            return (*below, *above)
        case Clause():
            return (tuple(single(variable, ~mask) for variable, mask in rule.literals),)
        case Wide():
            return ((Wide(rule.folds, _Opposite(rule.judge)),),)


@dataclass(frozen=True, slots=True)
class _Opposite:
    judge: Judge

    def bounds(self, low: Sequence[Ints], high: Sequence[Ints]) -> tuple[Bools, Bools]:
        holds, fails = self.judge.bounds(low, high)
        return fails, holds

    def holds(self, folds: Sequence[int]) -> bool:
        return not self.judge.holds(folds)
