"""What each constraint does: how many configurations it costs."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from dse.domain.design import Constraint
from dse.errors import Problem, closest, fail, raise_if_any
from dse.space.flat import NO_OWNER, Bools, Clause, FlatSpace, Ints, Judge, Linear, Rule, Table, Wide, single
from dse.space.methods.engine import Engine
from dse.space.methods.tally import Tally, total_of

MOST_CLAUSAL = 100
"""Constraints of a space without a diagram that are looked at together; each takes about a second."""

_WORK = 2e8
"""Additions for one exact count of the table; there are three for each constraint."""

_RELATIVE = 0.02
_DRAWS = 1024


@dataclass(frozen=True, slots=True)
class Impact:
    """*after*: valid once this constraint and those before it apply. *removes*: combinations that it alone excludes.

    *frees*: configurations that would become valid if it were dropped.
    """

    constraint: Constraint
    after: Tally
    removes: Tally
    frees: Tally

    @property
    def is_redundant(self) -> bool:
        """Whether the others exclude already all that this one excludes; proven."""
        return self.frees.exact and self.frees.value == 0


def impact(engine: Engine, seed: int = 0, names: Iterable[str] = ()) -> tuple[Impact, ...]:
    """The constraints of the space, or those called *names*, in the order of the file.

    Raises DseError for an unknown name, where nothing can be counted, and if too many constraints of a space without
    a diagram are asked for.
    """
    asked = _asked(engine.flat, tuple(names))
    if len(asked) > MOST_CLAUSAL and engine.diagram is None:
        example = engine.flat.constraints[asked[0]].name
        what = f"'{engine.flat.name}' is too large to look at {len(asked):,} constraints at once"
        raise fail(what, None, f"name up to {MOST_CLAUSAL} of them: --constraint {example}")
    return tuple(_impact(engine, number, seed) for number in asked)


def _asked(flat: FlatSpace, names: tuple[str, ...]) -> list[int]:
    known = [constraint.name for constraint in flat.constraints]
    raise_if_any(
        Problem(f"'{flat.name}' has no constraint '{name}' that is on", None, closest(name, known))
        for name in dict.fromkeys(names)
        if name not in known
    )
    return [number for number, name in enumerate(known) if not names or name in names]


def _impact(engine: Engine, number: int, seed: int) -> Impact:
    alone = engine.flat.only((number,))
    return Impact(
        engine.flat.constraints[number],
        counted(engine.only(range(number + 1)), seed),
        total_of(counted(Engine(case, engine), seed) for case in breaking(alone, number)),
        total_of(counted(Engine(case, engine), seed) for case in breaking(engine.flat, number)),
    )


def counted(engine: Engine, seed: int) -> Tally:
    """How many there are, exact or, where that takes long, about."""
    exact = engine.exact_count(_WORK)
    # An estimate cannot prove that there is nothing, and says nothing worth having of very few.
    if exact is None and engine.diagram is not None and engine.is_empty():
        exact = 0
    return engine.estimate(seed, _RELATIVE, _DRAWS) if exact is None else Tally(exact)


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
            return ((replace(rule, allowed=~rule.allowed, owner=NO_OWNER),),)
        case Linear():
            below = () if rule.low is None else ((replace(rule, low=None, high=rule.low - 1, owner=NO_OWNER),),)
            above = () if rule.high is None else ((replace(rule, low=rule.high + 1, high=None, owner=NO_OWNER),),)
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


MOST_CONSTRAINTS = 40
"""Each takes about a tenth of a second."""


def funnel(engine: Engine, seed: int = 0) -> tuple[Tally, ...]:
    """How many are valid once each constraint and those before it apply, in the order of the file.

    Raises DseError for a space without a diagram, in which each count takes a second, or too many constraints.
    """
    flat = engine.flat
    if engine.diagram is None or len(flat.constraints) > MOST_CONSTRAINTS:
        what = f"'{flat.name}' is too large to look at {len(flat.constraints):,} constraints one after the other"
        raise fail(what, None, f"dse space constraints {flat.name}")
    return tuple(counted(engine.only(range(number + 1)), seed) for number in range(len(flat.constraints)))
