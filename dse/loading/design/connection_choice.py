"""Connections that are chosen: ``feeds: {connect: radar -> ecu, outgoing: 1..*}`` decides who feeds whom.

A source of at most one connection is one decision between its targets, so is a target of at most one if its sources
may have several; other pairs are a decision each: connected or not. The degrees, and that what is absent has no
connections, are constraints. With ports, each possible connection is a wire that is there where it is chosen.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from dse.domain.design import Alternative, Compound, Connection, Node, Optional, Part
from dse.errors import DseError, closest, fail
from dse.formats import Entry
from dse.loading.design.located_text import added
from dse.loading.design.repetition import ANY_NUMBER, Bounds, StructureRule, read_bounds
from dse.loading.design.scope import Scope
from dse.loading.sections import Section, read_section


class ConnectSection(Section):
    """Which sources are connected to which targets."""

    connect: str
    outgoing: str | int = "0..*"
    incoming: str | int = "0..*"
    total: str | int = "0..*"
    exclude: list[str] = []
    parallel: int = 1
    unordered: bool = False
    undirected: bool = False


@dataclass(frozen=True, slots=True)
class Endpoint:
    """A part of the compound that may be connected, at *path* from there; *port* is empty if nothing is wired.

    *node* is what stands there.
    """

    path: str
    label: str
    node: Node
    port: str = ""
    is_optional: bool = False


@dataclass(frozen=True, slots=True)
class ChosenStructure:
    """What a choice of connections adds to its compound: a *node* of decisions, rules, and wires."""

    node: Compound
    rules: list[StructureRule]
    wires: list[Connection]


@dataclass(slots=True)
class Pattern:
    """Who may be connected to whom: pairs of numbers of *sources* and *targets*, with how many each may have."""

    sources: Sequence[Endpoint]
    targets: Sequence[Endpoint]
    pairs: set[tuple[int, int]]
    outgoing: Sequence[Bounds]
    incoming: Bounds = ANY_NUMBER
    total: Bounds = ANY_NUMBER
    parallel: int = 1
    unordered: bool = False
    undirected: bool = False


def read_connect(entry: Entry, parts: Mapping[str, Node], scope: Scope) -> ChosenStructure:
    """The choice at *entry* between the *parts* of the compound at *scope*. Raises DseError."""
    section = read_section(entry, ConnectSection)
    sources, targets = _sides(entry["connect"], section.connect, parts)
    outgoing, incoming, total = (
        read_bounds(entry[key], getattr(section, key)) for key in ("outgoing", "incoming", "total")
    )
    if not 1 <= section.parallel <= _MOST_PARALLEL:
        raise fail(f"{section.parallel} parallel connections", entry["parallel"].where, f"1 to {_MOST_PARALLEL}")
    if section.undirected and [end.path for end in sources] != [end.path for end in targets]:
        what = "'undirected' connects the same parts on both sides"
        raise fail(what, entry["undirected"].where, "connect: node -> node")
    if section.undirected and incoming != ANY_NUMBER:
        raise fail("'incoming' of undirected connections", entry["incoming"].where, "give outgoing alone")
    if section.unordered:
        _check_interchangeable(entry["unordered"], targets, section)
    never = excluded(entry["exclude"], section.exclude, parts, sources, targets)
    pairs = {
        (i, j)
        for (i, a), (j, b) in product(enumerate(sources), enumerate(targets))
        if a.path != b.path and (i, j) not in never
    }
    if section.undirected:
        pairs = {(i, j) for i, j in pairs if i < j and (j, i) in pairs}
    pattern = Pattern(
        sources,
        targets,
        pairs,
        [outgoing] * len(sources),
        incoming,
        total,
        section.parallel,
        section.unordered,
        section.undirected,
    )
    return chosen(entry, Layout(entry.name, pattern), parts, scope, {})


_MOST_PARALLEL = 100


def chosen(
    entry: Entry,
    layout: Layout,
    parts: Mapping[str, Node],
    scope: Scope,
    further: Mapping[str, Sequence[str]],
) -> ChosenStructure:
    """The decisions, rules and wires of *layout*, called as *entry*; *further* are conditions that hold as well.

    Raises DseError if no connections can do.
    """
    node = Compound(entry.name, dict(layout.nodes()), where=entry.key)
    names = (*parts, entry.name)
    rules = []
    for word, conditions in {**dict(layout.rules(entry)), **further}.items():
        if conditions:
            where = entry[word].key
            text = added(" and ".join(f"({condition})" for condition in conditions), where)
            rules.append(StructureRule(scope, names, f"{entry.name}_{word}", text, f"{word} of {entry.name}"))
    return ChosenStructure(node, rules, list(layout.wires(entry)))


class Layout:
    """The decisions of a pattern below the place *name*."""

    def __init__(self, name: str, pattern: Pattern) -> None:
        self.name = name
        self.pattern = pattern
        is_plain = pattern.parallel == 1 and not pattern.undirected
        self.single = {i for i, bounds in enumerate(pattern.outgoing) if is_plain and bounds.most == 1}
        self.by_target = is_plain and not self.single and pattern.incoming.most == 1 and not pattern.unordered
        self.columns = pattern.unordered and not self.single
        self.sources = [end.label for end in pattern.sources]
        self.targets = [end.label for end in pattern.targets]
        if pattern.unordered and self.single:
            # The targets are numbered in the order in which the sources need them.
            pattern.pairs = {(i, j) for i, j in pattern.pairs if j <= i}

    def place(self, i: int, j: int) -> tuple[str, tuple[str, ...]]:
        """The decision about a pair, and what is chosen there where the two are connected; none is anything."""
        source, target = self.sources[i], self.targets[j]
        if i in self.single:
            return f"{self.name}.{source}", (target,)
        if self.by_target:
            return f"{self.name}.{target}", (source,)
        return ".".join((self.name, target, source) if self.columns else (self.name, source, target)), ()

    def connected(self, i: int, j: int) -> str:
        """The condition that the two are connected."""
        path, names = self.place(i, j)
        return f"{path} is {names[0] if names else 'present'}"

    def nodes(self) -> Iterator[tuple[str, Node]]:
        """The parts of the place, by name."""
        pattern, names = self.pattern, (self.sources, self.targets)
        side = 1 if self.by_target or self.columns else 0
        for number, end in enumerate((pattern.sources, pattern.targets)[side]):
            own = sorted(pair for pair in pattern.pairs if pair[side] == number)
            others = {names[1 - side][pair[1 - side]]: pair for pair in own}
            bounds = pattern.incoming if side else pattern.outgoing[number]
            if others and (self.by_target or number in self.single):
                choice = Alternative(tuple(Compound(other, {}) for other in others))
                yield end.label, choice if bounds.least and not end.is_optional else Optional(choice)
            elif others:
                yield end.label, Compound(end.label, {other: self._pair(pair) for other, pair in others.items()})

    def _pair(self, pair: tuple[int, int]) -> Node:
        return Optional(Alternative(tuple(Compound(name, {}) for name in self._times(pair))))

    def _times(self, pair: tuple[int, int]) -> list[str]:
        """What is chosen for a pair that is connected once, twice and so on."""
        # Interchangeable targets have the same names, by which they are put in order.
        name = self.sources[pair[0]] + ("" if self.columns else f"_to_{self.targets[pair[1]]}")
        times = self.pattern.parallel
        return [name] if times == 1 else [f"{name}_x{n}" for n in range(1, times + 1)]

    def rules(self, entry: Entry) -> Iterator[tuple[str, list[str]]]:
        """The conditions of the pattern by what they are about. Raises DseError for a degree that is out of reach."""
        pattern = self.pattern
        pairs = sorted(pattern.pairs)
        for side, word in enumerate(("outgoing",) if pattern.undirected else ("outgoing", "incoming")):
            found: list[str] = []
            for number, end in enumerate((pattern.sources, pattern.targets)[side]):
                bounds = pattern.incoming if side else pattern.outgoing[number]
                own = [pair for pair in pairs if pair[side] == number or (pattern.undirected and pair[1] == number)]
                if own and (self.by_target if side else number in self.single):
                    if end.is_optional:
                        joint = "iff" if bounds.least else "implies"
                        found.append(f"{self.name}.{end.label} is present {joint} {end.path} is present")
                    continue
                found += self._degree(end, own, bounds, entry[word])
            yield word, found
        total = self._within(pairs, pattern.total)
        if total is None:
            raise _impossible(entry["total"], f"'{self.name}'", pattern.total)
        yield "total", total
        yield "unordered", list(self._unordered()) if pattern.unordered else []

    def _degree(self, end: Endpoint, pairs: Sequence[tuple[int, int]], bounds: Bounds, entry: Entry) -> Iterator[str]:
        """That *end* has as many connections as it should, and none where it is absent."""
        conditions = self._within(pairs, bounds)
        if conditions is None and not end.is_optional:
            raise _impossible(entry, f"'{end.path}'", bounds)
        for condition in ["false"] if conditions is None else conditions:
            yield f"{end.path} is present implies {condition}" if end.is_optional else condition
        if end.is_optional and pairs:
            yield f"{end.path} is absent implies at_most(0, {self._listed(pairs)})"

    def _within(self, pairs: Sequence[tuple[int, int]], bounds: Bounds) -> list[str] | None:
        """That the number of connections of *pairs* is within *bounds*; None if it cannot be."""
        times = self.pattern.parallel
        if bounds.least > times * len(pairs):
            return None
        number = " + ".join(
            f"(if {self.place(*pair)[0]} is {name} then {n} else 0)"
            for pair in pairs
            for n, name in enumerate(self._times(pair), 1)
        )
        least, most = bounds.least or None, bounds.most
        if most is not None and most >= times * len(pairs):
            most = None
        if times > 1:
            bounded = ((">=", least), ("<=", most))
            return [f"{number} {operator} {end}" for operator, end in bounded if end is not None]
        counted = (("exactly", least),) if least == most else (("at_least", least), ("at_most", most))
        return [f"{word}({end}, {self._listed(pairs)})" for word, end in counted if end is not None]

    def _listed(self, pairs: Sequence[tuple[int, int]]) -> str:
        return ", ".join(self.connected(*pair) for pair in pairs)

    def _unordered(self) -> Iterator[str]:
        if self.columns:
            if len(self.targets) > 1:
                yield f"ordered({', '.join(f'{self.name}.{target}' for target in self.targets)})"
            return
        for i, j in sorted(self.pattern.pairs):
            if j:
                earlier = " or ".join(self.connected(k, j - 1) for k in range(i) if (k, j - 1) in self.pattern.pairs)
                yield f"{self.connected(i, j)} implies {f'({earlier})' if earlier else 'false'}"

    def wires(self, entry: Entry) -> Iterator[Connection]:
        """A wire for every pair whose ends have ports; ``#`` in a port is the number of the other end."""
        for i, j in sorted(self.pattern.pairs):
            source, target = self.pattern.sources[i], self.pattern.targets[j]
            if source.port and target.port:
                a, b = source.port.replace("#", str(j + 1)), target.port.replace("#", str(i + 1))
                yield Connection(f"{source.path}.{a}", f"{target.path}.{b}", entry.key, when=self.place(i, j))


def _impossible(entry: Entry, who: str, bounds: Bounds) -> DseError:
    return fail(f"{who} cannot have {bounds} connections", entry.where, "there are too few parts on the other side")


def _sides(entry: Entry, text: str, parts: Mapping[str, Node]) -> tuple[list[Endpoint], list[Endpoint]]:
    sides = text.split("->")
    if len(sides) != 2:
        raise fail(f"'{text}' has no arrow", entry.where, "connect: radar -> ecu")
    sources, targets = (endpoints(entry, side.split(","), parts) for side in sides)
    for end in (*sources, *targets):
        if bool(end.port) is not bool(sources[0].port):
            raise fail(f"'{text}' has ports on one side only", entry.where, "connect: radar.targets -> ecu.radar_#")
    return sources, targets


def endpoints(entry: Entry, texts: Sequence[str], parts: Mapping[str, Node]) -> list[Endpoint]:
    """What ``a, b.port`` name among *parts*; a repeated part means its instances. Raises DseError."""
    found: list[Endpoint] = []
    for text in texts:
        found += _endpoints(entry, text.strip().split("."), parts)
    for end in found:
        if [other.label for other in found].count(end.label) > 1:
            raise fail(f"'{end.path}' is listed twice", entry.where, "remove one of the two")
    return found


def _endpoints(entry: Entry, steps: Sequence[str], parts: Mapping[str, Node]) -> Iterator[Endpoint]:
    if steps[0] not in parts:
        raise fail(f"unknown part '{steps[0]}'", entry.where, closest(steps[0], parts))
    node, taken, is_optional, label = parts[steps[0]], 1, False, steps[0]
    while isinstance(node, Optional) or (isinstance(node, Compound) and (node.interface is None or node.repeated)):
        if isinstance(node, Optional):
            node, is_optional = node.content, True
        elif taken < len(steps) and steps[taken] in node.parts:
            step = steps[taken]
            label += f"_{step.removeprefix('n') if node.repeated and step[1:].isdigit() else step}"
            node, taken = node.parts[step], taken + 1
        elif node.repeated:
            for name in node.parts:
                yield from _endpoints(entry, [*steps[:taken], name, *steps[taken:]], parts)
            return
        else:
            break
    yield Endpoint(".".join(steps[:taken]), label, node, ".".join(steps[taken:]), is_optional)


def excluded(
    entry: Entry,
    texts: Sequence[str],
    parts: Mapping[str, Node],
    sources: Sequence[Endpoint],
    targets: Sequence[Endpoint],
) -> set[tuple[int, int]]:
    """The pairs that ``a -> b`` name. Raises DseError for what is not on its side."""
    found: set[tuple[int, int]] = set()
    for number, text in enumerate(texts):
        ends = _sides(entry[number], text, parts)
        numbers: list[list[int]] = []
        for named, known in zip(ends, (sources, targets), strict=True):
            places = [end.path for end in known]
            for end in named:
                if end.path not in places:
                    raise fail(f"'{end.path}' is not on this side", entry[number].where, closest(end.path, places))
            numbers.append([places.index(end.path) for end in named])
        found |= {(i, j) for i in numbers[0] for j in numbers[1]}
    return found


def _check_interchangeable(entry: Entry, targets: Sequence[Endpoint], section: ConnectSection) -> None:
    names = {end.node.name if isinstance(end.node, Part) else "" for end in targets}
    if len(names) > 1 or "" in names:
        raise fail("'unordered' needs targets that are alike", entry.where, "targets: {times: 1..4, of: component}")
    if section.exclude or section.undirected:
        key = "exclude" if section.exclude else "undirected"
        raise fail(f"'{key}' makes unordered targets differ", entry.where, f"remove '{key}' or 'unordered'")
