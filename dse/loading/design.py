"""Reads design spaces."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from dse.domain.component import Component, Interface
from dse.domain.design import (
    Alternative,
    Compound,
    Connection,
    Constraint,
    DesignSpace,
    Node,
    Optional,
    Part,
)
from dse.domain.expression import Binary, Call, Expression, Name, Unary
from dse.domain.expression import Node as Tree
from dse.errors import DseError, Location, Problem, closest, raise_if_any
from dse.loading.documents import ConstraintSection, DesignFile
from dse.loading.expression import parse_expression
from dse.loading.fields import read_section
from dse.loading.include import read_document
from dse.loading.names import check_name
from dse.loading.yaml import Document, Path_

FindComponent = Callable[[str, Location], Component]
"""Returns the component of that name, or raises DseError at the location."""


def read_design(
    path: Path, find: FindComponent, interfaces: Mapping[str, Interface], inside: Path | None = None
) -> DesignSpace:
    """One file of ``designs/`` of the workspace *inside*. Raises DseError with every problem in it."""
    document = read_document(path, inside)
    file = read_section(document, DesignFile)
    reader = _TreeReader(document, find, interfaces)
    root = reader.compound(file.design, ("root",), file.root)
    constraints = []
    for name, section in file.constraints.items():
        at: Path_ = ("constraints", name)
        check_name(name, document.key(at), reader.problems)
        try:
            constraints.append(Constraint(name, _rule(document, at, section), section.because, document.key(at)))
        except DseError as error:
            reader.problems += error.problems
    raise_if_any(reader.problems)
    assert root is not None  # noqa: S101  # no problem was found, so the root was read
    return DesignSpace(file.design, root, tuple(constraints), file.title, document.place(("design",)))


def read_connections(document: Document, at: Path_, entries: object, problems: list[Problem]) -> tuple[Connection, ...]:
    """A list of ``source -> target``; what cannot be read is added to *problems*."""
    if not isinstance(entries, list):
        problems.append(
            Problem("'connections' must be a list", document.place(at), "- sensor.target -> controller.target")
        )
        return ()
    connections = []
    for number, entry in enumerate(entries):
        where = document.place((*at, number))
        ends = [end.strip() for end in entry.split("->")] if isinstance(entry, str) else []
        if len(ends) != 2 or not all(_is_path(end) for end in ends):
            problems.append(
                Problem(f"'{entry}' is not a connection", where, "write it as 'sensor.target -> controller.target'")
            )
            continue
        connections.append(Connection(ends[0], ends[1], where))
    return tuple(connections)


def _is_path(text: str) -> bool:
    return all(part.isidentifier() for part in text.split("."))


class _TreeReader:
    """Reads containers; goes on after a problem so that all are found at once."""

    def __init__(self, document: Document, find: FindComponent, interfaces: Mapping[str, Interface]) -> None:
        self.document = document
        self.find = find
        self.interfaces = interfaces
        self.problems: list[Problem] = []

    def node(self, at: Path_, entry: Any) -> Node | None:
        if isinstance(entry, str):
            return self.part(at, entry)
        if isinstance(entry, dict):
            for key in ("compound", "alternatives", "optional"):
                if key in entry:
                    return self.container(key, at, entry)
        self.problem(
            at,
            "expected a component or a container",
            "a component's name, {alternatives: […]}, {optional: …} or {compound: …}",
        )
        return None

    def container(self, key: str, at: Path_, entry: dict[str, Any]) -> Node | None:
        if key == "compound":
            return self.compound(str(at[-1]), at, entry)
        for other in entry:
            if other != key:
                self.unknown((*at, other), other, (key,))
        where = self.document.key(at)
        if key == "alternatives":
            return self.alternative((*at, key), entry[key])
        content = self.node((*at, key), entry[key])
        if isinstance(content, Optional):
            self.problem(at, "an optional container directly in an optional container", "remove one of them")
            return None
        return Optional(content, where) if content else None

    def compound(self, name: str, at: Path_, entry: dict[str, Any]) -> Compound | None:
        for key in entry:
            if key not in ("compound", "connections", "implements"):
                self.unknown((*at, key), key, ("compound", "connections", "implements"))
        children = entry.get("compound")
        if not isinstance(children, dict) or not children:
            self.problem(at, "'compound' must name at least one part", "compound: {sensor: radar}")
            return None
        parts: dict[str, Node] = {}
        for child, content in children.items():
            here = (*at, "compound", child)
            check_name(child, self.document.key(here), self.problems)
            node = self.node(here, content)
            if node:
                parts[child] = node
        connections = read_connections(self.document, (*at, "connections"), entry.get("connections", []), self.problems)
        interface = self.interface(at, entry["implements"]) if "implements" in entry else None
        return Compound(name, parts, connections, interface, self.document.key(at))

    def alternative(self, at: Path_, entries: Any) -> Alternative | None:
        if not isinstance(entries, list) or not entries:
            self.problem(at, "'alternatives' must be a list with at least one entry", "alternatives: [radar, lidar]")
            return None
        options: list[Part | Compound] = []
        for number, entry in enumerate(entries):
            option = self.option((*at, number), entry)
            if option is None:
                continue
            if any(option.name == other.name for other in options):
                self.problem((*at, number), f"'{option.name}' stands twice among the alternatives", "remove one")
                continue
            options.append(option)
        return Alternative(tuple(options), self.document.place(at)) if options else None

    def option(self, at: Path_, entry: Any) -> Part | Compound | None:
        if isinstance(entry, str):
            return self.part(at, entry)
        if isinstance(entry, dict) and len(entry) == 1:
            ((name, content),) = entry.items()
            check_name(name, self.document.key((*at, name)), self.problems)
            if isinstance(content, dict) and "compound" in content:
                return self.compound(name, (*at, name), content)
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
        if name in self.interfaces:
            return self.interfaces[name]
        self.problem((*at, "implements"), f"unknown interface '{name}'", closest(str(name), self.interfaces))
        return None

    def problem(self, at: Path_, what: str, hint: str) -> None:
        self.problems.append(Problem(what, self.document.place(at), hint))

    def unknown(self, at: Path_, key: str, known: tuple[str, ...]) -> None:
        self.problems.append(Problem(f"unknown key '{key}'", self.document.key(at), closest(key, known)))


def _rule(document: Document, at: Path_, section: ConstraintSection) -> Expression:
    given = [key for key in ("require", "forbid", "same_choice") if getattr(section, key) is not None]
    if len(given) != 1:
        what = "says nothing" if not given else f"says {' and '.join(given)}"
        raise DseError(
            Problem(f"constraint '{at[-1]}' {what}", document.key(at), "give one of require, forbid, same_choice")
        )
    if section.require is not None:
        return parse_expression(section.require, document.place((*at, "require")))
    if section.forbid is not None:
        return _forbidden(document, (*at, "forbid"), section.forbid)
    places = section.same_choice or []
    where = document.place((*at, "same_choice"))
    if len(places) < 2:
        raise DseError(
            Problem("'same_choice' needs at least two places", where, "same_choice: [front.tyre, rear.tyre]")
        )
    text = f"same_choice({', '.join(places)})"
    names = tuple(Name(place, (0, len(text))) for place in places)
    return Expression(text, Call("same_choice", names, (), (0, len(text))), where)


def _forbidden(document: Document, at: Path_, entries: list[str]) -> Expression:
    if not entries:
        raise DseError(Problem("'forbid' needs at least one condition", document.place(at)))
    parsed = [parse_expression(entry, document.place((*at, i))) for i, entry in enumerate(entries)]
    # A line break in the text says that columns within it are not columns of the file.
    text = "not (" + "\nand ".join(entries) + ")"
    span = (0, len(text))
    tree: Tree = parsed[0].root
    for other in parsed[1:]:
        tree = Binary("and", tree, other.root, span)
    return Expression(text, Unary("not", tree, span), document.place(at))
