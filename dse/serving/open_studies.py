"""What is known of a study that is looked at: its page and its progress, each made once for all who ask."""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from math import isfinite
from pathlib import Path
from threading import Lock
from typing import Generic, TypeVar
from urllib.parse import urlencode

from dse.api import status, study_summary
from dse.errors import fail
from dse.report import read_report, served_page

T = TypeVar("T")

_MOST_PAGES = 3
"""Pages that are kept; one of 100,000 runs takes some 10 MB."""

_MANY, _FEW = 4000, 300
"""Runs up to which a page has the waveforms of all; of more it has a few: reading them all takes longer than all else,
and any point can be simulated."""

_FRESH = 1.5
"""Seconds for which progress is good enough to show."""


@dataclass(slots=True)
class _Kept(Generic[T]):
    """Values by key, each made by one thread while others that want it wait; only the newest *most* are kept."""

    most: int
    values: OrderedDict[str, tuple[object, T]] = field(default_factory=OrderedDict)
    locks: dict[str, Lock] = field(default_factory=dict)
    lock: Lock = field(default_factory=Lock)

    def get(self, key: str, is_good: Callable[[object], bool], make: Callable[[], tuple[object, T]]) -> T:
        """What was kept under *key*, if its mark *is_good*; else what *make* gives, with its mark."""
        with self.lock:
            one = self.locks.setdefault(key, Lock())
        with one:
            with self.lock:
                mark, value = self.values.get(key, (None, None))
            if value is None or not is_good(mark):
                mark, value = make()
                with self.lock:
                    self.values[key] = (mark, value)
                    self.values.move_to_end(key)
                    while len(self.values) > self.most:
                        self.values.popitem(last=False)
        return value


class OpenStudies:
    """Reads study folders for whoever looks at them; nothing is written there. All may be called from any thread."""

    def __init__(self) -> None:
        self._pages: _Kept[bytes] = _Kept(_MOST_PAGES)
        self._progress: _Kept[Mapping[str, object]] = _Kept(100)

    def page(self, name: str, folder: Path) -> bytes:
        """The report of the study *name* as its folder is now. Raises DseError."""

        def make() -> tuple[object, bytes]:
            mark = _mark(folder)
            content = read_report(folder, _MANY if study_summary(folder).finished <= _MANY else _FEW)
            query = urlencode({"study": name})
            live = {"study": name, "runs": len(content.runs), "query": query, "problems": [*map(str, content.missing)]}
            return mark, served_page(content, live).encode()

        return self._pages.get(str(folder), lambda mark: mark == _mark(folder), make)

    def progress(self, folder: Path) -> Mapping[str, object]:
        """How the study in *folder* is getting on, as plain data. Raises DseError."""

        def make() -> tuple[object, Mapping[str, object]]:
            told = _progress(folder)
            return time.monotonic(), told

        def is_fresh(mark: object) -> bool:
            return isinstance(mark, float) and time.monotonic() - mark < _FRESH

        return self._progress.get(str(folder), is_fresh, make)


def _progress(folder: Path) -> Mapping[str, object]:
    now = study_summary(folder)
    told: dict[str, object] = {"state": now.state, "runs": now.runs, "finished": now.finished}
    if now.state == "running":
        running = status(folder)  # takes a second, in which it counts
        told |= {"state": running.state, "runs": running.runs, "finished": running.tally.finished}
        told |= {"rate": running.rate, "writer": str(running.writer or "")}
        if isfinite(running.left) and not running.is_shard:
            told["left"] = running.left
    return told


def _mark(folder: Path) -> tuple[tuple[int, int], ...]:
    """Changes with whatever is committed to the folder's database. Raises DseError if it is gone."""
    found = []
    for name in ("study.sqlite", "study.sqlite-wal"):
        try:
            told = (folder / name).stat()
        except FileNotFoundError:
            continue
        found.append((told.st_mtime_ns, told.st_size))
    if not found:
        raise fail("there is no such study here any more", hint="it was moved or removed")
    return tuple(found)
