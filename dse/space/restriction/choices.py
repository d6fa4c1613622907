"""Choices a user states, ``sensor=radar``, as rules."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping

import numpy as np

from dse.domain.design import DesignSpace
from dse.errors import DseError, Problem, closest, raise_if_any
from dse.space.decisions import Choices, alternatives, decisions, made
from dse.space.flat import NO_OWNER, Clause, FlatSpace, Rule, by_path, single

ABSENT_NAME = "absent"
"""What a user calls a part that is left out."""


def read_choices(space: DesignSpace, texts: Iterable[str]) -> dict[str, str]:
    """Texts ``place=choice`` by place; every one must be a decision of *space* and one of its alternatives.

    Raises DseError with every problem in them.
    """
    options = _options(space)
    chosen: dict[str, str] = {}
    problems: list[Problem] = []
    for text in texts:
        path, _, choice = (piece.strip() for piece in text.partition("="))
        problem = _problem(space, options, text)
        if problem:
            problems.append(problem)
        elif chosen.setdefault(path, choice) != choice:
            problems.append(Problem(f"'{path}' is given twice", None, "give it once"))
    raise_if_any(problems)
    return chosen


def kept_choices(
    space: DesignSpace, keep: Iterable[str], drop: Iterable[str], within: Mapping[str, Collection[str | None]]
) -> dict[str, frozenset[str | None]]:
    """What may still be chosen, by place, after ``place=a,b`` to keep and to drop; only what is *within*, too.

    None is leaving a part out. Raises DseError with every problem in the texts, and for a place without a choice left.
    """
    options = _options(space)
    problems: list[Problem] = []
    left = {path: {choice or ABSENT_NAME for choice in within.get(path, options[path])} for path in options}
    touched = set(within)
    for texts, is_kept in ((keep, True), (drop, False)):
        for text in texts:
            path, _, listed = (piece.strip() for piece in text.partition("="))
            if not listed:
                problems.append(
                    Problem(
                        f"'{text}' means that nothing is {'kept' if is_kept else 'dropped'}", None, "write place=a,b"
                    )
                )
                continue
            named = {choice.strip() for choice in listed.split(",") if choice.strip()}
            found = [_problem(space, options, f"{path}={choice}") for choice in sorted(named) or [""]]
            problems += [problem for problem in found if problem]
            if not any(found):
                touched.add(path)
                left[path] = left[path] & named if is_kept else left[path] - named
    raise_if_any(problems)
    raise_if_any(
        Problem(f"nothing is left to choose at '{path}'", None, "keep one more alternative")
        for path in options
        if path in touched and not left[path]
    )
    return {
        path: frozenset(None if choice == ABSENT_NAME else choice for choice in left[path])
        for path in options
        if path in touched
    }


def choosing(space: FlatSpace, chosen: Choices) -> tuple[Rule, ...]:
    """The rules that each place of *chosen* has what it says; ``absent`` says that nothing stands there."""
    rules: list[Rule] = []
    at = by_path(space.variables)
    for path, choice in chosen.items():
        values = {number: space.variables[number].values for number in at[path]}
        masks = {number: np.array([*(value == choice for value in known), False]) for number, known in values.items()}
        if choice == ABSENT_NAME:
            rules += [single(number, np.array([*(v is None for v in known), True])) for number, known in values.items()]
        elif len(masks) == 1:
            ((number, mask),) = masks.items()
            rules.append(single(number, mask))
        else:
            rules.append(Clause(tuple(masks.items()), NO_OWNER))
    return tuple(rules)


def completed(space: DesignSpace, chosen: Choices) -> dict[str, str] | None:
    """*chosen* as the choices of one configuration; None if it leaves a decision open.

    Raises DseError if it decides something inside an architecture that it does not choose.
    """
    named = {path: None if choice == ABSENT_NAME else choice for path, choice in chosen.items()}
    done: dict[str, str] = {}
    # No branch is an ellipsis: that is what is open.
    for decision, branch in made(decisions(space), lambda path: named.get(path, ...)):
        if branch is None:
            return None
        if branch.choice is not None:
            done[decision.path] = branch.choice
    idle = [path for path, choice in chosen.items() if path not in done and choice != ABSENT_NAME]
    if idle:
        what = f"there is no '{idle[0]}' in a configuration with the other choices"
        raise DseError(Problem(what, None, "leave it out, or choose the architecture that has it"))
    return done


def _problem(space: DesignSpace, options: Mapping[str, list[str]], text: str) -> Problem | None:
    """What is wrong with ``place=choice``."""
    path, equals, choice = (piece.strip() for piece in text.partition("="))
    if not equals or not choice:
        return Problem(f"'{text}' is not a choice", None, "write place=choice, as sensor=radar")
    if path not in options:
        return Problem(f"there is no decision '{path}' in '{space.name}'", None, closest(path, options))
    if choice not in options[path]:
        return Problem(f"'{path}' cannot be '{choice}'", None, closest(choice, options[path]))
    return None


def _options(space: DesignSpace) -> dict[str, list[str]]:
    return {path: [choice or ABSENT_NAME for choice in choices] for path, choices in alternatives(space).items()}
