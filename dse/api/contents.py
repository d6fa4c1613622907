"""What a workspace has: its design spaces, benches and studies by their titles, and the study folders below ``out/``.

Files are listed as they are, also such as ``dse check`` finds fault with.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from dse.errors import DseError
from dse.places import NO_BENCHES, OUT, PROCEDURE, RATING, STUDY

if TYPE_CHECKING:
    from collections.abc import Callable

    from dse.formats import Entry
    from dse.loading import Workspace


@dataclass(frozen=True, slots=True)
class ListedFile:
    """A design space, bench or study by the name of its *file*; *title* and *facts* are what stands in it.

    *problem* says why it cannot be read, "" if it can.
    """

    name: str
    file: str
    title: str = ""
    facts: Mapping[str, str] = field(default_factory=dict)
    problem: str = ""


@dataclass(frozen=True, slots=True)
class ListedResults:
    """A study folder: *finished* of *runs* are there, *verdicts* counts them by what came of each run as a whole.

    *state* is ``running``, ``finished`` or ``interrupted``, of a shard ``at rest``; "" where *problem* says why it
    cannot be read.
    """

    folder: Path
    study: str = ""
    state: str = ""
    runs: int = 0
    finished: int = 0
    verdicts: Mapping[str, int] = field(default_factory=dict)
    problem: str = ""


@dataclass(frozen=True, slots=True)
class Listing:
    """What a workspace has, each kind sorted by name."""

    designs: tuple[ListedFile, ...]
    benches: tuple[ListedFile, ...]
    studies: tuple[ListedFile, ...]
    results: tuple[ListedResults, ...]
    ratings: tuple[ListedFile, ...] = ()
    procedures: tuple[ListedFile, ...] = ()

    @property
    def files(self) -> Mapping[str, tuple[ListedFile, ...]]:
        """All but the results, by kind."""
        return {kind: getattr(self, kind) for kind in ("designs", "benches", "studies", "ratings", "procedures")}


def listing(workspace: Workspace) -> Listing:
    """What is in *workspace*. A file or folder that cannot be read is listed with its problem."""
    designs, tested = (sorted(workspace.files(folder), key=_name) for folder in ("designs", "testbenches"))
    studies = [path for path in tested if path.name.endswith(STUDY)]
    ratings, procedures = ([path for path in tested if path.name.endswith(end)] for end in (RATING, PROCEDURE))
    benches = [path for path in tested if not path.name.endswith(NO_BENCHES)]
    return Listing(
        tuple(_file(path, ".yaml", workspace.root, lambda _: {}) for path in designs),
        tuple(_file(path, ".yaml", workspace.root, _of_bench) for path in benches),
        tuple(_file(path, STUDY, workspace.root, _of_study) for path in studies),
        tuple(_results(path) for path in study_folders(workspace.root)),
        tuple(_file(path, RATING, workspace.root, _of_rating) for path in ratings),
        tuple(_file(path, PROCEDURE, workspace.root, lambda _: {}) for path in procedures),
    )


def study_folders(root: Path) -> Iterator[Path]:
    """The study folders below ``out/`` of the workspace at *root*, sorted; those of shards, too."""
    import os

    from dse.storage import StudyFolder

    for place, below, _ in os.walk(root / OUT):
        path = Path(place)
        below.sort()
        if StudyFolder.is_at(path):
            yield path
            below[:] = below if path == root / OUT else []  # what is in a study's folder is the study's


def _name(path: Path) -> str:
    return path.name


def _file(path: Path, suffix: str, root: Path, facts: Callable[[Entry], dict[str, str]]) -> ListedFile:
    from dse.formats import shown
    from dse.loading import read_document

    name, file = path.name.removesuffix(suffix), shown(path)
    try:
        top = read_document(path, root)
        return ListedFile(name, file, _text(top, "title"), facts(top))
    except DseError as error:
        return ListedFile(name, file, problem=error.problems[0].what)


def _of_bench(top: Entry) -> dict[str, str]:
    return {"design": _text(top, "design")}


def _of_rating(top: Entry) -> dict[str, str]:
    return {"protocol": _text(top, "protocol")}


def _of_study(top: Entry) -> dict[str, str]:
    sampler = top.document.data.get("sampler")
    word = next(iter(sampler), "") if isinstance(sampler, dict) else sampler
    benches = top.document.data.get("testbench")
    several = " + ".join(map(str, benches)) if isinstance(benches, list) else _text(top, "testbench")
    return {"testbench": several, "sampler": word if isinstance(word, str) else ""}


def _text(top: Entry, key: str) -> str:
    value = top.document.data.get(key)
    return value if isinstance(value, str) else ""


def _results(path: Path) -> ListedResults:
    from dse.api.studies.status import study_summary
    from dse.formats import shown

    folder = Path(shown(path))
    try:
        now = study_summary(path)
    except DseError as error:
        return ListedResults(folder, problem=error.problems[0].what)
    verdicts = {str(verdict): count for verdict, count in now.verdicts.items()}
    return ListedResults(folder, now.study, now.state, now.runs, now.finished, verdicts)
