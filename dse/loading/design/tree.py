"""Reads the tree of containers of a design space."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

from dse.domain.component import Component, Interface
from dse.domain.design import Alternative, Compound, Connection, Form, Node, Optional, Part
from dse.errors import Location, Problems, closest
from dse.formats import Entry
from dse.loading.design.allocation import read_allocation
from dse.loading.design.connection_choice import ChosenStructure, read_connect
from dse.loading.design.connections import over_instances, read_connections
from dse.loading.design.constraints import Rules
from dse.loading.design.repetition import REPETITION, StructureRule, instance, read_repetition, repetition_rules
from dse.loading.design.scope import Scope, constraint_name
from dse.loading.names import check_choice, check_name

FindComponent = Callable[[str, Location], Component]
"""Returns the component of that name, or raises DseError at the location."""

MODEL = "model"
"""What a component is called within what stands for it."""
_CHOICES = ("connect", "allocate")
_COMPOUND = ("compound", "title", "connections", "implements", "constraints", "repeated")


@dataclass(frozen=True, slots=True)
class Tree:
    """What was read: *root*, None if it is none, and the mappings of constraints in it, outer ones first.

    *structure* are the rules that its repetitions, connection choices and allocations follow.
    """

    root: Compound | None
    rules: tuple[Rules, ...]
    structure: tuple[StructureRule, ...]


def read_tree(
    entry: Entry,
    name: str,
    written: dict[str, Any],
    find: FindComponent,
    interfaces: Mapping[str, Interface],
    stand_ins: Mapping[str, Entry],
    problems: Problems,
) -> Tree:
    """The containers of the design space *name*, whose root is *written* so; what is wrong is added to *problems*."""
    reader = _TreeReader(find, interfaces, stand_ins, problems)
    root = reader.compound(name, entry, written, Scope())
    return Tree(root, tuple(reader.rules), tuple(reader.structure))


class _TreeReader:
    """Goes on after a problem so that all are found at once."""

    def __init__(
        self,
        find: FindComponent,
        interfaces: Mapping[str, Interface],
        stand_ins: Mapping[str, Entry],
        problems: Problems,
    ) -> None:
        self.find = find
        self.interfaces = interfaces
        self.stand_ins = stand_ins
        self.problems = problems
        self.rules: list[Rules] = []
        self.structure: list[StructureRule] = []

    def node(self, entry: Entry, written: Any, scope: Scope) -> Node | None:
        if isinstance(written, str):
            return self.part(entry, written)
        if isinstance(written, dict):
            for key in ("times", "compound", "alternatives", "optional"):
                if key in written:
                    return self.container(key, entry, written, scope)
        forms = "a component's name, {alternatives: […]}, {optional: …}, {compound: …} or {times: …}"
        self.problems.add("expected a component or a container", entry.where, forms)
        return None

    def container(self, key: str, entry: Entry, written: dict[str, Any], scope: Scope) -> Node | None:
        if key == "compound":
            return self.compound(scope.path.rpartition(".")[2], entry, written, scope)
        if key == "times":
            return self.repetition(entry, written, scope)
        self.expect_keys(entry, written, (key,))
        if key == "alternatives":
            return self.alternative(entry[key], written[key], scope)
        content = self.node(entry[key], written[key], scope.optional())
        if isinstance(content, Optional):
            what = "an optional container directly in an optional container"
            self.problems.add(what, entry.where, "remove one of them")
            return None
        return Optional(content, entry.key) if content else None

    def compound(self, name: str, entry: Entry, written: dict[str, Any], scope: Scope) -> Compound | None:
        self.expect_keys(entry, written, _COMPOUND)
        children = written.get("compound")
        if not isinstance(children, dict):
            what = "'compound' must be a mapping of its parts"
            self.problems.add(what, entry.where, "compound: {sensor: radar}")
            return None
        if "constraints" in written:
            self.rules.append(Rules(entry["constraints"], scope, tuple(children)))
        parts: dict[str, Node] = {}
        is_repeated = written.get("repeated", False)
        if not isinstance(is_repeated, bool):
            self.problems.add("'repeated': expected true or false", entry["repeated"].where, "write repeated: true")
        for child, content in children.items():
            here = entry["compound"][child]
            check_name(child, here.key, self.problems)
            if not _is_choice(content):
                node = self.node(here, content, scope.part(child))
                if node:
                    parts[child] = instance(node, name) if is_repeated is True else node
        connections = read_connections(entry["connections"], written.get("connections", []), self.problems)
        # Choices between parts need the parts, and stand where they are written.
        before = len(self.problems)
        wires: list[Connection] = []
        chosen: dict[str, Node] = {}
        for child, content in children.items():
            if _is_choice(content) and not before:
                with self.problems:
                    structure = self.choice(entry["compound"][child], content, parts, scope)
                    names = tuple(constraint_name(rule.scope, rule.name) for rule in structure.rules)
                    form = Form(content, structure.node.parts, (), names)
                    chosen[child] = replace(structure.node, form=form)
                    self.structure += structure.rules
                    wires += structure.wires
        parts = {child: {**parts, **chosen}[child] for child in children if child in parts or child in chosen}
        connections = over_instances(connections, parts, self.problems)
        interface = self.interface(entry["implements"], written["implements"]) if "implements" in written else None
        connections = (*connections, *wires)
        form = Form(written, parts, connections)
        title = written.get("title", "")
        if not isinstance(title, str):
            self.problems.add("'title': expected text", entry["title"].where, "title: Front radar")
        return Compound(
            name, parts, connections, interface, entry.key, is_repeated is True, form=form, title=str(title)
        )

    def choice(self, entry: Entry, content: dict[str, Any], parts: Mapping[str, Node], scope: Scope) -> ChosenStructure:
        """What *content* chooses between *parts*. Raises DseError."""
        return (read_connect if "connect" in content else read_allocation)(entry, parts, scope)

    def repetition(self, entry: Entry, written: dict[str, Any], scope: Scope) -> Compound | None:
        """A compound of the instances ``n1``, ``n2``, …, each read as a part of its own."""
        before, place = len(self.problems), scope.path.rpartition(".")[2]
        rules, structure = len(self.rules), len(self.structure)
        rest = {key: value for key, value in written.items() if key not in REPETITION}
        is_container = "compound" in rest or "alternatives" in rest
        if not is_container:
            self.expect_keys(entry, written, REPETITION)
        if is_container is ("of" in written) and len(self.problems) == before:
            hint = "{times: 1..4, of: radar}, or alternatives or compound instead of of"
            self.problems.add(f"'{entry.name}' needs one part that is repeated", entry.key, hint)
        if len(self.problems) > before:
            return None
        content, at = (rest, entry) if is_container else (written["of"], entry["of"])
        parts: dict[str, Node] = {}
        with self.problems:
            times = read_repetition(entry, written)
            for number in range(1, times.most + 1):
                here = scope.part(f"n{number}")
                node = self.node(at, content, here.optional() if number > times.least else here)
                if node is None or len(self.problems) > before:
                    return None
                node = instance(node, place)
                parts[f"n{number}"] = Optional(node, entry.key) if number > times.least else node
            self.structure += repetition_rules(entry, times, scope, parts)
        names = [constraint_name(each.scope, each.name) for each in self.structure[structure:]]
        names += [constraint_name(each.scope, name) for each in self.rules[rules:] for name in each.entry.data]
        form = Form(written, parts, (), tuple(names))
        return Compound(place, parts, where=entry.key, repeated=True, form=form) if parts else None

    def alternative(self, entry: Entry, written: Any, scope: Scope) -> Alternative | None:
        if not isinstance(written, list) or not written:
            what = "'alternatives' must be a list with at least one entry"
            self.problems.add(what, entry.where, "alternatives: [radar, lidar]")
            return None
        options: dict[str, Part | Compound] = {}
        for number, choice in enumerate(written):
            option = self.option(entry[number], choice, scope)
            if option is None:
                continue
            if option.name in options:
                what = f"'{option.name}' is listed twice among the alternatives"
                self.problems.add(what, entry[number].where, "remove one")
                continue
            options[option.name] = option
        return Alternative(tuple(options.values()), entry.where) if options else None

    def option(self, entry: Entry, written: Any, scope: Scope) -> Part | Compound | None:
        if isinstance(written, str):
            return self.part(entry, written)
        if isinstance(written, dict) and len(written) == 1:
            ((name, content),) = written.items()
            check_choice(name, entry[name].key, self.problems)
            if isinstance(content, dict) and "compound" in content:
                return self.compound(name, entry[name], content, scope.option(name))
        what = "expected a component's name or one named architecture"
        self.problems.add(what, entry.where, "- hybrid: {compound: {…}, connections: […]}")
        return None

    def part(self, entry: Entry, name: str) -> Part | Compound | None:
        where = entry.where
        with self.problems:
            part = Part(self.find(name, where), where)
            stand_in = self.stand_ins.get(part.component.interface.name)
            return self.within(stand_in, part) if stand_in else part
        return None

    def within(self, stand_in: Entry, part: Part) -> Compound | None:
        """What is put around the *part*, which is called `MODEL` there and has nothing around it any more."""
        rest = {name: entry for name, entry in self.stand_ins.items() if name != part.component.interface.name}
        reader = _TreeReader(self.find, self.interfaces, rest, self.problems)
        around = reader.compound(part.name, stand_in, stand_in.data, Scope())
        return around and replace(around, parts={**around.parts, MODEL: part}, where=part.where)

    def interface(self, entry: Entry, name: Any) -> Interface | None:
        if isinstance(name, str) and name in self.interfaces:
            return self.interfaces[name]
        self.problems.add(f"unknown interface '{name}'", entry.where, closest(str(name), self.interfaces))
        return None

    def expect_keys(self, entry: Entry, written: dict[str, Any], known: tuple[str, ...]) -> None:
        for key in written:
            if key not in known:
                self.problems.add(f"unknown key '{key}'", entry[key].key, closest(key, known))


def _is_choice(written: Any) -> bool:
    return isinstance(written, dict) and any(key in written for key in _CHOICES)
