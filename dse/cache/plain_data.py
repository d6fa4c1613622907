"""Plain data that is quicker read than worked out again, one file with its digest in its first line.

What is damaged, of another version or cannot be read counts as absent, what cannot be written is not kept: neither is
ever an error.
"""

from __future__ import annotations

import os
from pathlib import Path

from dse.cache.entries import replace_file, tell_damage, touch
from dse.errors import DseError


def kept(target: Path, key: str) -> bytes | None:
    """What `keep` wrote to *target* under the same *key*, byte for byte; None if that is not what is there."""
    try:
        if not target.is_file():  # a pipe may never end
            return None
        whole = target.read_bytes()
    except OSError:
        return None
    head, _, content = whole.partition(b"\n")
    if head == _head(key, content):
        touch(target)
        return content
    if not is_plain(whole):
        tell_damage(target)
    return None


def is_plain(whole: bytes) -> bool:
    """Whether a file with these bytes is as `keep` wrote it, under whatever key."""
    head, _, content = whole.partition(b"\n")
    return head == _head(head.partition(b" ")[0].decode(errors="replace"), content)


def keep(target: Path, key: str, content: bytes, most: int = 1) -> None:
    """Keep *content* for later, where it can be; of the files beside *target*, the *most* newest stay."""
    try:
        replace_file(target, _head(key, content) + b"\n" + content)
        beside = [(entry.stat().st_mtime, entry.path) for entry in os.scandir(target.parent) if entry.is_file()]
        for _, path in sorted(beside)[:-most]:
            Path(path).unlink(missing_ok=True)
    except (DseError, OSError):
        return


def _head(key: str, content: bytes) -> bytes:
    from hashlib import blake2b

    return f"{key} {blake2b(content, digest_size=16).hexdigest()}".encode()
