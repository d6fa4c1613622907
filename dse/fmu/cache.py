"""The folder of built and unpacked FMUs: entries are named by their content, complete or absent, never changed.

Several processes may use it at once: an entry is made aside and renamed into place, and whoever comes second
finds the same bytes.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from dse.errors import DseError, fail


def cache_folder(cache: Path | None = None) -> Path:
    """*cache* if given, else ``$DSE_CACHE``, else the user's cache folder; it need not exist yet."""
    if cache is not None:
        return cache
    named = os.environ.get("DSE_CACHE", "").strip()
    if named:
        return Path(named)
    import platformdirs

    return Path(platformdirs.user_cache_dir("dse", appauthor=False))


def content_key(entries: Iterable[tuple[str, bytes]]) -> str:
    """32 hexadecimal digits that name these (name, bytes) pairs, in this order."""
    digest = hashlib.sha256()
    for name, content in entries:
        for part in (name.encode(), content):
            digest.update(len(part).to_bytes(8, "big"))
            digest.update(part)
    return digest.hexdigest()[:32]


def keep_file(target: Path, content: bytes) -> Path:
    """Write *content* to *target* at once; returns *target*. Raises DseError if the folder cannot be written."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, aside = tempfile.mkstemp(prefix=".", suffix=".tmp", dir=target.parent)
    except OSError as error:
        raise _unwritable(target.parent, error) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        _rename(Path(aside), target)
    except OSError as error:
        raise _unwritable(target.parent, error) from error
    finally:
        Path(aside).unlink(missing_ok=True)
    return target


def keep_folder(target: Path, fill: Callable[[Path], None]) -> Path:
    """Have *fill* fill a folder that becomes *target*, unless *target* is there already; returns *target*."""
    if target.is_dir():
        return target
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        aside = Path(tempfile.mkdtemp(prefix=".", suffix=".tmp", dir=target.parent))
    except OSError as error:
        raise _unwritable(target.parent, error) from error
    try:
        fill(aside)
        _rename(aside, target)
    except OSError as error:
        raise _unwritable(target.parent, error) from error
    finally:
        shutil.rmtree(aside, ignore_errors=True)
    return target


def _rename(aside: Path, target: Path) -> None:
    # Another process may have been first, and Windows does not replace what is in use: the same bytes are there.
    try:
        aside.replace(target)
    except OSError:
        if not target.exists():
            raise


def _unwritable(folder: Path, error: OSError) -> DseError:
    reason = error.strerror or str(error)
    return fail(f"the cache folder {folder} cannot be written: {reason}", hint="set DSE_CACHE to a folder of yours")
