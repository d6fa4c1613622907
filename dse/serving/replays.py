"""Runs in three dimensions, made for whoever asks and kept in memory: nothing is written into study folders."""

from __future__ import annotations

import re
from collections import OrderedDict
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from threading import Lock

from dse.api import results
from dse.errors import fail
from dse.serving.pages import document, study_address
from dse.serving.point_requests import the_only_one

_MOST_PAGES = 12
"""Pages that are kept; one takes less than 2 MB."""


def run_number(text: str) -> int:
    """The number of a run, as an address has it. DseError for all that is none."""
    if not re.fullmatch(r"[0-9]{1,9}", text):
        raise fail("this is not a run number", hint="open the replay from a run of the report")
    return int(text)


@dataclass(slots=True)
class Replays:
    """The pages of runs as they are now, simulated with *workspace*, or one that is trusted.

    All may be called from any thread.
    """

    workspace: Path | None = None
    _pages: OrderedDict[tuple[Path, int], tuple[str, str]] = field(default_factory=OrderedDict)
    _told: dict[tuple[Path, int], str] = field(default_factory=dict)
    _lock: Lock = field(default_factory=Lock)

    def page(self, folder: Path, run: int) -> str | None:
        """The page of *run*, None if it is not made yet. DseError if there is no such run."""
        mark = results(folder).scene_mark(run)
        with self._lock:
            known, text = self._pages.get((folder, run), ("", ""))
        return text if known == mark else None

    def make(self, folder: Path, run: int) -> None:
        """Have the page of *run*: simulated once more in a process of its own. DseError, BusyError."""
        with the_only_one():
            if self.page(folder, run) is not None:
                return
            study = results(folder)
            mark = study.scene_mark(run)
            try:
                text = study.scene_page(run, workspace=self.workspace, tell=lambda told: self._note(folder, run, told))
            finally:
                with self._lock:
                    self._told.pop((folder, run), None)
        with self._lock:
            self._pages[folder, run] = (mark, text)
            self._pages.move_to_end((folder, run))
            while len(self._pages) > _MOST_PAGES:
                self._pages.popitem(last=False)

    def told(self, folder: Path, run: int) -> str:
        """What is being done for the page of *run*; "" if nobody makes it."""
        with self._lock:
            return self._told.get((folder, run), "")

    def _note(self, folder: Path, run: int, told: str) -> None:
        with self._lock:
            self._told[folder, run] = told


def waiting_page(name: str, run: int) -> str:
    """What is seen until the page of *run* of the study *name* is made; its script has it made."""
    body = (
        f'<section class="card" data-study="{escape(name)}" data-replay="{run}">'
        f"<p>Run {run} is simulated again, and everything that the scene shows is recorded.</p>"
        '<progress aria-label="The run is simulated"></progress>'
        '<p class="hint" id="replay-told" role="status">waiting for the simulation to begin</p>'
        '<p class="problem" id="replay-problem" role="alert" hidden></p>'
        "<noscript><p>This needs JavaScript, which is switched off.</p></noscript></section>"
    )
    return document(f"Run {run} in three dimensions", body, f'<a href="{escape(study_address(name))}">Report</a>')
