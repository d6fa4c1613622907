"""Documents that earlier commands read, so that the next one need not parse the same text again.

They are kept as plain data, one file for a workspace. What counts is a file's content: its size, times and number stand
for it only on systems where nobody can set them back, and only if it was left alone for a while before it was read.
"""

from __future__ import annotations

import json
import os
import time
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

from dse.cache import cache_folder, keep, kept
from dse.domain.expression import Piece
from dse.errors import Location
from dse.formats.yaml import Call, Document, parse_yaml, read_content, read_yaml, shown

_SETTLED = 2_000_000_000
"""Nanoseconds: file systems tell the times of two changes apart if they are further apart than that."""

_WORKSPACES = 100

Stamp = list[int]
"""What changes whenever a file is written: size, time of the content, time of the entry, number, device."""


@dataclass(slots=True)
class _Entry:
    stamp: Stamp
    read: int
    """When the content was read, in nanoseconds since 1970."""
    digest: str
    text: str
    """The document as JSON."""


def remember(root: Path) -> None:
    """From now on `read_kept` looks up what it reads in *root*; what is new is kept when this process ends."""
    if root not in _OPEN:
        _exit_hook()
        _OPEN[root] = _Kept(root)


def read_kept(path: Path, inside: Path) -> Document:
    """As `read_yaml` of *path* with its links followed, from what is kept of the workspace *inside* if that may be."""
    found = _OPEN.get(inside)
    document = found.read(path) if found else read_yaml(path.resolve())
    call = WRITTEN.get(document.path)
    return replace(document, call=call) if call else document


class _Kept:
    """The documents of the workspace *root*."""

    def __init__(self, root: Path) -> None:
        self._is_changed = False
        name = sha256(str(root).encode(errors="surrogateescape")).hexdigest()[:32]
        self._shelf = cache_folder() / "documents" / name, f"{_rules()}-{name}"

    def read(self, path: Path) -> Document:
        """The document in the file *path*. Raises DseError as `read_yaml` does."""
        name = str(path)
        entry = self._entries.get(name)
        document = self._known(path, entry) if entry else None
        if document is not None:
            return document
        real = path.resolve()
        if str(real) != name:
            return self.read(real)
        now = time.time_ns()
        stamp = _stamp(path)
        content = read_content(path)
        document = parse_yaml(path, content)
        if stamp:
            self._entries[name] = _Entry(stamp, now, sha256(content).hexdigest(), _written(document))
            self._is_changed = True
        return document

    def save(self) -> None:
        """Keep what is new, and nothing of files that are gone."""
        if not self._is_changed:
            return
        index: dict[str, Any] = {}
        texts: list[str] = []
        at = 0
        for name, entry in self._entries.items():
            if os.path.lexists(name):
                index[name] = [entry.stamp, entry.read, entry.digest, at, len(entry.text)]
                texts.append(entry.text)
                at += len(entry.text)
        content = json.dumps(index, separators=(",", ":")) + "\n" + "".join(texts)
        keep(*self._shelf, content.encode("ascii"), most=_WORKSPACES)

    @cached_property
    def _entries(self) -> dict[str, _Entry]:
        index, _, texts = (kept(*self._shelf) or b"{}").decode("ascii").partition("\n")
        try:
            return {
                name: _Entry(stamp, read, digest, texts[at : at + length])
                for name, (stamp, read, digest, at, length) in json.loads(index).items()
            }
        except (TypeError, ValueError, AttributeError, RecursionError):
            return {}

    def _known(self, path: Path, entry: _Entry) -> Document | None:
        """What *entry* says of the file *path*; None if it says nothing of its content."""
        stamp = _stamp(path)
        if stamp is None:
            return None
        if stamp != entry.stamp or not _is_settled(entry):
            now = time.time_ns()
            if sha256(read_content(path)).hexdigest() != entry.digest:
                return None
            is_new = stamp != entry.stamp
            entry.stamp, entry.read = stamp, now
            self._is_changed |= is_new or _is_settled(entry)
        try:
            return _document(path, entry.text)
        except (TypeError, ValueError, RecursionError):
            return None


WRITTEN: dict[Path, Call] = {}
"""The calls in Python that files were written from in this process, by paths without links."""

_OPEN: dict[Path, _Kept] = {}
_is_posix = os.name == "posix"


@lru_cache(maxsize=1)
def _exit_hook() -> None:
    import atexit

    @atexit.register
    def save() -> None:
        for found in _OPEN.values():
            found.save()


def _is_settled(entry: _Entry) -> bool:
    _, content, itself, *_ = entry.stamp
    return _is_posix and entry.read - max(content, itself) > _SETTLED


def _stamp(path: Path) -> Stamp | None:
    try:
        found = os.lstat(path)
    except OSError:
        return None
    return [found.st_size, found.st_mtime_ns, found.st_ctime_ns, found.st_ino, found.st_dev]


@lru_cache(maxsize=1)
def _rules() -> str:
    """Names the rules by which texts become documents: those of dse and of the parser below."""
    from importlib.util import find_spec

    own = [Path(__file__).with_name(name) for name in ("parse_cache.py", "yaml.py", "compose.py", "scalars.py")]
    parser = find_spec("ruamel.yaml")
    files = [*own, *([Path(parser.origin)] if parser and parser.origin else [])]
    return sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:32]


def _written(document: Document) -> str:
    pieces = [
        [path, [(piece.start, piece.where.line, piece.where.column) for piece in found]]
        for path, found in document.pieces.items()
    ]
    return json.dumps([document.data, document.mark, pieces], separators=(",", ":"))


def _document(path: Path, text: str) -> Document:
    data, mark, pieces = json.loads(text)
    file = shown(path)
    found = {
        tuple(steps): tuple(Piece(start, Location(file, line, column)) for start, line, column in places)
        for steps, places in pieces
    }
    return Document(path, data, file, mark, found)
