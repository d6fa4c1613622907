"""Rules as propagators over domains: what each takes away from the values that are still possible.

A domain is a whole number whose bit v says that value v is possible; the bit after the last value is `ABSENT`.

Example: x in {1, 2, 4}, y in {0, 3}, x + y <= 4. Nothing follows at first: each value still has a partner. Deciding
y = 3 leaves 1 for x, so the domain of x becomes {1}, bits 0b001, and every rule over x is looked at again.

Cost: variables of the rules looked at; the search that uses them (`dse.space.methods.listing.search`) counts these and
gives up beyond its allowance. It combines no bounds: it finds the first row of some spaces sooner than a diagram is
compiled (3 ms), and of L with tight bounds not within a second (docs/decisions/0007-design-space-engine.md).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import Protocol

import numpy as np

from dse.space.flat import NO_VALUE, Bools, Clause, FlatSpace, Fold, Gather, Ints, Linear, Rule, Table, Wide
from dse.space.methods.mdd.folds import is_bounded

Restrict = Callable[[int, int], bool]
"""Keep of a variable's domain what is in a mask; False if nothing is left."""


class Propagator(Protocol):
    """A rule at work; *scope* are the variables whose domains it looks at."""

    scope: tuple[int, ...]

    def revise(self, domains: Sequence[int], restrict: Restrict) -> bool:
        """Take away what the rule forbids; False if it cannot hold any more. Exact once all domains are single."""


def propagators(flat: FlatSpace) -> list[Propagator]:
    """One for each rule, and one for each variable below another."""
    found: list[Propagator] = []
    for number, variable in enumerate(flat.variables):
        if variable.parent is not None:
            parent, value = variable.parent
            allowed = np.zeros((len(flat.variables[parent].values) + 1, len(variable.values) + 1), np.bool_)
            allowed[:, -1] = True
            allowed[value] = True
            allowed[value, -1] = False
            found.append(_PairTable(parent, number, allowed))
    return found + [_propagator(rule) for rule in flat.rules]


def bits(mask: Bools) -> int:
    """A mask of shape (values + 1,) as a domain."""
    return sum(1 << value for value in np.flatnonzero(mask).tolist())


@lru_cache(maxsize=1 << 16)
def values_of(domain: int) -> tuple[int, ...]:
    """The values of a domain, ascending."""
    found = []
    while domain:
        lowest = domain & -domain
        found.append(lowest.bit_length() - 1)
        domain ^= lowest
    return tuple(found)


class _PairTable:
    """A table over two variables: a value without a partner goes (arc consistency; Mackworth, 1977)."""

    def __init__(self, first: int, second: int, allowed: Bools) -> None:
        self.scope: tuple[int, ...] = (first, second)
        self._partners = ([bits(row) for row in allowed], [bits(row) for row in allowed.T])

    def revise(self, domains: Sequence[int], restrict: Restrict) -> bool:
        for here, there, partners in ((0, 1, self._partners[0]), (1, 0, self._partners[1])):
            other = domains[self.scope[there]]
            keep = sum(1 << v for v in values_of(domains[self.scope[here]]) if partners[v] & other)
            if not restrict(self.scope[here], keep):
                return False
        return True


class _WideTable:
    """A table over any number of variables, made generalised arc consistent."""

    def __init__(self, table: Table) -> None:
        self.scope = table.scope
        self._allowed = table.allowed

    def revise(self, domains: Sequence[int], restrict: Restrict) -> bool:
        if not self.scope:
            return bool(self._allowed)
        possible = [np.array(values_of(domains[variable])) for variable in self.scope]
        open_entries = self._allowed[np.ix_(*possible)]
        for axis, (variable, values) in enumerate(zip(self.scope, possible, strict=True)):
            supported = open_entries.any(axis=tuple(a for a in range(len(self.scope)) if a != axis))
            if not restrict(variable, sum(1 << v for v in values[supported].tolist())):
                return False
        return True


class _AnyLiteral:
    """A clause: its last literal that can hold must."""

    def __init__(self, clause: Clause) -> None:
        self.scope = tuple(variable for variable, _ in clause.literals)
        self._masks = [bits(mask) for _, mask in clause.literals]

    def revise(self, domains: Sequence[int], restrict: Restrict) -> bool:
        last = None
        for variable, mask in zip(self.scope, self._masks, strict=True):
            if not domains[variable] & mask:
                continue
            if last is not None or not domains[variable] & ~mask:
                return True
            last = variable, mask
        return last is not None and restrict(*last)


class _SumWithin:
    """A sum within bounds, made bounds consistent."""

    def __init__(self, linear: Linear) -> None:
        self.scope = tuple(linear.weights)
        self._weights = [weights.tolist() for weights in linear.weights.values()]
        self._low, self._high = linear.low, linear.high

    def revise(self, domains: Sequence[int], restrict: Restrict) -> bool:
        options = [
            [weights[v] for v in values_of(domains[n])] for n, weights in zip(self.scope, self._weights, strict=True)
        ]
        low, high = sum(map(min, options)), sum(map(max, options))
        if (self._high is not None and low > self._high) or (self._low is not None and high < self._low):
            return False
        for variable, weights, possible in zip(self.scope, self._weights, options, strict=True):
            most = None if self._high is None else self._high - low + min(possible)
            least = None if self._low is None else self._low - high + max(possible)
            if (most is None or max(possible) <= most) and (least is None or min(possible) >= least):
                continue
            keep = sum(
                1 << v
                for v in values_of(domains[variable])
                if (most is None or weights[v] <= most) and (least is None or weights[v] >= least)
            )
            if not restrict(variable, keep):
                return False
        return True


class _JudgedRule:
    """A wide rule: it fails when its judge excludes all folds in reach, or the one fold there is."""

    def __init__(self, wide: Wide) -> None:
        self.scope = tuple(sorted({variable for fold in wide.folds for variable in fold.values}))
        self._wide = wide
        self._bounded = is_bounded(wide)

    def revise(self, domains: Sequence[int], restrict: Restrict) -> bool:  # noqa: ARG002 - it only tests
        complete = all(not domains[variable] & (domains[variable] - 1) for variable in self.scope)
        if complete:
            return self._wide.judge.holds([_reach(fold, domains)[0] for fold in self._wide.folds])
        if not self._bounded:
            return True
        ends = np.array([_reach(fold, domains) for fold in self._wide.folds], np.int64).reshape(-1, 2)
        low: list[Ints] = list(ends[:, :1])
        high: list[Ints] = list(ends[:, 1:])
        return bool(self._wide.judge.bounds(low, high)[0].all())


def _propagator(rule: Rule) -> Propagator:
    match rule:
        case Table():
            return _PairTable(*rule.scope, rule.allowed) if len(rule.scope) == 2 else _WideTable(rule)
        case Clause():
            return _AnyLiteral(rule)
        case Linear():
            return _SumWithin(rule)
        case Wide():
            return _JudgedRule(rule)


def _reach(fold: Fold, domains: Sequence[int]) -> tuple[int, int]:
    """Ends between which the fold lies; the upper one is `NO_VALUE` if it may be nothing."""
    low = high = fold.start
    may_be_nothing = fold.gather is not Gather.SUM and fold.start == NO_VALUE
    may_be_some = not may_be_nothing
    for variable, values in fold.values.items():
        options = [int(values[v]) for v in values_of(domains[variable])]
        some = options if fold.gather is Gather.SUM else [value for value in options if value != NO_VALUE]
        if not some:
            continue
        reached = [_both(fold.gather, end, other) for end in (low, high) for other in (min(some), max(some))]
        # What came before stays as it is where this variable may contribute nothing, and was none where it could be.
        after = reached if may_be_some else []
        if may_be_some and len(some) < len(options):
            after += [low, high]
        if may_be_nothing:
            after += [min(some), max(some)]
        low, high = min(after), max(after)
        may_be_nothing = may_be_nothing and len(some) < len(options)
        may_be_some = True
    if may_be_nothing:
        return (low if may_be_some else NO_VALUE), NO_VALUE
    return low, high


def _both(gather: Gather, first: int, second: int) -> int:
    match gather:
        case Gather.SUM:
            return first + second
        case Gather.MIN:
            return min(first, second)
        case Gather.MAX:
            return max(first, second)
        case Gather.PRODUCT:
            return first * second
