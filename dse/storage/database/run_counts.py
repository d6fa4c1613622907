"""How far a study is and who made its runs, counted by the database: quick also where there are a million runs."""

from __future__ import annotations

import math
import sqlite3
from collections.abc import Mapping
from dataclasses import dataclass

from dse.storage.database.attempts import are_early

_RECENT = 1000
"""So many of the newest tries tell how long a run takes now."""


@dataclass(frozen=True, slots=True)
class Maker:
    """A process that made *runs* (or made them again), and whose *tries* gave no row; "" and 0 where nobody knows.

    *seconds* is what a run took it of late, NaN if it made none of the newest.
    """

    host: str
    process: int
    runs: int
    tries: int
    seconds: float


@dataclass(frozen=True, slots=True)
class RunCounts:
    """*finished* runs have a row, *failed* of them failed, *kept* have waveforms.

    *failures* counts what failed runs say, *tries* what tries came to that gave no row; *repeated* runs had one.
    *again* runs were made again, for waveforms or a comparison. *makers* by host and process.
    """

    finished: int
    failed: int
    kept: int
    failures: Mapping[str, int]
    tries: Mapping[str, int]
    repeated: int
    again: int
    makers: tuple[Maker, ...]


def read_run_counts(connection: sqlite3.Connection) -> RunCounts:
    """Count."""
    early = are_early(connection)

    def counted(query: str) -> dict[str, int]:
        return dict(connection.execute(query).fetchall())

    def number(query: str) -> int:
        return int(connection.execute(query).fetchone()[0])

    return RunCounts(
        number("SELECT count(*) FROM runs"),
        number("SELECT count(*) FROM runs WHERE outcome = 'failed'"),
        number("SELECT count(file) FROM kept"),
        counted("SELECT problem, count(*) n FROM runs WHERE outcome = 'failed' GROUP BY problem ORDER BY n DESC"),
        {}
        if early
        else counted("SELECT cause, count(*) n FROM attempts WHERE cause <> '' GROUP BY cause ORDER BY n DESC"),
        0 if early else number("SELECT count(DISTINCT run) FROM attempts WHERE cause <> ''"),
        0 if early else number("SELECT count(*) - count(DISTINCT run) FROM attempts WHERE cause = ''"),
        () if early else tuple(_makers(connection)),
    )


def _makers(connection: sqlite3.Connection) -> list[Maker]:
    made = connection.execute(
        "SELECT host, process, sum(cause = ''), sum(cause <> ''), m.id FROM attempts a JOIN makers m ON m.id = a.maker"
        " GROUP BY m.id ORDER BY host, process"
    ).fetchall()
    newest = "(SELECT * FROM attempts WHERE id > (SELECT max(id) FROM attempts) - ?)"
    recent = dict(
        connection.execute(
            f"SELECT maker, avg(seconds) FROM {newest} WHERE cause = '' GROUP BY maker",  # noqa: S608  # a constant
            (_RECENT,),
        ).fetchall()
    )
    return [
        Maker(host, process, runs, tries, math.nan if recent.get(key) is None else recent[key])
        for host, process, runs, tries, key in made
    ]
