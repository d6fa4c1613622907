"""The cache looked after: what it holds, whether that is whole, and what nobody has used for long."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable
from pathlib import Path

from dse.cache.entries import digest_file, remove
from dse.cache.folder import is_aside, unwritable
from dse.cache.sections import SHELVES, Entry, Shelf, entries_of, names
from dse.scratch import is_left_over


def survey(root: Path) -> dict[Shelf, list[Entry]]:
    """The entries of every shelf of the cache *root* that has any."""
    found = {shelf: list(entries_of(shelf, root)) for shelf in SHELVES}
    return {shelf: entries for shelf, entries in found.items() if entries}


def damaged(root: Path, tell: Callable[[Shelf], None]) -> list[Entry]:
    """Every entry that is not what was kept, or has nothing to tell that by. *tell* is told what is looked at."""
    found = []
    for shelf, entries in survey(root).items():
        tell(shelf)
        found += [entry for entry in entries if not shelf.is_whole(entry.path)]
    return found


def unused(root: Path, days: float = math.inf, size: float = math.inf) -> list[Entry]:
    """The entries that were not used for *days*; then those used longest ago, until the others have *size* bytes."""
    removable = (entry for shelf, entries in survey(root).items() if not shelf.stay for entry in entries)
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
    for shelf in SHELVES:
        for path in (root / shelf.name / name for name in names(root / shelf.name)):
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
