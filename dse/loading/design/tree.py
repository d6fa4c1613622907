"""Reads the tree of containers of a design space."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Node, Optional, Part
from dse.errors import DseError, Location, Problem, closest
from dse.formats.yaml import Document, Path_
from dse.loading.design.connections import read_connections
from dse.loading.design.constraints import Rules
from dse.loading.design.scope import Spot
from dse.loading.names import check_choice, check_name

FindComponent = Callable[[str, Location], Component]
"""Returns the component of that name, or raises DseError at the location."""

_COMPOUND = ("compound", "connections", "implements", "constraints")


@dataclass(frozen=True, slots=True)
class Tree:
    """What was read: *root*, None if it is none, the mappings of constraints in it, outer ones first, and problems."""

    root: Compound | None
    rules: tuple[Rules, ...]
    problems: tuple[Problem, ...]


def read_tree(
    document: Document,
    name: str,
    entry: dict[str, Any],
    find: FindComponent,
    interfaces: Mapping[str, Interface],
) -> Tree:
    """The containers of the design space *name*, whose root is written as *entry*; with all that is wrong with them."""
    reader = _TreeReader(document, find, interfaces)
    root = reader.compound(name, ("root",), entry, Spot())
    return Tree(root, tuple(reader.rules), tuple(reader.problems))


class _TreeReader:
    """Goes on after a problem so that all are found at once."""

    def __init__(self, document: Document, find: FindComponent, interfaces: Mapping[str, Interface]) -> None:
        self.document = document
        self.find = find
        self.interfaces = interfaces
        self.problems: list[Problem] = []
        self.rules: list[Rules] = []

    def node(self, at: Path_, entry: Any, spot: Spot) -> Node | None:
        if isinstance(entry, str):
            return self.part(at, entry)
        if isinstance(entry, dict):
            for key in ("compound", "alternatives", "optional"):
                if key in entry:
                    return self.container(key, at, entry, spot)
        self.problem(
            at,
            "expected a component or a container",
            "a component's name, {alternatives: […]}, {optional: …} or {compound: …}",
        )
        return None

    def container(self, key: str, at: Path_, entry: dict[str, Any], spot: Spot) -> Node | None:
        if key == "compound":
            return self.compound(spot.path.rpartition(".")[2], at, entry, spot)
        for other in entry:
            if other != key:
                self.unknown((*at, other), other, (key,))
        where = self.document.key(at)
        if key == "alternatives":
            return self.alternative((*at, key), entry[key], spot)
        content = self.node((*at, key), entry[key], spot.optional())
        if isinstance(content, Optional):
            self.problem(at, "an optional container directly in an optional container", "remove one of them")
            return None
        return Optional(content, where) if content else None

    def compound(self, name: str, at: Path_, entry: dict[str, Any], spot: Spot) -> Compound | None:
        for key in entry:
            if key not in _COMPOUND:
                self.unknown((*at, key), key, _COMPOUND)
        children = entry.get("compound")
        if not isinstance(children, dict):
            self.problem(at, "'compound' must be a mapping of its parts", "compound: {sensor: radar}")
            return None
        if "constraints" in entry:
            self.rules.append(Rules((*at, "constraints"), spot, tuple(children)))
        parts: dict[str, Node] = {}
        for child, content in children.items():
            here = (*at, "compound", child)
            check_name(child, self.document.key(here), self.problems)
            node = self.node(here, content, spot.part(child))
            if node:
                parts[child] = node
        connections = read_connections(self.document, (*at, "connections"), entry.get("connections", []), self.problems)
        interface = self.interface(at, entry["implements"]) if "implements" in entry else None
        return Compound(name, parts, connections, interface, self.document.key(at))

    def alternative(self, at: Path_, entries: Any, spot: Spot) -> Alternative | None:
        if not isinstance(entries, list) or not entries:
            self.problem(at, "'alternatives' must be a list with at least one entry", "alternatives: [radar, lidar]")
            return None
        options: dict[str, Part | Compound] = {}
        for number, entry in enumerate(entries):
            option = self.option((*at, number), entry, spot)
            if option is None:
                continue
            if option.name in options:
                self.problem((*at, number), f"'{option.name}' stands twice among the alternatives", "remove one")
                continue
            options[option.name] = option
        return Alternative(tuple(options.values()), self.document.place(at)) if options else None

    def option(self, at: Path_, entry: Any, spot: Spot) -> Part | Compound | None:
        if isinstance(entry, str):
            return self.part(at, entry)
        if isinstance(entry, dict) and len(entry) == 1:
            ((name, content),) = entry.items()
            check_choice(name, self.document.key((*at, name)), self.problems)
            if isinstance(content, dict) and "compound" in content:
                return self.compound(name, (*at, name), content, spot.option(name))
        self.problem(
            at, "expected a component's name or one named architecture", "- hybrid: {compound: {…}, connections: […]}"
        )
        return None

    def part(self, at: Path_, name: str) -> Part | None:
        where = self.document.place(at)
        try:
            return Part(self.find(name, where), where)
        except DseError as error:
            self.problems += error.problems
            return None

    def interface(self, at: Path_, name: Any) -> Interface | None:
        if isinstance(name, str) and name in self.interfaces:
            return self.interfaces[name]
        self.problem((*at, "implements"), f"unknown interface '{name}'", closest(str(name), self.interfaces))
        return None

    def problem(self, at: Path_, what: str, hint: str) -> None:
        self.problems.append(Problem(what, self.document.place(at), hint))

    def unknown(self, at: Path_, key: str, known: tuple[str, ...]) -> None:
        self.problems.append(Problem(f"unknown key '{key}'", self.document.key(at), closest(key, known)))
