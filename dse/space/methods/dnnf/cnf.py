"""A space as clauses over Booleans, with exactly one model for each row.

Literals are whole numbers: Boolean b is literal 2b, its negation 2b + 1. Boolean 0 is always true.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations, product
from math import isqrt

import numpy as np

from dse.space.flat import ABSENT, NO_OWNER, Bools, Clause, FlatSpace, Linear, Table, Variable
from dse.space.methods.dnnf.trim import UnsupportedError

TRUE_LITERAL = 0
"""The literal that always holds."""

NO_LITERAL = -1
"""In place of the literal of a left-out part: it is left out iff it exists and its only value is not taken."""

_MOST_RIVALS = 40
"""Of more values than this at most one is said in two levels; the pairs would be too many."""

_MOST_SPLIT = 3
"""What a variable may not take is said in up to this many clauses rather than in one long one of what it may."""


@dataclass(frozen=True, slots=True)
class Cnf:
    """*exists* and *values* give the literals of every variable of the space, *owners* whose each clause is."""

    booleans: int
    clauses: tuple[tuple[int, ...], ...]
    owners: tuple[int, ...]
    exists: tuple[int, ...]
    values: tuple[tuple[int, ...], ...]


def encode(flat: FlatSpace) -> Cnf:
    """The hierarchy and rules of a space as clauses.

    Raises UnsupportedError, naming the rule, for `Wide` rules and sums that are no small counts.
    """
    writer = _Writer(flat)
    for rule in flat.rules:
        match rule:
            case Clause():
                writer.say(rule.literals, rule.owner)
            case Table():
                for box in boxes(flat, rule):
                    writer.say(tuple((number, ~mask) for number, mask in box), rule.owner)
            case Linear(_, None, None):
                pass
            case Linear():
                cases = {number: writer.cases(number, weights.tolist()) for number, weights in rule.weights.items()}
                encode_linear(rule, cases, writer.new, writer.add)
            case _:
                raise UnsupportedError(f"rule {rule.owner} is no clause, no table and no count")
    return writer.done()


class _Writer:
    def __init__(self, flat: FlatSpace) -> None:
        self._booleans = 1
        # The same clause may belong to several constraints, each of which may be to blame.
        self._clauses: dict[tuple[tuple[int, ...], int], None] = {((TRUE_LITERAL,), NO_OWNER): None}
        self._exists: list[int] = []
        self._values: list[tuple[int, ...]] = []
        for variable in flat.variables:
            exists = TRUE_LITERAL if variable.parent is None else self._values[variable.parent[0]][variable.parent[1]]
            self._exists.append(exists)
            self._values.append(self._decision(variable, exists))

    def new(self) -> int:
        """The literal of a further Boolean."""
        self._booleans += 1
        return 2 * self._booleans - 2

    def add(self, literals: Sequence[int], owner: int) -> None:
        """At least one of the literals holds."""
        distinct = set(literals)
        if TRUE_LITERAL in distinct or any(literal ^ 1 in distinct for literal in distinct):
            return
        distinct.discard(TRUE_LITERAL ^ 1)
        self._clauses[tuple(sorted(distinct)), owner] = None

    def say(self, literals: Sequence[tuple[int, Bools]], owner: int) -> None:
        """At least one of the variables takes what its mask allows."""
        for parts in product(*(self._forms(number, mask) for number, mask in literals)):
            self.add([literal for part in parts for literal in part], owner)

    def cases(self, number: int, amounts: Sequence[int]) -> list[tuple[list[int], int]]:
        """What the variable may do, as literals that all hold, and the amount that goes with it; absence is worth 0."""
        exists, values = self._exists[number], self._values[number]
        found: list[tuple[list[int], int]] = []
        for literal, amount in zip(values, amounts[:ABSENT], strict=True):
            if literal == NO_LITERAL:
                taken = next(other for other in values if other != NO_LITERAL)
                found.append(([exists, taken ^ 1], amount))
            else:
                found.append(([literal], amount))
        if exists != TRUE_LITERAL:
            found.append(([exists ^ 1], 0))
        return found

    def done(self) -> Cnf:
        """Everything said so far."""
        clauses, owners = zip(*self._clauses, strict=True)
        return Cnf(self._booleans, clauses, owners, tuple(self._exists), tuple(self._values))

    def _decision(self, variable: Variable, exists: int) -> tuple[int, ...]:
        if len(variable.values) == 1:
            return (exists,)
        if len(variable.values) == 2 and None in variable.values:
            literal = self.new()
            self.add((literal ^ 1, exists), NO_OWNER)
            return tuple(NO_LITERAL if value is None else literal for value in variable.values)
        if len(variable.values) == 2 and exists == TRUE_LITERAL:
            literal = self.new()
            return (literal, literal ^ 1)
        values = tuple(self.new() for _ in variable.values)
        self._exactly_one(values, exists)
        return values

    def _exactly_one(self, literals: tuple[int, ...], condition: int) -> None:
        """Exactly one of the literals if *condition* holds, else none."""
        pending = [(literals, condition)]
        while pending:
            some, above = pending.pop()
            if len(some) > _MOST_RIVALS:
                step = isqrt(len(some) - 1) + 1
                parts = [some[start : start + step] for start in range(0, len(some), step)]
                some = tuple(self.new() for _ in parts)
                pending.extend(zip(parts, some, strict=True))
            self.add((above ^ 1, *some), NO_OWNER)
            for literal in some:
                self.add((literal ^ 1, above), NO_OWNER)
            for one, other in combinations(some, 2):
                self.add((one ^ 1, other ^ 1), NO_OWNER)

    def _forms(self, number: int, mask: Bools) -> list[list[int]]:
        """Clauses that together say that the variable takes what its mask allows."""
        exists, values = self._exists[number], self._values[number]
        allowed = mask.tolist()
        if NO_LITERAL in values:
            left_out = values.index(NO_LITERAL)
            return _forms_of_optional(
                exists, values[1 - left_out], (allowed[1 - left_out], allowed[left_out], allowed[ABSENT])
            )
        absent = allowed[ABSENT] or exists == TRUE_LITERAL
        joined = [literal for literal, allows in zip(values, allowed, strict=False) if allows]
        split = [[literal ^ 1] for literal, allows in zip(values, allowed, strict=False) if not allows]
        if absent:
            joined.append(exists ^ 1)
        else:
            split.append([exists])
        if all(allowed[:ABSENT]):
            return [] if absent else [[exists]]
        return split if len(split) <= 1 or len(split) <= _MOST_SPLIT < len(joined) else [joined]


def _forms_of_optional(exists: int, taken: int, allowed: tuple[bool, bool, bool]) -> list[list[int]]:
    """The same for a part that may be left out; *allowed*: the part, leaving it out, absence."""
    forms: dict[tuple[bool, ...], list[list[int]]] = {
        (True, True, True): [],
        (True, True, False): [[exists]],
        (True, False, True): [[taken, exists ^ 1]],
        (True, False, False): [[taken]],
        (False, True, True): [[taken ^ 1]],
        (False, True, False): [[exists], [taken ^ 1]],
        (False, False, True): [[exists ^ 1]],
    }
    return forms.get(allowed, [[]])


Case = tuple[list[int], int]
"""Literals that hold together, and what the sum gains by it."""

MOST_STATES = 64
"""Distinct sums a counter may have to tell apart at one variable."""


def encode_linear(
    rule: Linear, cases: Mapping[int, list[Case]], new: Callable[[], int], add: Callable[[list[int], int], None]
) -> None:
    """Say that the sum stays within its bounds; *cases* of a variable exclude each other and leave nothing out.

    A sequential counter (Sinz 2005) over sums instead of ones: after each variable exactly one literal says what
    has been gathered, so the choices determine every literal and models stay one to one. Sums that can no longer
    matter are one. Raises UnsupportedError if there are more than MOST_STATES at a variable.
    """
    numbers = sorted(number for number in cases if any(amount for _, amount in cases[number]))
    least, most = _rest(numbers, cases)
    low = rule.low if rule.low is not None else least[0]
    high = rule.high if rule.high is not None else most[0]
    states: dict[int | None, int] = {0: 0}
    for at, number in enumerate(numbers):
        steps: list[tuple[list[int], int | None]] = []
        for state, literal in states.items():
            if state is None:
                steps.append(([literal], None))
                continue
            for holds, amount in cases[number]:
                gathered = state + amount
                together = [literal, *holds]
                if gathered + most[at + 1] < low or gathered + least[at + 1] > high:
                    add([each ^ 1 for each in together], rule.owner)
                elif low <= gathered + least[at + 1] and gathered + most[at + 1] <= high:
                    steps.append((together, None))
                else:
                    steps.append((together, gathered))
        ends = dict.fromkeys(state for _, state in steps)
        if len(ends) > MOST_STATES:
            raise UnsupportedError(f"rule {rule.owner} is a sum of too many distinct values")
        after = {state: new() for state in ends}
        for holds, end in steps:
            add([*(each ^ 1 for each in holds), after[end]], rule.owner)
        add(list(after.values()), rule.owner)
        for one, other in combinations(after.values(), 2):
            add([one ^ 1, other ^ 1], rule.owner)
        states = after
    if not numbers and not low <= 0 <= high:
        add([], rule.owner)


def _rest(numbers: list[int], cases: Mapping[int, list[Case]]) -> tuple[list[int], list[int]]:
    """Least and greatest sum of the variables from each place on."""
    least, most = [0], [0]
    for number in reversed(numbers):
        amounts = [amount for _, amount in cases[number]]
        least.append(least[-1] + min(amounts))
        most.append(most[-1] + max(amounts))
    return least[::-1], most[::-1]


CellBox = tuple[tuple[int, Bools], ...]
"""Cells by variable and mask, shape (values + 1,)."""

_Links = tuple[tuple[tuple[int, int, bool], ...] | None, ...]
"""By axis: the axes it hangs below, by which value, and whether directly; None for a root."""


def boxes(flat: FlatSpace, table: Table) -> list[CellBox]:
    """Boxes that hold every forbidden cell a row can reach, and no allowed one that a row can reach.

    Greedy: a box grows from the first cell not yet covered, axis by axis, as far as cells are forbidden or out of
    reach. An axis a box does not restrict is left out of it; a box without axes forbids everything.
    """
    axis_of = {number: axis for axis, number in enumerate(table.scope)}
    links: list[tuple[tuple[int, int, bool], ...] | None] = []
    for number in table.scope:
        above = flat.variables[number].parent
        found: list[tuple[int, int, bool]] = []
        is_root, direct = above is None, True
        while above is not None:
            if above[0] in axis_of:
                found.append((axis_of[above[0]], above[1], direct))
            above, direct = flat.variables[above[0]].parent, False
        links.append(None if is_root else tuple(found))
    allowed = np.ascontiguousarray(table.allowed)
    return [
        tuple((table.scope[axis], mask) for axis, mask in box)
        for box in _cover(allowed.shape, allowed.tobytes(), tuple(links))
    ]


@lru_cache(maxsize=1024)  # thousands of rules have the same few tables
def _cover(shape: tuple[int, ...], cells: bytes, links: _Links) -> tuple[CellBox, ...]:
    """Boxes by axis instead of variable."""
    allowed = np.frombuffer(cells, np.bool_).reshape(shape)
    reachable = _reachable(shape, links)
    free_to_take = ~(allowed & reachable)
    to_cover = ~allowed & reachable
    found: list[CellBox] = []
    while to_cover.any():
        cell = np.unravel_index(int(np.argmax(to_cover)), shape)
        masks = [np.arange(size) == at for size, at in zip(shape, cell, strict=True)]
        for axis, size in enumerate(shape):
            others = [np.flatnonzero(mask) for mask in masks]
            others[axis] = np.arange(size)
            block = np.moveaxis(free_to_take[np.ix_(*others)], axis, 0)
            masks[axis] = block.reshape(size, -1).all(axis=1)
        to_cover[np.ix_(*(np.flatnonzero(mask) for mask in masks))] = False
        found.append(tuple((axis, mask) for axis, mask in enumerate(masks) if not mask.all()))
    return tuple(found)


def _reachable(shape: tuple[int, ...], links: _Links) -> Bools:
    """The cells that the hierarchy alone lets a row take."""
    reachable = np.ones(shape, bool)
    for axis, above in enumerate(links):
        if above is None:
            np.moveaxis(reachable, axis, 0)[ABSENT] = False
            continue
        for other, value, direct in above:
            both = np.moveaxis(reachable, (axis, other), (0, 1))
            # No child without what it hangs below; and the parent's value not without the child.
            beside = [each for each in range(shape[other]) if each != value % shape[other]]
            both[np.ix_(range(len(both) - 1), beside)] = False
            if direct:
                both[ABSENT, value] = False
    return reachable
