"""The tries at runs in `study.sqlite`."""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Iterable

from dse.storage.attempts import STOPPED, Attempt

ATTEMPTS = (
    """CREATE TABLE makers (
    id INTEGER PRIMARY KEY, host TEXT NOT NULL, process INTEGER NOT NULL, UNIQUE (host, process)) STRICT""",
    """CREATE TABLE attempts (
    id INTEGER PRIMARY KEY, run INTEGER NOT NULL, maker INTEGER NOT NULL, cause TEXT NOT NULL, seconds REAL) STRICT""",
)

FROM_TIMING = (
    "INSERT INTO makers VALUES (1, '', 0)",
    "INSERT INTO attempts (run, maker, cause, seconds) SELECT number, 1, '', wall FROM timing ORDER BY number",
    "DROP TABLE timing",
)
"""Before version 3 there was a table of seconds by run."""


def write_attempts(connection: sqlite3.Connection, maker: str, tries: Iterable[tuple[int, str, float]]) -> None:
    """Store *tries* (run, cause, seconds) of *maker*; the caller has a transaction open."""
    host, _, process = maker.rpartition("/")
    named = (host, int(process)) if host and process.isdecimal() else (maker, 0)
    connection.execute("INSERT OR IGNORE INTO makers (host, process) VALUES (?, ?)", named)
    (number,) = connection.execute("SELECT id FROM makers WHERE host = ? AND process = ?", named).fetchone()
    connection.executemany(
        "INSERT INTO attempts (run, maker, cause, seconds) VALUES (?, ?, ?, ?)",
        ((run, number, cause, seconds) for run, cause, seconds in tries),
    )


def read_causes(connection: sqlite3.Connection) -> dict[int, str]:
    """What the last try came to that gave no row, by run; not that it was stopped with its program."""
    if are_early(connection):
        return {}
    query = "SELECT run, cause FROM attempts WHERE cause NOT IN ('', ?) ORDER BY id"
    return dict(connection.execute(query, (STOPPED,)).fetchall())


def read_attempts(connection: sqlite3.Connection) -> list[Attempt]:
    """Every try, in the order they were stored; those of a study of an earlier version have no maker."""
    query = (
        "SELECT number, '', 0, '', wall FROM timing ORDER BY number"
        if are_early(connection)
        else "SELECT run, host, process, cause, seconds FROM attempts a JOIN makers m ON m.id = a.maker ORDER BY a.id"
    )
    return [
        Attempt(run, f"{host}/{process}" if process else host, cause, math.nan if seconds is None else seconds)
        for run, host, process, cause, seconds in connection.execute(query)
    ]


def read_retried(connection: sqlite3.Connection) -> dict[str, list[int]]:
    """The causes for which runs were tried more than once, each with its runs.

    A run that was made again without a cause, as for its waveforms, is none of them.
    """
    if are_early(connection):
        return {}
    query = """SELECT DISTINCT cause, run FROM attempts WHERE cause <> '' AND run IN
        (SELECT run FROM attempts GROUP BY run HAVING count(*) > 1) ORDER BY cause, run"""
    found: dict[str, list[int]] = {}
    for cause, run in connection.execute(query):
        found.setdefault(cause, []).append(run)
    return found


def are_early(connection: sqlite3.Connection) -> bool:
    """Whether the database was written by a version that kept no attempts."""
    return bool(connection.execute("SELECT count(*) FROM sqlite_schema WHERE name = 'timing'").fetchone()[0])
