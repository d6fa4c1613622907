"""What `study.sqlite` knows of the files of waveforms."""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping

from dse.storage.waveform_check import FileFacts

FILES = """CREATE TABLE files (
    name TEXT PRIMARY KEY, size INTEGER NOT NULL, modified INTEGER NOT NULL, digest TEXT NOT NULL) STRICT"""


def read_files(connection: sqlite3.Connection) -> dict[str, FileFacts]:
    """Facts by name; none in a study of an earlier version."""
    (is_there,) = connection.execute("SELECT count(*) FROM sqlite_schema WHERE name = 'files'").fetchone()
    rows = connection.execute("SELECT name, size, modified, digest FROM files") if is_there else ()
    return {name: FileFacts(*facts) for name, *facts in rows}


def write_files(connection: sqlite3.Connection, files: Mapping[str, FileFacts]) -> None:
    """Store the facts of *files* in place of what was known; the caller has a transaction open."""
    rows = [(name, facts.size, facts.modified, facts.digest) for name, facts in files.items()]
    connection.executemany("INSERT OR REPLACE INTO files VALUES (?, ?, ?, ?)", rows)
