"""The folder of built and unpacked FMUs: entries are named by their content, complete or absent, never changed.

Several processes may use it at once: an entry is made aside and renamed into place, and whoever comes second
finds the same bytes.
"""

from __future__ import annotations

import hashlib
import shutil
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from dse.cache import cache_folder, keep_file, rename, unwritable

__all__ = ["cache_folder", "content_key", "keep_file", "keep_folder"]


def content_key(entries: Iterable[tuple[str, bytes]]) -> str:
    """32 hexadecimal digits that name these (name, bytes) pairs, in this order."""
    digest = hashlib.sha256()
    for name, content in entries:
        for part in (name.encode(), content):
            digest.update(len(part).to_bytes(8, "big"))
            digest.update(part)
    return digest.hexdigest()[:32]


def keep_folder(target: Path, fill: Callable[[Path], None]) -> Path:
    """Have *fill* fill a folder that becomes *target*, unless *target* is there already; returns *target*."""
    if target.is_dir():
        return target
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=".", suffix=".tmp", dir=target.parent))
    except OSError as error:
        raise unwritable(target.parent, error) from error
    try:
        fill(aside)
        rename(aside, target)
    except OSError as error:
        raise unwritable(target.parent, error) from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return target
