"""A space as clauses over Booleans, with exactly one model for each row.

Literals are whole numbers: Boolean b is literal 2b, its negation 2b + 1. Boolean 0 is always true.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, product
from math import isqrt

from dse.space.flat import ABSENT, NOBODY, Bools, Clause, FlatSpace, Linear, Table, Variable
from dse.space.methods.dnnf.counter import encode_linear
from dse.space.methods.dnnf.cover import boxes
from dse.space.methods.dnnf.trim import UnsupportedError

TRUE = 0
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
        self._clauses: dict[tuple[tuple[int, ...], int], None] = {((TRUE,), NOBODY): None}
        self._exists: list[int] = []
        self._values: list[tuple[int, ...]] = []
        for variable in flat.variables:
            exists = TRUE if variable.parent is None else self._values[variable.parent[0]][variable.parent[1]]
            self._exists.append(exists)
            self._values.append(self._decision(variable, exists))

    def new(self) -> int:
        """The literal of a further Boolean."""
        self._booleans += 1
        return 2 * self._booleans - 2

    def add(self, literals: Sequence[int], owner: int) -> None:
        """At least one of the literals holds."""
        distinct = set(literals)
        if TRUE in distinct or any(literal ^ 1 in distinct for literal in distinct):
            return
        distinct.discard(TRUE ^ 1)
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
        if exists != TRUE:
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
            self.add((literal ^ 1, exists), NOBODY)
            return tuple(NO_LITERAL if value is None else literal for value in variable.values)
        if len(variable.values) == 2 and exists == TRUE:
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
            self.add((above ^ 1, *some), NOBODY)
            for literal in some:
                self.add((literal ^ 1, above), NOBODY)
            for one, other in combinations(some, 2):
                self.add((one ^ 1, other ^ 1), NOBODY)

    def _forms(self, number: int, mask: Bools) -> list[list[int]]:
        """Clauses that together say that the variable takes what its mask allows."""
        exists, values = self._exists[number], self._values[number]
        allowed = mask.tolist()
        if NO_LITERAL in values:
            left_out = values.index(NO_LITERAL)
            return _forms_of_optional(
                exists, values[1 - left_out], (allowed[1 - left_out], allowed[left_out], allowed[ABSENT])
            )
        absent = allowed[ABSENT] or exists == TRUE
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
