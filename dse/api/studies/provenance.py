"""What is kept with a study besides its results: its files as they are run, and what its design space holds."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from dse.cache import cache_folder, content_key, keep, kept
from dse.domain.design import candidates
from dse.domain.provenance import Absent, Funnel, Left, Provenance, SourceText, digest_of
from dse.errors import DseError, Location, fail, is_gone
from dse.formats import shown
from dse.loading import Workspace, find_root
from dse.places import PROCEDURE, RATING
from dse.storage import StudyFolder

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.definition import StudyDefinition
    from dse.domain.study import Study
    from dse.errors import Location
    from dse.space import OpenedSpace
    from dse.storage import StudyFolder

_LONGEST = 1_000_000
_MOST_ABSENT = 30
_ABSENT = "absent"


def note_sources(study: Study, store: StudyFolder) -> None:
    """Keep the files of *study* as they are; what was known of its design space goes if one of them has changed."""
    notes, known = Provenance(tuple(_sources(study)), assumed=tuple(sorted(_assumed(study)))), store.notes()
    if known is None or (known.sources, known.assumed) != (notes.sources, notes.assumed):
        store.note(notes)


def note_space(study: Study, store: StudyFolder) -> None:
    """Keep what the constraints leave of the design space, if that is not known already."""
    known = store.notes() or Provenance()
    if known.funnel is None and not known.unfunnelled:
        try:
            notes = replace(known, funnel=_funnel(study))
        except DseError as error:
            notes = replace(known, unfunnelled=error.problems[0].what)
        store.note(notes)


def _sources(study: Study) -> Iterator[SourceText]:
    places = [("study", study.where), *(("test bench", bench.where) for bench in study.benches)]
    found = [(kind, _file(where)) for kind, where in [*places, ("design space", study.bench.design.where)]]
    told: set[Path] = set()
    for kind, file in found:
        if file is None or file in told:
            continue
        told.add(file)
        try:
            if file.stat().st_size > _LONGEST:
                continue
            text = file.read_bytes().decode("utf-8")
        except ValueError:
            continue  # no text: there is nothing that could be shown
        except OSError as error:
            if is_gone(error):  # of a package
                continue
            raise
        yield SourceText(kind, file.name, text, digest_of(text))


_ASSUMED = re.compile(r"(#|[;,]) *assumed\b")


def _assumed(study: Study) -> Iterator[str]:
    """Parameters whose line in the component's file says ``# assumed``, or whose title ends so."""
    of_designs = (each for bench in study.benches for each in candidates(bench.design.root).values())
    of_benches = (each.component for bench in study.benches for each in bench.test_components)
    components = {each.name: each for each in (*chain.from_iterable(of_designs), *of_benches)}
    for component in components.values():
        file = _file(component.where)
        try:
            lines = file.read_text(encoding="utf-8", errors="replace").splitlines() if file else []
        except OSError:  # of a package
            continue
        for parameter in component.parameters:
            line = parameter.where.line if parameter.where else 0
            if line and line <= len(lines) and _ASSUMED.search(lines[line - 1]):
                yield f"{component.name}.{parameter.name}"


def _file(where: Location | None) -> Path | None:
    return Path(where.file) if where and where.file else None


def _funnel(study: Study) -> Funnel:
    from dse.space import open_space

    design = study.bench.design
    opened = open_space(design)
    total = opened.count_unconstrained()
    steps = tuple(
        Left(constraint.name, constraint.because, constraint.rule.text.strip(), _number(left.value), str(left))
        for constraint, left in zip(design.constraints, opened.funnel(), strict=True)
    )
    return Funnel(design.name, _number(total.value), str(total), steps, tuple(_absent(opened)))


def _absent(opened: OpenedSpace) -> Iterator[Absent]:
    dead = [each for each in opened.occurrences() if each.dead]
    for each in dead[:_MOST_ABSENT]:
        choice = each.choice or _ABSENT
        conflict = opened.explain([f"{each.path}={choice}"]).conflict
        yield Absent(each.path, choice, tuple(constraint.name for constraint in conflict))


def _number(count: int) -> float:
    return float(min(count, 10**300))


# Whose workspace is simulated for a study: a workspace is a program, and a study folder may come from anybody.


T = TypeVar("T")

_KEY = "trusted"
_MOST = 10_000
_RESULTS = frozenset({".parquet", ".sqlite", ".sqlite-wal", ".sqlite-shm", ".spool", ".html", ".png", ".svg", ".pdf"})
"""Endings of what studies write, of which nothing is compiled or read as a model."""


def trust(path: Path) -> Workspace:
    """Trust the workspace around *path* as it is now: the user has read it, and lets it run with their rights.

    When its content changes, it is no longer trusted. Raises DseError if there is none, or it cannot be remembered.
    """
    workspace = Workspace.around(path)
    keep(_mark(workspace.root), _KEY, os.fsencode(workspace.root), most=_MOST)
    if not _is_remembered(workspace.root):
        raise fail(f"the cache folder {cache_folder()} cannot be written", hint="set DSE_CACHE to a folder of yours")
    return workspace


def in_workspace(folder: Path, look: Callable[[Workspace], T], given: Path | None = None) -> T:
    """What *look* finds in the workspace *given*, else in the one around the study folder, else around the current one.

    Without being named, a workspace is used only if it is trusted: the current folder is in it and in no study folder,
    or `trust` was called for it. Raises DseError if *look* finds nothing in any, or in none that is trusted.
    """
    if given is not None:
        return look(Workspace.around(given))
    roots = dict.fromkeys(root for root in (find_root(folder), find_root(Path())) if root)
    not_trusted = [root for root in roots if not is_trusted(root)]
    problem = _refused(not_trusted[0]) if not_trusted else None
    for root in roots:
        if root not in not_trusted:
            try:
                return look(Workspace.around(root))
            except DseError as error:
                problem = problem or error
    if problem:
        raise problem
    return look(Workspace.around(Path()))  # raises: there is none


def benches_near(definition: StudyDefinition, near: Path, workspace: str | Path | None = None) -> tuple[TestBench, ...]:
    """The benches of the study as its workspace has them now: *workspace*, or that of `in_workspace` for *near*."""
    return in_workspace(near, lambda found: benches_in(found, definition), Path(workspace) if workspace else None)


def benches_in(workspace: Workspace, definition: StudyDefinition) -> tuple[TestBench, ...]:
    """The benches of the study *definition* in *workspace*, by their names. Raises DseError."""
    # Who made the study folder chose these names: they must not be paths.
    where = Location(definition.study)
    if not definition.variables:
        return (workspace.bench(definition.bench.name, where),)
    try:
        return workspace.study(definition.study, where).benches
    except DseError:
        if (bench := _judged(workspace, definition)) is None:
            raise
        return (bench,)


def _judged(workspace: Workspace, definition: StudyDefinition) -> TestBench | None:
    """The bench of a study that a rating or a test procedure of *workspace* asks for; None if none does."""
    named = re.compile(rf"bench: {re.escape(definition.bench.name)}(?![\w.-])")
    for path in workspace.files("testbenches"):
        # To read all that a rating asks for takes a second.
        if not path.name.endswith((PROCEDURE, RATING)) or not named.search(path.read_text("utf-8")):
            continue
        benches: Iterable[TestBench] = ()
        with suppress(DseError):  # that file is not the one
            if path.name.endswith(PROCEDURE):
                tests = workspace.procedure(str(path)).tests
                benches = (test.bench for test in tests if test.name == definition.study)
            else:
                benches = (replace(test.bench, derived=test.derived) for test in workspace.rating(str(path)).tests)
        for bench in benches:
            derived = {each.name: each.expression.text for each in bench.derived}
            if bench.name == definition.bench.name and derived == definition.derived:
                return bench
    return None


def is_trusted(root: Path) -> bool:
    """Whether the workspace *root* may be used for a study that lies in it, or anywhere, without being named."""
    is_brought = any(StudyFolder.is_at(folder) for folder in (root, *root.parents))
    return (root == find_root(Path()) and not is_brought) or _is_remembered(root)


def _is_remembered(root: Path) -> bool:
    return kept(_mark(root), _KEY) is not None


def _mark(root: Path) -> Path:
    return cache_folder() / "trusted" / content_key(_contents(root))


def _contents(root: Path) -> Iterator[tuple[str, bytes]]:
    """Every file below *root* by its path, but for hidden ones and results of studies; of a link where it leads to."""
    for place, folders, files in os.walk(root):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        for path in (Path(place, name) for name in sorted({*files, *folders})):
            name = path.relative_to(root).as_posix()
            if path.is_symlink():
                yield name, os.fsencode(path.readlink())
            elif path.is_file() and path.suffix not in _RESULTS and not path.name.startswith("."):
                yield name, path.read_bytes()


def _refused(root: Path) -> DseError:
    what = "this workspace came with the study and is not trusted: its C code would run with all your rights"
    return fail(what, Location(shown(root)), f"read what is in it, then 'dse trust {shown(root)}'")
