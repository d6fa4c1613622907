"""Reads connections."""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from dse.domain.design import Compound, Connection, Node, Optional
from dse.domain.expression import Chosen
from dse.domain.labels import tightened
from dse.errors import Location, Problem, Problems, closest, fail
from dse.formats import Entry
from dse.loading.design.located_text import part, written


def read_connections(entry: Entry, connections: object, problems: Problems) -> tuple[Connection, ...]:
    """A list of ``source -> target``; what cannot be read is added to *problems*."""
    if not isinstance(connections, list):
        problems.add("'connections' must be a list", entry.where, "- sensor.target -> controller.target")
        return ()
    found = []
    for number, text in enumerate(connections):
        wire, _, condition = text.partition(" if ") if isinstance(text, str) else ("", "", "")
        ends = [tightened(end.strip()) for end in wire.split("->")]
        if len(ends) == 2 and all(_is_path(end) for end in ends):
            when = None
            with problems:
                when = _when(text, condition, entry[number]) if condition else None
            found.append(Connection(ends[0], ends[1], entry[number].where, _ends(entry[number], wire), when))
        else:
            form = "write it as 'sensor.target -> controller.target'"
            problems.add(f"'{text}' is not a connection", entry[number].where, form)
    return tuple(found)


def over_instances(
    connections: Sequence[Connection], parts: Mapping[str, Node], problems: Problems
) -> tuple[Connection, ...]:
    """*connections* with those that name a repeated part of *parts* written out, one for every instance.

    ``#`` is the number of the instance: ``radar.targets -> fusion.radar_#``.
    """
    found: list[Connection] = []
    for connection in connections:
        ends = [instances_of(end, parts) for end in (connection.source, connection.target)]
        numbers = {len(end) for end in ends if len(end) > 1} or {1}
        repeated = [end for end in ends if end not in ([connection.source], [connection.target])]
        if len(numbers) > 1 or ("#" in str(connection) and not repeated):
            what = "names places with different numbers of instances" if repeated else "has a # but no repeated place"
            problems.add(f"{connection} {what}", connection.where, "radar.targets -> fusion.radar_#")
            continue
        (number,) = numbers
        for place in range(number):
            source, target = (end[place if len(end) > 1 else 0].replace("#", str(place + 1)) for end in ends)
            found.append(replace(connection, source=source, target=target) if repeated else connection)
    return tuple(found)


def unknown_choices(connections: Iterable[Connection], choices: Mapping[str, Collection[str]]) -> Iterator[Problem]:
    """Every choice that one of *connections* depends on and that is none of *choices*, by place."""
    for connection in connections:
        place, names = connection.when or ("", ())
        known = choices.get(place, ())
        for name in [name for name in names if name not in known] if known or not place else [place]:
            what = f"{connection}: unknown choice '{name}'"
            yield Problem(what, connection.where, closest(name, known or [path for path in choices if choices[path]]))


def instances_of(end: str, parts: Mapping[str, Node]) -> list[str]:
    """The path *end* for every instance of the first repeated place in it; only itself if there is none, or named."""
    steps = end.split(".")
    for taken, step in enumerate(steps, 1):
        node = parts.get(step)
        node = node.content if isinstance(node, Optional) else node
        if not isinstance(node, Compound):
            return [end]
        parts = node.parts
        if node.repeated and (taken == len(steps) or steps[taken] not in parts):
            return [".".join([*steps[:taken], name, *steps[taken:]]) for name in parts]
    return [end]


def _when(text: str, condition: str, entry: Entry) -> tuple[str, tuple[str, ...]]:
    """What must be chosen where. Raises DseError."""
    passage = written(text, entry.origin)
    root = part(passage, len(text.rstrip()) - len(condition.rstrip()), len(passage.text)).parse().root
    if not isinstance(root, Chosen) or "absent" in root.options:
        raise fail(f"'{condition}' is not a choice", entry.where, "sensor.out -> filter.in if sensor is radar")
    return root.place, () if "present" in root.options else root.options


def _ends(entry: Entry, text: str) -> tuple[Location, Location]:
    passage = written(text, entry.origin)
    source = len(text) - len(text.lstrip())
    after = text.index("->") + 2
    target = after + len(text[after:]) - len(text[after:].lstrip())
    return part(passage, source, source + 1).where, part(passage, target, target + 1).where


def _is_path(text: str) -> bool:
    return all(_INDICES.sub("", step).replace("#", "1").isidentifier() for step in text.split("."))


_INDICES = re.compile(r"\[[0-9]+(,[0-9]+)*\]$")
