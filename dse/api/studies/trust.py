"""Whose workspace is simulated for a study: a workspace is a program, and a study folder may come from anybody."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from dse.cache import cache_folder, content_key, keep, kept
from dse.errors import DseError, Location, fail
from dse.formats import shown
from dse.loading import Workspace, find_root
from dse.storage import StudyFolder

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.definition import StudyDefinition

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
    return workspace.study(definition.study, where).benches


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
