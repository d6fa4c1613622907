"""A folder of drives: what was recorded, and a study of it for each bench."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from dse.api.drives.drive_study import drive_again, keep_drives, thinned
from dse.api.drives.score_board import Board, board_of
from dse.api.lookup import workspace_of
from dse.api.studies.replay import RECORDINGS, drive_name, is_drives, recordings
from dse.api.studies.run import Run
from dse.domain.drive import Drive, bits_of
from dse.errors import DseError, Location, Problem, fail, raise_if_any
from dse.formats import shown
from dse.storage import StudyFolder, changed_results, drive_id, write_drive

if TYPE_CHECKING:
    from dse.api.studies.single_run import Tell
    from dse.loading import Workspace as Files


SHARED = ".shared"
"""The end of the name of a study of drives in a shared world; no bench has a dot in its name."""


def study_name(drive: Drive) -> str:
    """The study that a drive is in: drives in a shared world are compared with each other only."""
    return f"{drive.bench}{SHARED}" if drive.is_shared else drive.bench


@dataclass(frozen=True, slots=True)
class CheckedDrive:
    """A drive simulated again: what is not the same bit for bit as in the study, and as when it was driven.

    Nothing is known of what nobody noted then: *was_noted* tells.
    """

    id: str
    bench: str
    driver: str
    from_study: tuple[str, ...]
    from_driving: tuple[str, ...]
    was_noted: bool

    @property
    def is_same(self) -> bool:
        """Whether nothing differs."""
        return not (self.from_study or self.from_driving)


class Drives:
    """The drives in *folder*; what they were driven on is found in *workspace*, else in the one around here.

    Recordings are never changed or removed. Files that are no drives are told in *problems*, by name, and left alone.
    """

    def __init__(self, folder: str | Path, workspace: Files | None = None) -> None:
        self.path = Path(folder)
        self._workspace = workspace
        self.problems: list[Problem] = []
        self._lock = threading.Lock()

    def recorded(self) -> dict[str, Drive]:
        """The drives by id, sorted; whatever their files are called."""
        self.problems = []
        return dict(sorted(dict(recordings(self.path / RECORDINGS, self.problems)).items()))

    def add(self, drive: Drive, *, tell: Tell | None = None) -> str:
        """Keep *drive*, and have it as a run in the study of its bench; returns its id.

        Whatever comes after, it is kept. Raises DseError if it is no drive, does not fit its bench, or if another
        process writes into the study.
        """
        name = self.record(drive)
        # All of them: if the bench has changed since, they are simulated again together.
        study = study_name(drive)
        recorded = {each: other for each, other in self.recorded().items() if study_name(other) == study}
        before = len(self.problems)
        self._keep(study, recorded, tell)
        if not any(score.drive == name for score in board_of(self.study(study)).scores):
            raise_if_any(self.problems[before:])
        return name

    def record(self, drive: Drive) -> str:
        """Keep *drive*, and nothing more, which takes no time; returns its id. Raises DseError if it is no drive."""
        write_drive(self.path / RECORDINGS, drive)
        return drive_id(drive)

    def update(self, *, tell: Tell | None = None) -> None:
        """Have every recording as a run in the study of its bench; `problems` tells of those that cannot be."""
        drives = self.recorded()
        for study in sorted({*map(study_name, drives.values())}):
            try:
                self._keep(study, {name: drive for name, drive in drives.items() if study_name(drive) == study}, tell)
            except DseError as error:
                self.problems += error.problems

    def study(self, name: str) -> Path:
        """The study folder of the drives on a bench: *name* is as `study_name` gives it."""
        return self.path / name

    def boards(self) -> tuple[Board, ...]:
        """The score boards of all benches, by name, as far as the drives are in their studies."""
        return tuple(board_of(folder) for folder in self._studies())

    def run(self, drive: str) -> Run:
        """The run of the drive whose id starts so. Raises DseError if there is none."""
        for folder in self._studies():
            with StudyFolder.open(folder) as store:
                definition = store.header.definition
                for run in store.table().runs():
                    if drive and drive_name(definition, run.request.point).startswith(drive):
                        return Run(store.run(run.request.number), definition)
        raise fail(f"there is no drive '{drive[:40]}'", Location(shown(self.path)))

    def check(self, *, tell: Tell | None = None) -> Iterator[CheckedDrive]:
        """Simulate each recorded drive again and compare. Drives that cannot be are told in `problems`."""
        for name, drive in self.recorded().items():
            if tell:
                tell(f"{drive.bench}: drive {name} of {drive.driver}")
            try:
                bench = self._files.bench(drive.bench)
                made = drive_again(drive, bench)
                stored = self.run(name)
            except DseError as error:
                self.problems += error.problems
                continue
            # A study keeps waveforms as often as its bench says.
            again, now = thinned(made, bench), bits_of(made)
            shared = drive.bits.keys() & now.keys()
            yield CheckedDrive(
                name,
                drive.bench,
                drive.driver,
                tuple(changed_results(stored.noun, again)),
                tuple(sorted(each for each in shared if drive.bits[each] != now[each])),
                bool(shared),
            )

    @property
    def _files(self) -> Files:
        return self._workspace or workspace_of("")

    def _keep(self, study: str, drives: Mapping[str, Drive], tell: Tell | None) -> None:
        # The name comes from a file of anybody: only one that the workspace has becomes that of a folder.
        bench = next(iter(drives.values())).bench
        known = self._files.bench(bench)
        if known.name != bench or bench == RECORDINGS:
            raise fail(f"'{bench}' is not the name of a bench", Location(shown(self.path)))
        with self._lock:
            keep_drives(known, drives, self.study(study), tell=tell, on_problem=self.problems.append)

    def _studies(self) -> Iterator[Path]:
        for folder in sorted(self.path.iterdir()) if self.path.is_dir() else ():
            if StudyFolder.is_at(folder):
                with StudyFolder.open(folder) as store:
                    is_ours = is_drives(store.header.definition)
                if is_ours:
                    yield folder
