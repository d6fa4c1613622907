"""The tables of `study.sqlite`, and how values are stored in their cells."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Sequence

from dse.domain.component import Value
from dse.errors import fail
from dse.json_data import read_json
from dse.storage.database.attempts import ATTEMPTS
from dse.storage.database.files import FILES
from dse.storage.database.header import StudyHeader

APPLICATION_ID = 0x44534553
"""Marks an SQLite file as a study ("DSES")."""

VERSION = 4
"""Version of these tables, stored as user_version.

Version 1 had no table of asks, 2 no attempts, files and row checksums, 3 no checks.
"""

SEALED = 3
"""The first version whose rows tell whether they are what was written."""

ROW_CHECKSUMS = tuple(f"ALTER TABLE {table} ADD COLUMN seal INTEGER" for table in ("runs", "kept"))

ASKS = """CREATE TABLE asks (
    first INTEGER PRIMARY KEY, count INTEGER NOT NULL, configuration TEXT NOT NULL, ask INTEGER NOT NULL,
    era INTEGER NOT NULL) STRICT"""

_FIXED = ("number", "configuration", "outcome", "problem")


def columns(header: StudyHeader) -> tuple[str, ...]:
    """Columns of the table of runs before its row checksum: fixed ones, ``p:`` variables, ``m:`` metrics, verdicts,
    margins."""
    return (
        *_FIXED,
        *(f"p:{name}" for name in header.variables),
        *(f"m:{name}" for name in header.metrics),
        *(f"verdict:{name}" for name in header.requirements),
        *(f"margin:{name}" for name in header.requirements),
    )


def checks_table(header: StudyHeader) -> str:
    """The SQL that makes the table of checks: error bars as ``e:METRIC``, verdicts under variations as ``v:R``."""
    names = (*(f"e:{name}" for name in header.metrics), *(f"v:{name}" for name in header.requirements))
    cells = ", ".join(_column(name) for name in ("number", "problem", *names))
    return f"CREATE TABLE checks ({cells}, seal INTEGER NOT NULL) STRICT"


def statements(header: StudyHeader) -> tuple[str, ...]:
    """The SQL that lays out an empty study. DseError if two names differ only in case, which SQLite cannot tell."""
    _refuse_twins(columns(header))
    return (
        "CREATE TABLE facts (key TEXT PRIMARY KEY, value TEXT NOT NULL) STRICT",
        "CREATE TABLE configurations (id TEXT PRIMARY KEY, choices TEXT NOT NULL, properties TEXT NOT NULL) STRICT",
        f"CREATE TABLE runs ({', '.join(_column(name) for name in columns(header))}, seal INTEGER) STRICT",
        "CREATE TABLE kept (number INTEGER PRIMARY KEY, file TEXT, seal INTEGER) STRICT",
        ASKS,
        *ATTEMPTS,
        FILES,
        checks_table(header),
        f"PRAGMA application_id = {APPLICATION_ID}",
        f"PRAGMA user_version = {VERSION}",
    )


def quoted(name: str) -> str:
    """*name* as an SQL identifier."""
    return '"' + name.replace('"', '""') + '"'


def cell_of(value: Value) -> float | str:
    """A point's value as stored: a float as it is; anything else as JSON text, so that its type comes back."""
    return value if type(value) is float else json.dumps(value, ensure_ascii=False)


def value_of(cell: float | str) -> Value:
    """The value behind a cell written by `cell_of`."""
    if isinstance(cell, str):
        value: Value = read_json(cell)
        return value
    return cell


def _column(name: str) -> str:
    kinds = {
        "number": "INTEGER PRIMARY KEY",
        "configuration": "TEXT NOT NULL",
        "outcome": "TEXT NOT NULL",
        "problem": "TEXT NOT NULL",
        "p": "ANY",
        "m": "REAL",
        "verdict": "TEXT NOT NULL",
        "margin": "REAL",
        "e": "REAL",
        "v": "INTEGER NOT NULL",
    }
    return f"{quoted(name)} {kinds[name.partition(':')[0]]}"


def _refuse_twins(names: Sequence[str]) -> None:
    counts = Counter(name.lower() for name in names)
    twins = [name for name in names if counts[name.lower()] > 1]
    if twins:
        shown = " and ".join(f"'{name.partition(':')[2]}'" for name in twins[:2])
        raise fail(f"{shown} cannot both be stored", hint="give them names that differ in more than case")
