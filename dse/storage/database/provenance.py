"""What is kept with a study besides its results: one more fact in `study.sqlite`, which earlier versions skip."""

from __future__ import annotations

import json
import sqlite3

from dse.domain.definition import to_json
from dse.domain.provenance import Provenance
from dse.json_data import read_json, read_noun

_KEY = "notes"


def write_provenance(connection: sqlite3.Connection, notes: Provenance) -> None:
    """Store *notes* in place of what was there; the caller has a transaction open."""
    text = json.dumps(to_json(notes), sort_keys=True, ensure_ascii=False, separators=(",", ":"))
    connection.execute("INSERT OR REPLACE INTO facts VALUES (?, ?)", (_KEY, text))


def read_provenance(connection: sqlite3.Connection) -> Provenance | None:
    """What `write_provenance` stored, None if nothing was. ValueError if that is not what it wrote."""
    row = connection.execute("SELECT value FROM facts WHERE key = ?", (_KEY,)).fetchone()
    if row is None:
        return None
    notes: Provenance = read_noun(read_json(row[0]), Provenance, _KEY)
    for source in notes.sources:
        if not source.is_sound:
            raise ValueError(f"the text of {source.file} is not what was written")
    return notes
