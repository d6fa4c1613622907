"""Whether a file of waveforms is still what was written."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

from dse.errors import DseError, is_gone
from dse.storage.disk import UnreadableError, unreadable
from dse.storage.waveforms import AGAIN, read_all_waveforms


@dataclass(frozen=True, slots=True)
class FileFacts:
    """What is known of a file: its size, when it was *modified* (ns) and its SHA-256."""

    size: int
    modified: int
    digest: str


def facts_of(file: Path) -> FileFacts:
    """The facts of *file*; OSError if it cannot be read."""
    digest, stat = digest_of(file), file.stat()
    return FileFacts(stat.st_size, stat.st_mtime_ns, digest)


def digest_of(file: Path) -> str:
    """The SHA-256 of *file*; OSError if it cannot be read."""
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def checked(file: Path, known: FileFacts | None) -> FileFacts | None:
    """The present facts of *file* if it is whole, None if it is gone, cut or changed; UnreadableError if it may be.

    It is read only if its time is not the *known* one; of a file of which nothing is known, whether it can be.
    """
    try:
        return _compared(file, known)
    except OSError as error:
        _raise_unless_gone(file, error)
    except UnreadableError:
        raise
    except DseError:
        pass
    return None


def _compared(file: Path, known: FileFacts | None) -> FileFacts | None:
    stat = file.stat()
    if known and (stat.st_size, stat.st_mtime_ns) == (known.size, known.modified):
        return known
    if known is None:
        for _ in read_all_waveforms(file):
            pass
    elif stat.st_size != known.size:
        return None
    facts = facts_of(file)
    return facts if known is None or facts.digest == known.digest else None


def size_of(file: Path) -> int | None:
    """The size of *file*, None if it is not there; UnreadableError if the system does not give it."""
    try:
        return file.stat().st_size
    except OSError as error:
        _raise_unless_gone(file, error)
    return None


def _raise_unless_gone(file: Path, error: OSError) -> None:
    if not is_gone(error):
        raise unreadable("waveforms", file, error, AGAIN) from error
