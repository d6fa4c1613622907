"""The cache looked after: what it holds, whether that is whole, and what nobody has used for long."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from dse.cache.entries import digest_file, remove
from dse.cache.folder import is_aside, unwritable
from dse.cache.sections import SECTIONS, CacheSection, Entry, entries_of, names
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
