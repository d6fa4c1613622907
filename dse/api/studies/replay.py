"""Simulating a run of a study again."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.api.lookup import workspace_of
from dse.api.studies.provenance import benches_near
from dse.api.studies.run import Run
from dse.errors import DseError, Location, Problem, fail
from dse.formats import shown

if TYPE_CHECKING:
    from dse.api.studies.single_run import OnChanged, Tell
    from dse.domain.bench import TestBench
    from dse.domain.definition import StudyDefinition
    from dse.domain.drive import Drive


@dataclass(frozen=True, slots=True)
class Replay:
    """*run* was simulated from what the workspace has now, with the number and point it is *stored* with.

    *different* are the results that are not the same bit for bit, *changed* the inputs that changed since.
    """

    run: Run
    stored: Run
    different: tuple[str, ...]
    changed: tuple[str, ...]

    @property
    def is_same(self) -> bool:
        """Whether the same came of the same."""
        return not (self.different or self.changed)

    def problem(self, where: str) -> DseError | None:
        """What is wrong, of a study that is called *where*; None if nothing is."""
        number, causes = self.run.number, ", ".join(self.changed)
        if self.different:
            why = f"changed since: {causes}" if causes else "dse or this machine have changed since"
            what = f"run {number} did not give the same again: {', '.join(self.different)}"
            return fail(what, Location(where), f"{why}; explore again")
        if self.changed:
            what = f"run {number} gave the same, but not from the same: {causes} changed since"
            hint = "explore again, or replay with the --fmi the study was explored with"
            return fail(what, Location(where), hint)
        return None


def replay(
    stored: Run,
    *,
    source: str | Path | None = None,
    fmi: int = 2,
    tell: Tell | None = None,
    on_changed: OnChanged | None = None,
) -> Replay:
    """Simulate *stored* again and compare; its study is found in the workspace here, or in the file *source*.

    *on_changed* is called before it is simulated if something has changed since the study was made, with what.
    """
    from dse.api.studies.single_run import again
    from dse.domain.run import TESTBENCH
    from dse.domain.study import Selection
    from dse.storage import changed_results
    from dse.testbench import bench_study, with_values

    point = {name: value for name, value in stored.point.items() if name != TESTBENCH}
    first, *others = (with_values(bench, point) for bench in benches_of(stored.definition, source))
    study = replace(bench_study(first, Selection((stored.configuration,))), others=tuple(others))
    made, planned, changed = again(study, stored.definition, stored.noun, fmi, tell=tell, on_changed=on_changed)
    # Alone it has number 0 and its point is the bench's own.
    made = replace(made, request=stored.noun.request)
    return Replay(
        Run(made, replace(planned.definition, variables=stored.definition.variables)),
        stored,
        tuple(changed_results(stored.noun, made)),
        changed,
    )


def benches_of(definition: StudyDefinition, source: str | Path | None) -> tuple[TestBench, ...]:
    """The benches of the study, found by its name in the workspace around the current folder, or in *source*.

    Raises DseError, also if that workspace lies in a study folder and is not trusted.
    """
    if is_drives(definition):
        what = f"'{definition.title}' is a study of drives: who drove is in its recordings"
        raise fail(what, Location(definition.study), "make them again and compare: dse drives DIR --check")
    if not source:
        return benches_near(definition, Path())
    name = str(source)
    workspace = workspace_of(name)
    return workspace.study(name).benches if definition.variables else (workspace.bench(name),)


# What the study of the drives on a bench says of them, and the benches as they were driven.


DRIVES = "drives"
"""What the sampler of a study of drives is called in its definition; it cannot be asked for."""

DRIVE, DRIVER = "drive", "driver"
"""The conditions of such a study."""

NOBODY = "nobody"
"""The drive that is none: the bench as it is, with the design at the wheel."""

RECORDINGS = "recordings"
"""Where the drives themselves lie in their folder; the studies lie beside, named by their benches."""

_MOST = 10_000


@dataclass(frozen=True, slots=True)
class Kept:
    """What a study knows of a drive without its recording: who drove for how long (s), and how real time was kept."""

    driver: str
    configuration: str
    seconds: float
    steps: int
    overruns: int


def is_drives(definition: StudyDefinition) -> bool:
    """Whether a study is one of drives."""
    return definition.sampler.kind == DRIVES


def kept_drives(definition: StudyDefinition) -> dict[str, Kept]:
    """The drives that a study knows, by id, in the order of their numbers; `NOBODY` is not among them."""
    options: Mapping[str, Any] = definition.sampler.options.get("drives", {})
    # What is stored as JSON is sorted: the order is that of the labels.
    names = next((each.labels[1:] for each in definition.variables if each.name == DRIVE), ())
    return {name: _kept(options[name]) for name in names if name in options}


def drive_name(definition: StudyDefinition, point: Mapping[str, object]) -> str:
    """The id of the drive that a run of such a study is; `NOBODY` for the run that nobody drove."""
    number = int(float(str(point[DRIVE])))
    return NOBODY if number == 0 else list(kept_drives(definition))[number - 1]


def _kept(told: Mapping[str, Any]) -> Kept:
    numbers = float(told["seconds"]), int(told["steps"]), int(told["overruns"])
    return Kept(str(told["driver"]), str(told["configuration"]), *numbers)


def recordings(folder: Path, problems: list[Problem], first: str = "") -> Iterator[tuple[str, Drive]]:
    """The drives in *folder* with their ids, by their files' names, but a file called *first* before all others.

    Files that are no drives are told in *problems*, by name. Raises DseError if there are too many.
    """
    from dse.storage import drive_id, read_drive

    files = sorted(folder.iterdir(), key=lambda file: (file.stem != first, file)) if folder.is_dir() else []
    if len(files) > _MOST:
        raise fail(f"there are {len(files):,} files, more than {_MOST:,}", Location(shown(folder)))
    for file in files:
        if file.name.startswith(".") or file.suffix != ".parquet" or file.is_symlink() or not file.is_file():
            if not file.name.startswith("."):
                problems.append(Problem("is not a recording of a drive", Location(shown(file))))
            continue
        try:
            drive = read_drive(file)
        except DseError as error:
            problems += error.problems
            continue
        yield drive_id(drive), drive


def recording(study: Path, name: str) -> Drive:
    """The drive of this id, from the recordings beside the folder of a *study*. Raises DseError if it is not there."""
    folder = study.absolute().parent / RECORDINGS
    found = next((drive for own, drive in recordings(folder, [], name) if own == name), None)
    if found is None:
        raise fail(f"there is no recording of the drive {name}", Location(shown(folder)))
    return found


def bench_driven(drive: Drive, bench: TestBench, folder: Path) -> TestBench:
    """*bench* as it was driven; its tables lie in *folder*. Raises DseError for a drive of another bench."""
    from dse.live import bench_of_drive
    from dse.testbench import one_configuration

    return bench_of_drive(drive, bench, one_configuration(bench.design, drive.configuration), folder)
