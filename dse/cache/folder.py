"""Where the cache folder is, and how something gets into it: made aside, handed to the disk, renamed into place."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from dse.errors import DseError, Location, fail, remedy
from dse.places import cache_path
from dse.scratch import name_of_mine


def cache_folder(cache: Path | None = None) -> Path:
    """*cache* if given, else ``$DSE_CACHE``, else the user's cache folder; it need not exist yet."""
    return Path(cache_path()) if cache is None else cache


def content_key(entries: Iterable[tuple[str, bytes]]) -> str:
    """32 hexadecimal digits that name these (name, bytes) pairs, in this order."""
    import hashlib

    digest = hashlib.sha256()
    for name, content in entries:
        for part in (name.encode(), content):
            digest.update(len(part).to_bytes(8, "big"))
            digest.update(part)
    return digest.hexdigest()[:32]


@contextmanager
def aside(folder: Path) -> Iterator[Path]:
    """A folder in *folder* to make something in, gone afterwards. Raises DseError if *folder* cannot be written."""
    made = None
    try:
        folder.mkdir(parents=True, exist_ok=True)
        made = Path(tempfile.mkdtemp(prefix=f".{name_of_mine()}", suffix=_ASIDE, dir=folder))
        yield made
    except OSError as error:
        raise unwritable(folder, error) from error
    finally:
        if made:
            shutil.rmtree(made, ignore_errors=True)


_ASIDE = ".tmp"
_ROOM = {errno.ENOSPC, errno.EDQUOT}


def is_aside(path: Path) -> bool:
    """Whether *path* is what `aside` made, or an earlier version."""
    return path.name.startswith(".") and path.suffix == _ASIDE


def write_file(target: Path, content: bytes) -> None:
    """Write *content* to *target*, which is new, so that it outlives a power cut once its folder is synced."""
    with target.open("wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def sync(path: Path) -> None:
    """Have the file or the entries of the folder *path* written to the disk, where the system can do that."""
    if os.name == "nt":  # opens no folder, and syncs only what is open for writing
        return
    opened = os.open(path, os.O_RDONLY)
    try:
        os.fsync(opened)
    except OSError as error:
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):  # some file systems have no such thing for folders
            raise
    finally:
        os.close(opened)


def unreadable(entry: Path, error: OSError) -> DseError:
    """The DseError that the *entry* of the cache is there and cannot be read."""
    hint = remedy(error.errno, "if that stays so, delete it: it is made again")
    return fail(f"the cache entry cannot be read: {error.strerror or error}", Location(str(entry)), hint)


def unwritable(folder: Path, error: OSError) -> DseError:
    """The DseError that *folder* cannot be written."""
    reason = (error.strerror or str(error)).lower()
    elsewhere = "set DSE_CACHE to a folder of yours"
    room = f"make room, for example with dse cache prune, or {elsewhere}"
    hint = room if error.errno in _ROOM else remedy(error.errno, elsewhere)
    return fail(f"the cache folder {folder} cannot be written: {reason}", hint=hint)
