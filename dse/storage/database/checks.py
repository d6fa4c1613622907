"""The table of checks in `study.sqlite`: runs that were made again for error bars, as `Checks` has them."""

from __future__ import annotations

import json
import sqlite3
from collections.abc import Sequence

import numpy as np

from dse.storage.checks import NO_CHECKS, Checks
from dse.storage.database.header import StudyHeader
from dse.storage.database.row_checksum import cells_of, row_checksums


def write_checks(connection: sqlite3.Connection, checks: Checks) -> None:
    """Store *checks*; a run that has one keeps it. The caller has a transaction open."""
    cells = zip(checks.numbers.tolist(), checks.errors.tolist(), checks.verdicts.tolist(), strict=True)
    rows = [(number, checks.problems.get(number, ""), *errors, *verdicts) for number, errors, verdicts in cells]
    if rows:
        checked = zip(rows, row_checksums([*zip(*rows, strict=True)]).tolist(), strict=True)
        places = ", ".join("?" * (len(rows[0]) + 1))
        insert = f"INSERT OR IGNORE INTO checks VALUES ({places})"  # noqa: S608  # marks only
        connection.executemany(insert, [(*row, checksum) for row, checksum in checked])


def read_checks(connection: sqlite3.Connection, header: StudyHeader, numbers: Sequence[int] = ()) -> Checks:
    """The checks of the runs of *numbers*, or all of them if *numbers* is empty; none in an earlier version's study.

    ValueError if a row holds what was never written.
    """
    metrics, requirements = len(header.metrics), len(header.requirements)
    is_there = connection.execute("SELECT 1 FROM sqlite_schema WHERE name = 'checks'").fetchone()
    where = "WHERE number IN (SELECT value FROM json_each(?))" if numbers else ""
    query = f"SELECT * FROM checks {where} ORDER BY number"  # noqa: S608  # a constant
    rows = connection.execute(query, [json.dumps([*map(int, numbers)])] * bool(numbers)).fetchall() if is_there else ()
    if not rows:
        return NO_CHECKS
    those, problems, *cells, checked = zip(*rows, strict=True)
    for number, checksum, now in zip(those, checked, _with_checksum(those, problems, *cells), strict=True):
        if checksum != now:
            raise ValueError(f"the check of run {number} is not what was written")
    return Checks(
        np.array(those, dtype=np.int64),
        np.array(cells[:metrics], dtype=np.float64).reshape(metrics, len(rows)).T,
        np.array(cells[metrics:], dtype=np.int64).reshape(requirements, len(rows)).T,
        {number: text for number, text in zip(those, problems, strict=True) if text},
    )


def _with_checksum(*columns: tuple[object, ...]) -> list[int]:
    found: list[int] = row_checksums([cells_of(column) for column in columns]).tolist()
    return found
