"""Reads connections."""

from __future__ import annotations

import re

from dse.domain.design import Connection
from dse.domain.labels import tightened
from dse.errors import Location, Problems
from dse.formats import Entry
from dse.loading.design.located_text import part, written


def read_connections(entry: Entry, connections: object, problems: Problems) -> tuple[Connection, ...]:
    """A list of ``source -> target``; what cannot be read is added to *problems*."""
    if not isinstance(connections, list):
        problems.add("'connections' must be a list", entry.where, "- sensor.target -> controller.target")
        return ()
    found = []
    for number, text in enumerate(connections):
        ends = [tightened(end.strip()) for end in text.split("->")] if isinstance(text, str) else []
        if len(ends) == 2 and all(_is_path(end) for end in ends):
            found.append(Connection(ends[0], ends[1], entry[number].where, _ends(entry[number], text)))
        else:
            form = "write it as 'sensor.target -> controller.target'"
            problems.add(f"'{text}' is not a connection", entry[number].where, form)
    return tuple(found)


def _ends(entry: Entry, text: str) -> tuple[Location, Location]:
    passage = written(text, entry.origin)
    source = len(text) - len(text.lstrip())
    after = text.index("->") + 2
    target = after + len(text[after:]) - len(text[after:].lstrip())
    return part(passage, source, source + 1).where, part(passage, target, target + 1).where


def _is_path(text: str) -> bool:
    return all(_INDICES.sub("", step).isidentifier() for step in text.split("."))


_INDICES = re.compile(r"\[[0-9]+(,[0-9]+)*\]$")
