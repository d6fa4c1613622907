"""A design space as decisions: what is chosen where, and under which choices a place is filled."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from math import prod

from dse.domain.component import Component
from dse.domain.design import Alternative, Compound, DesignSpace, Node, Optional, Part

Choices = Mapping[str, str]
"""What is chosen, by the path of the decision; an optional part that is left out is not in it."""

Condition = tuple[tuple[str, str], ...]
"""Choices (path, name) that must all have been made; empty is always true."""


@dataclass(frozen=True, slots=True)
class Branch:
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
    branches: tuple[Branch, ...]


@dataclass(frozen=True, slots=True)
class Site:
    """A component, or an architecture (*component* None), that stands at *path* when *condition* is met.

    *branch* says the same in one step: the position of the innermost decision above, and the number of its branch
    that brings the site along; None for what is always there.
    """

    path: str
    name: str
    component: Component | None
    condition: Condition
    branch: tuple[int, int] | None = None

    def is_there(self, choices: Choices) -> bool:
        """Whether the choices put this here."""
        return all(choices.get(path) == name for path, name in self.condition)


def decisions(space: DesignSpace) -> tuple[Decision, ...]:
    """The decisions that always exist, in the order of the file; the others hang below their branches."""
    return _decisions(space.root, "", _Positions())


def sites(space: DesignSpace) -> tuple[Site, ...]:
    """Everything that can stand somewhere, in the order of the file; the root compound is not a site."""
    times = Counter(decision.path for decision in flat(decisions(space)))
    positions = _Positions()
    found = (site for name, child in space.root.parts.items() for site in _sites(child, name, (), None, positions))
    return tuple(replace(site, condition=_shortened(site.condition, times)) for site in found)


def flat(tree: tuple[Decision, ...]) -> Iterator[Decision]:
    """Every decision of the tree, in order of position."""
    for decision in tree:
        yield decision
        for branch in decision.branches:
            yield from flat(branch.decisions)


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


class _Positions:
    def __init__(self) -> None:
        self.next = 0

    def take(self) -> int:
        self.next += 1
        return self.next - 1


def _decisions(node: Node, path: str, positions: _Positions) -> tuple[Decision, ...]:
    match node:
        case Part():
            return ()
        case Compound():
            return tuple(
                decision
                for name, child in node.parts.items()
                for decision in _decisions(child, _join(path, name), positions)
            )
        case Alternative() | Optional():
            position = positions.take()
            return (Decision(path, position, _branches(node, path, positions)),)


def _branches(node: Node, path: str, positions: _Positions) -> tuple[Branch, ...]:
    match node:
        case Optional():
            return (*_branches(node.content, path, positions), Branch(None, ()))
        case Alternative():
            return tuple(Branch(option.name, _decisions(option, path, positions)) for option in node.options)
        case Part() | Compound():
            return (Branch(node.name, _decisions(node, path, positions)),)


def _sites(
    node: Node, path: str, condition: Condition, branch: tuple[int, int] | None, positions: _Positions
) -> Iterator[Site]:
    match node:
        case Part():
            yield Site(path, node.name, node.component, condition, branch)
        case Compound():
            yield Site(path, node.name, None, condition, branch)
            for name, child in node.parts.items():
                yield from _sites(child, _join(path, name), condition, branch, positions)
        case Alternative():
            position = positions.take()
            for number, option in enumerate(node.options):
                below = (*condition, (path, option.name))
                yield from _sites(option, path, below, (position, number), positions)
        case Optional(Alternative() as content):
            yield from _sites(content, path, condition, branch, positions)
        case Optional(Part() | Compound() as content):
            below = (*condition, (path, content.name))
            yield from _sites(content, path, below, (positions.take(), 0), positions)


def _shortened(condition: Condition, times: Mapping[str, int]) -> Condition:
    """Without the choices that a later one implies, because its decision exists only below them."""
    for start in range(len(condition) - 1, 0, -1):
        if times[condition[start][0]] == 1:
            return condition[start:]
    return condition


def _join(path: str, name: str) -> str:
    return f"{path}.{name}" if path else name
