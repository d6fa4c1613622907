"""Choices → configuration."""

from __future__ import annotations

import base64
import hashlib

from dse.domain.component import Component
from dse.domain.design import Configuration, Connection, DesignSpace
from dse.errors import Problem, raise_if_any
from dse.space.decisions import Choices, Decision, Site, decisions, sites
from dse.space.wiring import wire

_ID_LENGTH = 10


def resolve(space: DesignSpace, choices: Choices) -> Configuration:
    """The configuration that *choices* describe, whether it is valid or not.

    Raises DseError if a decision is missing, does not exist, or has no such option.
    """
    problems: list[Problem] = []
    left = dict(choices)
    _settle(decisions(space), left, problems)
    problems += [Problem(f"there is no decision '{path}' in this design", space.where, "remove it") for path in left]
    raise_if_any(problems)
    return Resolver(space).configuration(choices)


def identify(choices: Choices) -> str:
    """The id of a configuration: ten letters and digits that depend on what is chosen where, on nothing else."""
    text = "\n".join(f"{path}={choice}" for path, choice in sorted(choices.items()))
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return base64.b32encode(digest).decode("ascii")[:_ID_LENGTH].lower()


class Resolver:
    """Makes configurations of one space; wiring is computed once for all that are built alike."""

    def __init__(self, space: DesignSpace) -> None:
        self._space = space
        self._sites = [(site, _shape(site)) for site in sites(space)]
        self._always = [number for number, (site, _) in enumerate(self._sites) if len(site.condition) != 1]
        self._under: dict[tuple[str, str], list[int]] = {}
        for number, (site, _) in enumerate(self._sites):
            if len(site.condition) == 1:
                self._under.setdefault(site.condition[0], []).append(number)
        self._wirings: dict[tuple[tuple[str, str], ...], tuple[Connection, ...]] = {}

    def configuration(self, choices: Choices) -> Configuration:
        """The configuration of *choices*, which must be complete and fit the space."""
        numbers = [number for number in self._always if self._sites[number][0].is_there(choices)]
        for choice in choices.items():
            numbers += self._under.get(choice, ())
        there = [self._sites[number] for number in sorted(numbers)]
        parts: dict[str, Component] = {site.path: site.component for site, _ in there if site.component}
        shape = tuple([shape for _, shape in there])
        if shape not in self._wirings:
            self._wirings[shape] = wire(self._space, choices)
        return Configuration(identify(choices), dict(choices), parts, self._wirings[shape])


def _shape(site: Site) -> tuple[str, str]:
    """What of a site decides the wiring: a component's interface, an architecture's name."""
    return site.path, f":{site.component.interface.name}" if site.component else site.name


def _settle(tree: tuple[Decision, ...], left: dict[str, str], problems: list[Problem]) -> None:
    for decision in tree:
        choice = left.pop(decision.path, None)
        branch = next((branch for branch in decision.branches if branch.choice == choice), None)
        if branch:
            _settle(branch.decisions, left, problems)
            continue
        options = ", ".join(b.choice or "(left out)" for b in decision.branches)
        what = f"'{decision.path}' cannot be '{choice}'" if choice else f"nothing is chosen for '{decision.path}'"
        problems.append(Problem(what, None, f"possible: {options}"))
