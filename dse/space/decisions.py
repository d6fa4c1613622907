"""A design space as decisions: what is chosen where, and under which choices a place is filled."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import count
from math import prod

from dse.domain.component import Component
from dse.domain.design import Alternative, Compound, DesignSpace, Node, Optional, Part

Choices = Mapping[str, str]
"""What is chosen, by the path of the decision; an optional part that is left out is not in it."""

BranchCondition = tuple[tuple[str, str], ...]
"""Choices (path, name) that must all have been made; empty is always true."""


@dataclass(frozen=True, slots=True)
class DecisionBranch:
    """One outcome of a decision, None for leaving the part out, and the decisions it brings along."""

    choice: str | None
    decisions: tuple[Decision, ...]


@dataclass(frozen=True, slots=True)
class Decision:
    """One choice to be made. *position* counts all decisions of the space in the order of the file.

    Two architectures may each have a decision of the same path; at most one of them exists at a time.
    """

    path: str
    position: int
    branches: tuple[DecisionBranch, ...]


@dataclass(frozen=True, slots=True)
class Site:
    """A component, or an architecture (*component* None), that stands at *path* when *condition* is met.

    *branch* says the same in one step: the position of the innermost decision above, and the number of its branch
    that brings the site along; None for what is always there.
    """

    path: str
    name: str
    component: Component | None
    condition: BranchCondition
    branch: tuple[int, int] | None = None

    def is_there(self, choices: Choices) -> bool:
        """Whether the choices put this here."""
        return all(choices.get(path) == name for path, name in self.condition)


def decisions(space: DesignSpace) -> tuple[Decision, ...]:
    """The decisions that always exist, in the order of the file; the others hang below their branches."""
    return _Survey().below(space.root, "", (), None)


def sites(space: DesignSpace) -> tuple[Site, ...]:
    """Everything that can stand somewhere, in the order of the file; the root compound is not a site."""
    survey = _Survey()
    times = Counter(decision.path for decision in flat(survey.below(space.root, "", (), None)))
    return tuple(replace(site, condition=_shortened(site.condition, times)) for site in survey.sites[1:])


def flat(tree: tuple[Decision, ...]) -> Iterator[Decision]:
    """Every decision of the tree, in order of position."""
    for decision in tree:
        yield decision
        for branch in decision.branches:
            yield from flat(branch.decisions)


def made(
    tree: tuple[Decision, ...], choice_at: Callable[[str], object]
) -> Iterator[tuple[Decision, DecisionBranch | None]]:
    """The decisions that the choices by path bring about, each with the branch that is chosen; None if none is."""
    for decision in tree:
        choice = choice_at(decision.path)
        branch = next((branch for branch in decision.branches if branch.choice == choice), None)
        yield decision, branch
        if branch:
            yield from made(branch.decisions, choice_at)


def combinations(space: DesignSpace) -> int:
    """In how many ways the decisions can be made, constraints aside; exact, and nothing is enumerated."""
    return _product(decisions(space))


def alternatives(space: DesignSpace) -> dict[str, tuple[str | None, ...]]:
    """What can be chosen at each path where anything can, None for leaving it out, in the order of the file."""
    found: dict[str, dict[str | None, None]] = {}
    for decision in flat(decisions(space)):
        found.setdefault(decision.path, {}).update((branch.choice, None) for branch in decision.branches)
    return {path: tuple(choices) for path, choices in found.items()}


def _product(tree: tuple[Decision, ...]) -> int:
    return prod(sum(_product(branch.decisions) for branch in decision.branches) for decision in tree)


class _Survey:
    """Finds decisions, and on the way *sites*, their conditions in full."""

    def __init__(self) -> None:
        self.positions = count()
        self.sites: list[Site] = []

    def below(
        self, node: Node, path: str, condition: BranchCondition, branch: tuple[int, int] | None
    ) -> tuple[Decision, ...]:
        """The decisions that are made wherever *node* is there."""
        match node:
            case Part():
                self.sites.append(Site(path, node.name, node.component, condition, branch))
                return ()
            case Compound():
                self.sites.append(Site(path, node.name, None, condition, branch))
                return tuple(
                    decision
                    for name, child in node.parts.items()
                    for decision in self.below(child, f"{path}.{name}" if path else name, condition, branch)
                )
            case Alternative(options) | Optional(Alternative(options)):
                pass
            case Optional(Part() | Compound() as content):
                options = (content,)
        position = next(self.positions)
        branches = [
            DecisionBranch(option.name, self.below(option, path, (*condition, (path, option.name)), (position, number)))
            for number, option in enumerate(options)
        ]
        if isinstance(node, Optional):
            branches.append(DecisionBranch(None, ()))
        return (Decision(path, position, tuple(branches)),)


def _shortened(condition: BranchCondition, times: Mapping[str, int]) -> BranchCondition:
    """Without the choices that a later one implies, because its decision exists only below them."""
    for start in range(len(condition) - 1, 0, -1):
        if times[condition[start][0]] == 1:
            return condition[start:]
    return condition
