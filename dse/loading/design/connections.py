"""Reads connections."""

from __future__ import annotations

from dse.domain.design import Connection
from dse.errors import Location, Problem
from dse.formats.yaml import Document, Path_
from dse.loading.passages import part, written


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
        connections.append(Connection(ends[0], ends[1], where, _ends(document, (*at, number), entry)))
    return tuple(connections)


def _ends(document: Document, at: Path_, entry: str) -> tuple[Location, Location]:
    text = written(entry, document.origin(at))
    source = len(entry) - len(entry.lstrip())
    after = entry.index("->") + 2
    target = after + len(entry[after:]) - len(entry[after:].lstrip())
    return part(text, source, source + 1).where, part(text, target, target + 1).where


def _is_path(text: str) -> bool:
    return all(part.isidentifier() for part in text.split("."))
