"""The cache folder: what may be kept between two commands, and may always be thrown away.

`keep` and `kept` are for plain data that is quicker read than worked out again. What is damaged, cut off, of another
version or cannot be read counts as absent, what cannot be written is not kept: neither is ever an error.
"""

from __future__ import annotations

import os
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


def keep_file(target: Path, content: bytes) -> Path:
    """Write *content* to *target* at once; returns *target*. Raises DseError if the folder cannot be written."""
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, aside = tempfile.mkstemp(prefix=".", suffix=".tmp", dir=target.parent)
    except OSError as error:
        raise unwritable(target.parent, error) from error
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(content)
        rename(Path(aside), target)
    except OSError as error:
        raise unwritable(target.parent, error) from error
    finally:
        Path(aside).unlink(missing_ok=True)
    return target


def keep_folder(target: Path, fill: Callable[[Path], None]) -> Path:
    """Have *fill* fill a folder that becomes *target*, unless *target* is there already; returns *target*.

    It is made aside and renamed into place: complete or absent, also for another process that makes the same.
    """
    import shutil

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


def content_key(entries: Iterable[tuple[str, bytes]]) -> str:
    """32 hexadecimal digits that name these (name, bytes) pairs, in this order."""
    import hashlib

    digest = hashlib.sha256()
    for name, content in entries:
        for part in (name.encode(), content):
            digest.update(len(part).to_bytes(8, "big"))
            digest.update(part)
    return digest.hexdigest()[:32]


def kept(target: Path, key: str) -> bytes | None:
    """What `keep` wrote to *target* under the same *key*, byte for byte; None if that is not what is there."""
    try:
        if not target.is_file():  # a pipe may never end
            return None
        head, _, content = target.read_bytes().partition(b"\n")
    except OSError:
        return None
    return content if head == _head(key, content) else None


def keep(target: Path, key: str, content: bytes, most: int = 1) -> None:
    """Keep *content* for later, where it can be; of the files beside *target*, the *most* newest stay."""
    try:
        keep_file(target, _head(key, content) + b"\n" + content)
        beside = [(entry.stat().st_mtime, entry.path) for entry in os.scandir(target.parent) if entry.is_file()]
        for _, path in sorted(beside)[:-most]:
            Path(path).unlink(missing_ok=True)
    except (DseError, OSError):
        return


def _head(key: str, content: bytes) -> bytes:
    from hashlib import blake2b

    return f"{key} {blake2b(content, digest_size=16).hexdigest()}".encode()


def rename(aside: Path, target: Path) -> None:
    """Let *aside* become *target*, unless another process was first; Windows does not replace what is in use."""
    try:
        aside.replace(target)
    except OSError:
        if not target.exists():
            raise


def unwritable(folder: Path, error: OSError) -> DseError:
    """The DseError that *folder* cannot be written."""
    reason = error.strerror or str(error)
    return fail(f"the cache folder {folder} cannot be written: {reason}", hint="set DSE_CACHE to a folder of yours")
