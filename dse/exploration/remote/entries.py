"""Entries of the FMU cache on their way: once to each host, told apart by their contents.

What arrives becomes an entry of its own, ``received/DIGEST``, after its contents were found to have that digest:
nothing that a host made itself is replaced, and no name that came over the network is used as a path.
"""

from __future__ import annotations

import re
import zlib
from functools import lru_cache
from pathlib import Path, PurePosixPath

from dse.cache import cache_folder, content_key, keep_folder
from dse.errors import Location, fail
from dse.formats import pack_zip, unpack_zip
from dse.scratch import ScratchFolder

_known: dict[str, Path] = {}
"""Where an entry with a digest lies, of those whose contents have been looked at in this process."""


def digest_of_entry(path: Path) -> str:
    """What names the contents of an entry; a single file is a folder that holds it."""
    return content_key(sorted(_contents(path).items()))


@lru_cache(maxsize=16)
def sent(path: Path) -> bytes:
    """The entry at *path*, ready to be sent."""
    return zlib.compress(pack_zip(_contents(path)), 1)


def found(place: str, digest: str) -> Path | None:
    """Where the entry *place* with this *digest* lies on this host; None if it does not."""
    if digest not in _known:
        own, received = cache_folder().absolute() / PurePosixPath(place), _received(digest)
        for path, base in ((own, own), (received, received / own.name)):
            if path.exists() and digest_of_entry(path) == digest:
                # Of what is a file where it was made, the name is below the folder it was received in.
                _known[digest] = base if base.exists() else path
                break
    return _known.get(digest)


def receive_entry(digest: str, content: bytes) -> None:
    """Keep what `sent` gave. DseError if it is not what has this *digest*, or the cache cannot be written."""
    target = _received(digest)

    def fill(aside: Path) -> None:
        with ScratchFolder() as scratch:
            archive = Path(scratch) / "entry.zip"
            archive.write_bytes(zlib.decompress(content))
            unpack_zip(archive, aside, Location(f"entry {digest}"), "entry")
        if digest_of_entry(aside) != digest:
            raise fail(f"what was received as the cache's entry {digest} is something else")

    keep_folder(target, fill)


def _received(digest: str) -> Path:
    if not re.fullmatch("[0-9a-f]{32}", digest):
        raise fail(f"'{digest}' is not a digest")
    return cache_folder().absolute() / "received" / digest


def _contents(path: Path) -> dict[str, bytes]:
    if path.is_file():
        return {path.name: path.read_bytes()}
    entries = {entry.relative_to(path).as_posix(): entry for entry in path.rglob("*")}
    folders = {f"{name}/": b"" for name, entry in entries.items() if entry.is_dir()}
    return folders | {name: entry.read_bytes() for name, entry in entries.items() if not entry.is_dir()}
