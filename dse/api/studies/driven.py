"""What the study of the drives on a bench says of them, and the benches as they were driven."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dse.errors import DseError, Location, Problem, fail
from dse.formats import shown

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.definition import StudyDefinition
    from dse.domain.drive import Drive

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
