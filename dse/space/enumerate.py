"""Counting and listing the configurations of a design space.

The order is that of the file: parts are nested loops, the last part is the fastest, and an optional part is
there before it is left out. A constraint is evaluated as soon as all it depends on is decided.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import prod

from dse.domain.design import Configuration, DesignSpace
from dse.errors import DseError, Problem, fail, raise_if_any
from dse.space.decisions import Choices, Decision, decisions, flat, product_of
from dse.space.evaluate import Rule, compile_in
from dse.space.places import Places
from dse.space.resolve import Resolver

MOST_VISITS = 10**7
"""Combinations that `count` looks at before it gives up."""


def total(space: DesignSpace) -> int:
    """The number of combinations, constraints aside; exact, and nothing is enumerated."""
    return product_of(decisions(space))


def count(space: DesignSpace, limit: int = MOST_VISITS) -> int:
    """The exact number of valid configurations.

    Decisions behind the last one that any constraint depends on are multiplied, not visited. Raises DseError
    if more than *limit* combinations of the others would have to be looked at.
    """
    tree = decisions(space)
    rules = _compiled(space)
    last = rules[-1].position if rules else -1
    visits = _combinations(tree, last)
    if visits > limit:
        raise fail(
            f"'{space.name}' has {visits:,} combinations to check, more than the limit of {limit:,}",
            space.where,
            "list the first configurations instead: dse enumerate … --limit 100",
        )
    return sum(product_of(_pending(agenda)) for _, agenda in _search(tree, rules, last + 1))


def configurations(space: DesignSpace) -> Iterator[Configuration]:
    """Every valid configuration, one at a time, in the order of the file.

    Raises DseError, at once if a constraint cannot be understood, later if connections cannot be resolved.
    """
    rules = _compiled(space)
    return _configurations(space, rules)


def find(space: DesignSpace, name: str) -> Configuration:
    """The valid configuration whose id is *name* or starts with it. Raises DseError if there is not exactly one."""
    found = []
    for configuration in configurations(space):
        if configuration.id == name:
            return configuration
        if name and configuration.id.startswith(name):
            found.append(configuration)
    if len(found) == 1:
        return found[0]
    if found:
        listed = ", ".join(configuration.id for configuration in found[:5])
        raise fail(f"{len(found)} configurations of '{space.name}' start with '{name}'", space.where, f"as {listed}")
    raise fail(
        f"'{space.name}' has no valid configuration '{name}'", space.where, f"list them: dse enumerate {space.name}"
    )


def violated(space: DesignSpace, choices: Choices) -> tuple[str, ...]:
    """The names of the constraints that complete *choices* break, in the order of the file."""
    places = Places(space)
    return tuple(c.name for c in space.constraints if compile_in(c.rule, places).outcome(choices) is False)


@dataclass(frozen=True, slots=True)
class _Rule:
    """*position* is that of the last decision the rule depends on; -1 for none."""

    rule: Rule
    position: int


@dataclass(frozen=True, slots=True)
class _Agenda:
    """Decisions still to be made, a list that shares its tail."""

    decision: Decision
    rest: _Agenda | None


@dataclass(frozen=True, slots=True)
class _Step:
    """A branch to be taken from where *depth* choices stand and *checked* rules hold."""

    depth: int
    path: str
    choice: str | None
    agenda: _Agenda | None
    checked: int


def _compiled(space: DesignSpace) -> list[_Rule]:
    positions: dict[str, int] = {}
    for decision in flat(decisions(space)):
        positions[decision.path] = decision.position
    places = Places(space)
    rules: list[_Rule] = []
    problems: list[Problem] = []
    for constraint in space.constraints:
        try:
            rule = compile_in(constraint.rule, places)
        except DseError as error:
            problems += error.problems
            continue
        rules.append(_Rule(rule, max((positions[path] for path in rule.decisions), default=-1)))
    raise_if_any(problems)
    return sorted(rules, key=lambda rule: rule.position)


def _configurations(space: DesignSpace, rules: Sequence[_Rule]) -> Iterator[Configuration]:
    resolver = Resolver(space)
    tree = decisions(space)
    for choices, _ in _search(tree, rules, 1 + max((decision.position for decision in flat(tree)), default=-1)):
        yield resolver.configuration(choices)


def _search(tree: tuple[Decision, ...], rules: Sequence[_Rule], end: int) -> Iterator[tuple[Choices, _Agenda | None]]:
    """Every way to make the decisions before position *end* that no rule forbids, with what is left to decide.

    The choices are only good until the next one is asked for.
    """
    choices: dict[str, str] = {}
    trail: list[str] = []
    steps = [_Step(0, "", None, _pushed(tree, None), 0)]
    while steps:
        step = steps.pop()
        while len(trail) > step.depth:
            del choices[trail.pop()]
        if step.choice is not None:
            choices[step.path] = step.choice
            trail.append(step.path)
        agenda = step.agenda
        # Every decision before the next one is made, or does not exist.
        settled = agenda.decision.position if agenda else end
        checked = step.checked
        while checked < len(rules) and rules[checked].position < settled:
            if rules[checked].rule.outcome(choices) is False:
                break
            checked += 1
        else:
            if agenda is None or settled >= end:
                yield choices, agenda
                continue
            for branch in reversed(agenda.decision.branches):
                following = _pushed(branch.decisions, agenda.rest)
                steps.append(_Step(len(trail), agenda.decision.path, branch.choice, following, checked))


def _pushed(tree: tuple[Decision, ...], rest: _Agenda | None) -> _Agenda | None:
    for decision in reversed(tree):
        rest = _Agenda(decision, rest)
    return rest


def _pending(agenda: _Agenda | None) -> tuple[Decision, ...]:
    pending = []
    while agenda:
        pending.append(agenda.decision)
        agenda = agenda.rest
    return tuple(pending)


def _combinations(tree: tuple[Decision, ...], last: int) -> int:
    return prod(
        sum(_combinations(branch.decisions, last) for branch in decision.branches)
        for decision in tree
        if decision.position <= last
    )
