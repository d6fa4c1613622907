"""Which studies there are below a folder, by name: the only way from a name in a request to a folder."""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from threading import Lock

from dse.errors import Location, fail
from dse.storage import StudyFolder

DEPTH = 4
"""How deep below the folder studies are looked for."""

MOST_FOLDERS = 20_000
"""So many folders are looked into at most."""

_RATING = "rating.html"

_FRESH = 2.0
"""Seconds for which a list is good enough to show."""


class StudyIndex:
    """The studies in *root*, which may be one itself; links are not followed, so that each lies below *root*.

    They are simulated with *workspace*, or one that is trusted. DseError if *root* is no folder.
    """

    def __init__(self, root: Path, workspace: Path | None = None) -> None:
        if not root.is_dir():
            raise fail(
                "there is no such folder", Location(str(root)), "name a study folder, or a folder that contains some"
            )
        self.root, self.workspace = root.resolve(), workspace
        self._found: Mapping[str, Path] = {}
        self._looked = -_FRESH
        self._lock = Lock()

    @property
    def studies(self) -> Mapping[str, Path]:
        """The study folders by name: the path below the root with slashes, or the root's own name."""
        with self._lock:
            if time.monotonic() - self._looked >= _FRESH:
                self._found = dict(sorted(self._named()))
                self._looked = time.monotonic()
            return self._found

    def folder(self, name: str) -> Path:
        """The folder of the study *name*. DseError if there is none, or none any more."""
        path = self.studies.get(name)
        if path is None or not StudyFolder.is_at(path):
            raise fail("there is no such study here", hint="it may have been moved or removed")
        return path

    @property
    def is_rated(self) -> bool:
        """Whether the studies are those of a rating."""
        return (self.root / _RATING).is_file()

    def rating(self) -> str:
        """The page of the rating. DseError if there is none."""
        if not self.is_rated:
            raise fail("there is no rating here", hint="serve the folder that 'dse rate' has written")
        return (self.root / _RATING).read_text(encoding="utf-8")

    def _named(self) -> Iterator[tuple[str, Path]]:
        for path in _below(self.root):
            yield path.relative_to(self.root).as_posix() if path != self.root else self.root.name or "study", path


def _below(root: Path) -> Iterator[Path]:
    for seen, (place, folders, _) in enumerate(os.walk(root)):
        path = Path(place)
        if StudyFolder.is_at(path):
            yield path
        is_deep = seen >= MOST_FOLDERS or len(path.relative_to(root).parts) >= DEPTH
        # What has no business here is hidden, or the insides of studies and packages.
        folders[:] = () if is_deep else sorted(name for name in folders if name[:1] not in "._" and name not in _OTHERS)


_OTHERS = frozenset({"node_modules", "waveforms", "spool", "figures", "components", "replays"})
