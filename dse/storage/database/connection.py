"""Opening `study.sqlite`, and turning what can go wrong with it into problems a user can act on."""

from __future__ import annotations

import errno
import hashlib
import json
import os
import re
import shutil
import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

from dse.domain.definition import StudyDefinition, to_json
from dse.errors import DseError, Location, fail, remedy
from dse.json_data import read_json, read_noun
from dse.storage.database.attempts import ATTEMPTS, FROM_TIMING
from dse.storage.database.definition import definition_to_json, read_definition
from dse.storage.database.files import FILES
from dse.storage.database.header import StudyHeader
from dse.storage.database.sampler_requests import Block, SamplerRequests, read_sampler_requests, write_sampler_requests
from dse.storage.database.schema import APPLICATION_ID, ASKS, ROW_CHECKSUMS, SEALED, VERSION, checks_table, statements
from dse.storage.disk import FULL, GO_ON, refused

NAME = "study.sqlite"

_BUSY_SECONDS = 30.0

_WHOLE = {
    sqlite3.SQLITE_FULL: FULL,
    sqlite3.SQLITE_IOERR: "the system refused (a quota, a limit on the size of files, a broken disk)",
    sqlite3.SQLITE_READONLY: "it may not be written to",
    sqlite3.SQLITE_PERM: "it may not be used",
    sqlite3.SQLITE_CANTOPEN: "a file could not be opened",
    sqlite3.SQLITE_BUSY: "another program keeps it locked",
    sqlite3.SQLITE_LOCKED: "another program keeps it locked",
    sqlite3.SQLITE_NOMEM: "there is no memory left",
}
"""SQLite's codes for what is no fault of the database; any other is a sign of bytes that this program never wrote."""

_UNREADABLE = "the disk did not give all of it (a broken disk, a lost connection)"

_LOOKS = 3
"""How often a database that SQLite calls malformed is looked at: a fault of the disk may have been there once."""

_LITTLE = 1 << 16
"""Bytes that SQLite needs to go on, beside the rows."""

_WHICH = "give a folder that 'dse explore' or 'dse run' created; 'dse list' shows those below out/"


@contextmanager
def located(path: Path) -> Iterator[None]:
    """SQLite's and the system's errors inside the block become a DseError that names the study folder *path*."""
    try:
        yield
    except sqlite3.Error as error:
        # Text that is no UTF-8 has no code: Python itself refuses it.
        code = getattr(error, "sqlite_errorcode", sqlite3.SQLITE_ERROR) & 0xFF
        why = _WHOLE.get(code)
        if getattr(error, "sqlite_errorcode", 0) == sqlite3.SQLITE_CORRUPT and not _is_read(path):
            why = _UNREADABLE
        if why is None:
            raise damaged_study(path, str(error)) from error
        if code in (sqlite3.SQLITE_IOERR, sqlite3.SQLITE_CANTOPEN):
            _require_usable(path)
        raise fail(f"{NAME} cannot be used, {why}: {error}", Location(str(path)), GO_ON) from error
    except UnicodeDecodeError as error:  # what SQLite says of damage may quote it
        raise damaged_study(path, str(error)) from error
    except OSError as error:
        raise refused(path, error) from error


def _require_usable(path: Path) -> None:
    """DseError with the reason why SQLite cannot use the study folder *path*, where it is one that lasts."""
    try:
        if shutil.disk_usage(path).free < _LITTLE:
            raise OSError(errno.ENOSPC, FULL)
        (path / NAME).open("rb").close()
    except OSError as error:
        what = f"{NAME} cannot be used: {error.strerror}"
        raise fail(what, Location(str(path)), remedy(error.errno, GO_ON)) from error


def _is_read(path: Path) -> bool:
    """Whether the database in the study folder *path* can be read, and is not what SQLite writes all the same.

    Where a disk does not give a page (EIO), SQLite calls the database malformed: only its check names the true reason.
    """
    for _ in range(_LOOKS):
        try:
            with (path / NAME).open("rb") as file:
                hashlib.file_digest(file, "sha256")
            with closing(sqlite3.connect(attachable(path), uri=True)) as connection:
                said = " ".join(str(line) for (line,) in connection.execute("PRAGMA integrity_check"))
        except OSError:
            return False
        except sqlite3.Error:
            continue
        return said != "ok" and not _is_of_disk(said)
    return True


def _is_of_disk(said: str) -> bool:
    """Whether SQLite's check *said* that it could not read a page."""
    return any(int(code) & 0xFF == sqlite3.SQLITE_IOERR for code in re.findall(r"error code=(\d+)", said))


def damaged_study(path: Path, why: str) -> DseError:
    """The problem of a study folder *path* whose database holds what this program never wrote."""
    return fail(f"{NAME} is damaged: {why}", Location(str(path)), "explore again into another folder, or with --fresh")


def attachable(path: Path) -> str:
    """What ``ATTACH`` is to be given for the study in *path*."""
    return _address(path / NAME).replace("mode=rw", "mode=ro")


def create_tables(path: Path, header: StudyHeader) -> None:
    """Write an empty `study.sqlite` into *path*, all of it or nothing. DseError if *header* cannot be stored."""
    try:
        read_definition(_json(definition_to_json(header.definition)))
    except (ValueError, RecursionError) as error:  # the latter while it is written
        raise fail(f"the study cannot be stored: {error}", Location(str(path))) from error
    aside = path / f"{NAME}.part"
    with located(path):
        aside.unlink(missing_ok=True)
    with located(path), closing(sqlite3.connect(aside, isolation_level=None)) as connection:
        # A journal beside it, left by a killed process, would be no part of the next one's.
        connection.execute("PRAGMA journal_mode = MEMORY")
        fill(connection, header)
    with located(path):
        aside.replace(path / NAME)


def fill(connection: sqlite3.Connection, header: StudyHeader) -> None:
    """Make the tables of an empty study in an empty database."""
    connection.execute("BEGIN")
    for statement in statements(header):
        connection.execute(statement)
    write_header(connection, header, SamplerRequests())
    connection.execute("COMMIT")


def connect(path: Path, *, write: bool) -> sqlite3.Connection:
    """A connection to the study in *path*; DseError if there is none or this program cannot read it."""
    file = path / NAME
    if not path.is_dir():
        what = "is not a study folder" if path.exists() else "there is no such folder"
        raise fail(what, Location(str(path)), _WHICH)
    if not file.is_file():
        raise fail(f"is not a study folder: there is no {NAME} in it", Location(str(path)), _WHICH)
    with located(path):
        connection = sqlite3.connect(_address(file), uri=True, isolation_level=None, timeout=_BUSY_SECONDS)
    try:
        with located(path):
            _check_version(path, connection)
            if write:
                connection.execute("PRAGMA journal_mode = WAL")
                # In WAL mode this survives a killed process; only a power cut may cost the last commits.
                connection.execute("PRAGMA synchronous = NORMAL")
            else:
                connection.execute("PRAGMA query_only = ON")
    except DseError:
        connection.close()
        raise
    return connection


def require_structure(connection: sqlite3.Connection, path: Path) -> None:
    """DseError if a page of the database is not what SQLite wrote, as far as SQLite can tell."""
    with located(path):
        (found,) = connection.execute("PRAGMA quick_check(1)").fetchone()
    if _is_of_disk(found):
        raise fail(f"{NAME} cannot be used, {_UNREADABLE}", Location(str(path)), GO_ON)
    if found != "ok":
        raise damaged_study(path, str(found).replace("\n", " "))


def write_header(connection: sqlite3.Connection, header: StudyHeader, asks: SamplerRequests) -> None:
    """Store *header* in place of what was there; the caller has a transaction open and *asks* stored."""
    facts = {key: getattr(header, key) for key in _COUNTS} | {"definition": definition_to_json(header.definition)}
    facts["seal"] = _header_checksum(facts, asks)
    connection.executemany(
        "INSERT OR REPLACE INTO facts VALUES (?, ?)", [(key, _json(value)) for key, value in facts.items()]
    )
    connection.executemany(
        "INSERT OR REPLACE INTO configurations VALUES (?, ?, ?)",
        [
            (configuration.id, _json(to_json(configuration.choices)), _json(to_json(configuration.totals)))
            for configuration in header.definition.configurations
        ],
    )


def read_header(connection: sqlite3.Connection, path: Path) -> tuple[StudyHeader, SamplerRequests]:
    """What `write_header` stored, in this version's tables or earlier ones, and the asks; DseError if it is none."""
    try:
        stored = dict(connection.execute("SELECT key, value FROM facts"))
        data, definition = read_definition(stored.pop("definition"))
        facts = {"definition": data} | {key: read_json(value) for key, value in stored.items()}
        if _version(connection) == 1:
            facts = _of_first_version(facts)
        counts: dict[str, int] = {key: read_noun(facts[key], int, key) for key in _COUNTS}
        if min(counts.values()) < 0:
            raise ValueError("a count is negative")
        asks = (
            _first_asks(definition, counts["runs"]) if _version(connection) == 1 else read_sampler_requests(connection)
        )
        if _version(connection) >= SEALED and facts["seal"] != _header_checksum(facts, asks):
            raise ValueError("they are not what was written")
    except (ValueError, KeyError, TypeError) as error:
        raise damaged_study(path, f"its facts cannot be read ({error})") from error
    first = sum(block.count for block in asks.of(asks.era, 0))
    return StudyHeader(definition, numbers=asks.numbers, first=first, **counts), asks


def migrate(connection: sqlite3.Connection, header: StudyHeader, asks: SamplerRequests) -> None:
    """Bring the tables of an earlier version up to this one; the caller has a transaction open."""
    version = _version(connection)
    if version == 1:
        connection.execute(ASKS)
        write_sampler_requests(connection, asks.blocks)
        connection.execute("DELETE FROM facts")
    if version < VERSION:
        added = (*ATTEMPTS, *FROM_TIMING, FILES, *ROW_CHECKSUMS) if version < SEALED else ()
        for statement in (*added, checks_table(header), f"PRAGMA user_version = {VERSION}"):
            connection.execute(statement)
        write_header(connection, header, asks)


_COUNTS = ("runs", "asked", "era", "base", "earlier")


def _header_checksum(facts: Mapping[str, Any], asks: SamplerRequests) -> str:
    checked = {key: facts[key] for key in (*_COUNTS, "definition")}
    return hashlib.sha256(f"{_json(checked)} {asks.checksum}".encode()).hexdigest()


def _of_first_version(facts: Mapping[str, Any]) -> dict[str, Any]:
    """Facts of version 1, in which a study was asked for as a whole."""
    return {"runs": facts["runs"], "asked": facts["runs"], "era": 0, "base": 0, "earlier": 0}


def _first_asks(definition: StudyDefinition, runs: int) -> SamplerRequests:
    names = definition.explored
    each = runs // len(names) if names else 0
    return SamplerRequests(Block(index * each, each, name, 0, 0) for index, name in enumerate(names) if each)


def _version(connection: sqlite3.Connection) -> int:
    (version,) = connection.execute("PRAGMA user_version").fetchone()
    return int(version)


def _check_version(path: Path, connection: sqlite3.Connection) -> None:
    (application,) = connection.execute("PRAGMA application_id").fetchone()
    version = _version(connection)
    if application != APPLICATION_ID:
        raise fail(f"is not a study folder: {NAME} was written by another program", Location(str(path)), _WHICH)
    if version > VERSION:
        raise fail(
            f"the study was written by a newer dse (tables of version {version}, this one reads {VERSION})",
            Location(str(path)),
            "update dse, or explore again into another folder",
        )


def _address(file: Path) -> str:
    # Without the right to write, SQLite cannot make the index that WAL readers share; such a file does not change.
    mode = "mode=rw" if os.access(file, os.W_OK) and os.access(file.parent, os.W_OK) else "mode=ro&immutable=1"
    return f"{file.resolve().as_uri()}?{mode}"


def _json(value: object) -> str:
    return json.dumps(value, sort_keys=True, ensure_ascii=False, separators=(",", ":"))
