"""The cache looked after: what it holds, whether that is whole, and what nobody has used for long."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from dse.cache.digests import stamp
from dse.cache.entries import DIGEST, State, digest_file, remove, state_of
from dse.cache.folder import is_aside, unwritable
from dse.cache.plain_data import is_plain
from dse.scratch import is_left_over


def survey(root: Path) -> dict[CacheSection, list[Entry]]:
    """The entries of every section of the cache *root* that has any."""
    found = {section: list(entries_of(section, root)) for section in SECTIONS}
    return {section: entries for section, entries in found.items() if entries}


def damaged(root: Path, tell: Callable[[CacheSection], None]) -> list[Entry]:
    """Every entry that is not what was kept, or has nothing to tell that by. *tell* is told what is looked at."""
    found = []
    for section, entries in survey(root).items():
        tell(section)
        found += [entry for entry in entries if not section.is_whole(entry.path)]
    return found


def unused(root: Path, days: float = math.inf, size: float = math.inf) -> list[Entry]:
    """The entries that were not used for *days*; then those used longest ago, until the others have *size* bytes."""
    removable = (entry for section, entries in survey(root).items() if not section.stay for entry in entries)
    oldest, room = time.time() - days * 86400, size
    found = []
    for entry in sorted(removable, key=lambda entry: (-entry.used, entry.path)):
        room -= entry.size
        if entry.used < oldest or room < 0:
            found.append(entry)
    return found


def left_overs(root: Path) -> list[Path]:
    """What processes that have ended were making; of other machines and earlier versions, what is a day old."""
    found = []
    for section in SECTIONS:
        for path in (root / section.name / name for name in names(root / section.name)):
            has_ended = is_left_over(path.name)
            if is_aside(path) and (has_ended or (has_ended is None and path.lstat().st_mtime < time.time() - 86400)):
                found.append(path)
    return found


def take_out(paths: Iterable[Path]) -> None:
    """Remove entries and left-overs. Raises DseError if that is not possible."""
    for path in paths:
        try:
            digest_file(path).unlink(missing_ok=True)  # without it, what is left counts as absent
            remove(path)
        except OSError as error:
            raise unwritable(path.parent, error) from error
        if os.path.lexists(path):
            raise unwritable(path.parent, OSError(f"{path.name} cannot be removed"))


# What the cache holds, kind by kind: what is kept in a folder of its own gets a line here.


def _matches_digest(path: Path) -> bool:
    state = state_of(path)
    return state is State.WHOLE or (state is State.ABSENT and time.time() - path.lstat().st_mtime < _IN_THE_MAKING)


def _matches_head(path: Path) -> bool:
    return path.is_file() and is_plain(path.read_bytes())


_IN_THE_MAKING = 3600.0
"""Seconds for which what has no digest may get one."""


@dataclass(frozen=True, slots=True)
class CacheSection:
    """The entries in the folder *name* of the cache: *holds* says what they are, *is_whole* whether one is whole.

    Those that *stay* are small, and others cannot be found without them.
    """

    name: str
    holds: str
    is_whole: Callable[[Path], bool] = _matches_digest
    stay: bool = False


SECTIONS = (
    CacheSection("built", "FMUs made of components"),
    CacheSection("unpacked", "FMUs, unpacked"),
    CacheSection("compiled", "libraries of FMUs that came as sources"),
    CacheSection("bridges", "bridges to libraries for Windows"),
    CacheSection("wine", "folders of Windows, made by wine", Path.is_dir),
    CacheSection("fused", "fused configurations"),
    CacheSection("fused/parts", "components of fused configurations"),
    CacheSection("fused/names", "names in the C of fused components"),
    CacheSection("web", "modules of report pages that simulate"),
    CacheSection("generated", "C written by kinds of components"),
    CacheSection("sumo", "roads as networks of SUMO"),
    CacheSection("coded", "libraries of code from Simulink"),
    CacheSection("modelica", "Modelica models, translated"),
    CacheSection("objects", "Modelica models, compiled"),
    CacheSection("checked", "Modelica models found right"),
    CacheSection("declared", "headers of code from Simulink, read"),
    CacheSection("statics", "C components searched for static variables"),
    CacheSection("facts", "what was found out about FMUs by dse probe"),
    CacheSection("numerics", "how exact FMUs were found to be"),
    CacheSection("ssp", "SSP packages, unpacked"),
    CacheSection("runs", "runs that were simulated", Path.is_dir),  # what is damaged in it is found when it is read
    CacheSection("received", "FMUs that other machines sent"),
    CacheSection("compilers", "compilers that made what is here", stay=True),
    CacheSection("answers", "answers of commands", _matches_head),
    CacheSection("documents", "YAML files of workspaces, read", _matches_head),
    CacheSection("units", "units, looked up", _matches_head),
    CacheSection("trusted", "workspaces that were trusted", _matches_head, stay=True),
)


@dataclass(frozen=True, slots=True)
class Entry:
    """One entry: its place, its bytes, and when it was used last, to the hour, in seconds since 1970."""

    section: CacheSection
    path: Path
    size: int
    used: float


def entries_of(section: CacheSection, root: Path) -> Iterator[Entry]:
    """The entries on *section* of the cache *root*, by name; those of which a digest is left over are among them."""
    folder = root / section.name
    others = {other.name for other in SECTIONS}
    for name in sorted({name.removesuffix(DIGEST) for name in names(folder)}):
        path = folder / name
        if is_aside(path) or f"{section.name}/{name}" in others:
            continue
        files = stamp(path)
        used = [when for _, _, _, when, *_ in stamp(digest_file(path)) or files]
        if used:
            yield Entry(section, path, sum(size for _, _, size, *_ in files), max(used) / 1e9)


def names(folder: Path) -> list[str]:
    """The names in *folder*, none if it cannot be read."""
    try:
        return sorted(path.name for path in folder.iterdir())
    except OSError:
        return []
