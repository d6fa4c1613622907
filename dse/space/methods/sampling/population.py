"""Estimates and draws where no diagram holds the rules: rows drawn without rules, which one rule after the other thins.

After each rule those that break it are replaced by copies of others (splitting), and all are moved by redrawing and
swapping decisions, as long as the rules so far allow it. The product of the shares that were left estimates the share
of valid rows, without bias however well the rows were moved (Del Moral, Doucet and Jasra, Sequential Monte Carlo
samplers, 2006); independent populations give the interval.

Example: x, y and z are 1 to 4, all different.

    64 rows without rules; x != y leaves 3/4 of them, x != z 3/4 of these, y != z 2/3 of these: 64 * 3/8 = 24

Cost: for each rule a pass over the decisions, for all rows at once; 60 decisions of 6 and 152 rules take about 4 s. A
sum that few rows meet is tightened in steps, so that each leaves half of them.

Bias: the interval is that of a mean of 16, and too narrow where rare rows matter and none was drawn. Draws are the rows
of the last population, moved a few times more: nearly uniform, and not quite independent.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from math import ceil, floor, prod, sqrt

import numpy as np
from numpy.typing import NDArray

from dse.space.flat import ABSENT, Bools, Clause, FlatSpace, Ints, Linear, Rows, Rule, Table, Wide
from dse.space.methods.mdd.folds import fold_rows, judged
from dse.space.methods.sampling.tilt import TooRareError
from dse.space.methods.sampling.uniform import generator
from dse.space.methods.tally import Tally

_POPULATIONS = 16
_SIZE = 500
"""Rows of one population."""

_STUDENT = 2.131449546
"""97.5 % of Student's t with 15 degrees of freedom."""

_THINNED = 0.7
"""Share of rows left at which they are replaced and moved."""

_LAST_MOVES = 10
"""Times that every row is moved before it is drawn."""

_BLOCK = _POPULATIONS * _SIZE

Columns = NDArray[np.int16]
"""Shape (variables, rows)."""


def estimate(flat: FlatSpace, seed: int) -> Tally:
    """About how many rows are valid. Raises TooRareError if all rows were lost on the way."""
    shares = _Population(flat, seed).thinned()
    total = combinations_of(flat)
    mean = float(shares.mean())
    half = _STUDENT * float(shares.std(ddof=1)) / sqrt(_POPULATIONS)
    value, low, high = (total * Fraction(share) for share in (mean, max(mean - half, 0.0), mean + half))
    return Tally(round(value), False, max(floor(low), 1), min(ceil(high), total))


def drawn(flat: FlatSpace, number: int, seed: int) -> Rows:
    """*number* valid rows, nearly uniform; the first are those of a smaller number. Raises TooRareError."""
    blocks = []
    for block in range(ceil(number / _BLOCK)):
        population = _Population(flat, seed + block)
        population.thinned()
        for _ in range(_LAST_MOVES):
            population.move()
        blocks.append(population.shuffled())
    return np.concatenate([np.zeros((0, len(flat.variables)), np.int16), *blocks])[:number]


def combinations_of(flat: FlatSpace) -> int:
    """How many rows the hierarchy alone has."""
    below = _below(flat)
    return prod(sum(below[number]) for number, variable in enumerate(flat.variables) if variable.parent is None)


def _below(flat: FlatSpace) -> list[list[int]]:
    """In how many ways the decisions below each value of each variable can be made."""
    below = [[1] * len(variable.values) for variable in flat.variables]
    for number in reversed(range(len(flat.variables))):
        parent = flat.variables[number].parent
        if parent is not None:
            below[parent[0]][parent[1]] *= sum(below[number])
    return below


class _Population:
    """Rows of several populations side by side, and the rules they meet so far."""

    def __init__(self, flat: FlatSpace, seed: int) -> None:
        self._flat = flat
        self._random = generator(seed)
        self._shares = [np.cumsum([Fraction(ways, sum(each)) for ways in each]).astype(float) for each in _below(flat)]
        top: list[int] = []
        for number, variable in enumerate(flat.variables):
            top.append(number if variable.parent is None else top[variable.parent[0]])
        self._trees = [[n for n, root in enumerate(top) if root == number] for number in sorted(set(top))]
        self._columns: Columns = np.full((len(flat.variables), _BLOCK), ABSENT, np.int16)
        for tree in self._trees:
            for number, column in self._redrawn(tree).items():
                self._columns[number] = column
        self._alive = np.ones(_BLOCK, np.bool_)
        self._rules: list[Rule] = []
        self._sums: dict[int, Ints] = {}
        self._touching: list[set[int]] = [set() for _ in flat.variables]

    def thinned(self) -> NDArray[np.float64]:
        """Thin the rows by every rule; the share of rows left, by population. Raises TooRareError if there is none."""
        shares = np.ones(_POPULATIONS)
        for rule in self._flat.rules:
            for step in self._steps(rule):
                self._alive &= self._holds(step, {})
                self._add(step)
                if self._alive.mean() < _THINNED:
                    shares *= self._replace()
                    self.move()
        return shares * self._replace()

    def move(self) -> None:
        """Each decision redrawn where the rules allow it, then decisions of as many values swapped in pairs."""
        for tree in self._trees:
            self._try(self._redrawn(tree))
        alike: dict[int, list[int]] = {}
        for tree in self._trees:
            if len(tree) == 1:
                alike.setdefault(len(self._flat.variables[tree[0]].values), []).append(tree[0])
        for numbers in alike.values():
            mixed = self._random.permutation(numbers).tolist()
            for one, other in zip(mixed[::2], mixed[1::2], strict=False):
                first, second = self._columns[[one, other]]
                # Not in all rows, so that copies become different.
                swaps = self._random.random(_BLOCK) < 0.5
                self._try({one: np.where(swaps, second, first), other: np.where(swaps, first, second)})

    def shuffled(self) -> Rows:
        """The rows in an order at random."""
        rows: Rows = np.ascontiguousarray(self._columns[:, self._random.permutation(_BLOCK)].T)
        return rows

    def _steps(self, rule: Rule) -> Iterator[Rule]:
        """The rule; a sum that few rows meet with wider bounds first, each of which half of the rows meet."""
        if isinstance(rule, Linear):
            before = None
            while True:
                beyond = _beyond(rule, self._total(rule))[self._alive]
                slack = int(np.median(beyond)) if before is None else min(int(np.median(beyond)), before - 1)
                if slack <= 0:
                    break
                low = None if rule.low is None else rule.low - slack
                high = None if rule.high is None else rule.high + slack
                yield Linear(rule.weights, low, high)
                before = slack
        yield rule

    def _add(self, rule: Rule) -> None:
        """From now on the rule has to be met."""
        scope: Sequence[int]
        match rule:
            case Table():
                scope = rule.scope
            case Clause():
                scope = [number for number, _ in rule.literals]
            case Linear():
                scope = list(rule.weights)
                self._sums[len(self._rules)] = self._total(rule)
            case Wide():
                scope = list({number for fold in rule.folds for number in fold.values})
        for number in scope:
            self._touching[number].add(len(self._rules))
        self._rules.append(rule)

    def _redrawn(self, tree: Sequence[int]) -> dict[int, Columns]:
        """New values of a decision and all below it, each way to make them as likely as any other."""
        found: dict[int, Columns] = {}
        for number in tree:
            parent = self._flat.variables[number].parent
            column = np.searchsorted(self._shares[number], self._random.random(_BLOCK), "right").astype(np.int16)
            np.minimum(column, len(self._shares[number]) - 1, out=column)
            found[number] = column if parent is None else np.where(found[parent[0]] == parent[1], column, np.int16(-1))
        return found

    def _try(self, changed: Mapping[int, Columns]) -> None:
        """Take the new values of some variables in the rows that meet all rules with them."""
        allowed = np.ones(_BLOCK, np.bool_)
        sums: dict[int, Ints] = {}
        for place in sorted(set().union(*(self._touching[number] for number in changed))):
            rule = self._rules[place]
            if isinstance(rule, Linear):
                sums[place] = self._sums[place].copy()
                for number, column in changed.items():
                    if number in rule.weights:
                        sums[place] += rule.weights[number][column] - rule.weights[number][self._columns[number]]
                allowed &= _beyond(rule, sums[place]) == 0
            else:
                allowed &= self._holds(rule, changed)
        for number, column in changed.items():
            self._columns[number][allowed] = column[allowed]
        for place, total in sums.items():
            self._sums[place][allowed] = total[allowed]

    def _holds(self, rule: Rule, changed: Mapping[int, Columns]) -> Bools:
        """Which rows meet a rule, with the new values of some variables."""

        def column(number: int) -> Columns:
            return changed.get(number, self._columns[number])

        match rule:
            case Table():
                found: Bools = np.broadcast_to(rule.allowed[tuple(map(column, rule.scope))], _BLOCK)
                return found
            case Clause():
                met: Bools = np.logical_or.reduce([mask[column(number)] for number, mask in rule.literals])
                return met
            case Linear():
                within: Bools = _beyond(rule, self._total(rule)) == 0
                return within
            case Wide():
                rows = np.array([column(number) for number in range(len(self._columns))]).T
                return np.broadcast_to(judged(rule, [fold_rows(fold, rows) for fold in rule.folds]), _BLOCK)

    def _total(self, rule: Linear) -> Ints:
        total = np.zeros(_BLOCK, np.int64)
        for number, weights in rule.weights.items():
            total += weights[self._columns[number]]
        return total

    def _replace(self) -> NDArray[np.float64]:
        """Copies of rows that are alive in place of the others of their population; the share that was alive.

        A population that died out goes on with rows of the others, and counts as nothing.
        """
        alive, self._alive = self._alive, np.ones(_BLOCK, np.bool_)
        if not alive.any():
            raise TooRareError
        taken = np.arange(_BLOCK).reshape(_POPULATIONS, _SIZE)
        left = alive.reshape(_POPULATIONS, _SIZE)
        for own, lives in zip(taken, left, strict=True):
            source = own[lives] if lives.any() else np.flatnonzero(alive)
            own[~lives] = self._random.choice(source, int((~lives).sum()))
        places = taken.ravel()
        self._columns = self._columns[:, places]
        self._sums = {place: total[places] for place, total in self._sums.items()}
        share: NDArray[np.float64] = left.mean(axis=1)
        return share


def _beyond(rule: Linear, total: Ints) -> Ints:
    """How far each sum is outside the bounds."""
    found = np.zeros(len(total), np.int64)
    if rule.low is not None:
        found = np.maximum(found, rule.low - total)
    if rule.high is not None:
        found = np.maximum(found, total - rule.high)
    return found
