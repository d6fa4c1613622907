"""Writes starts into a workspace; nothing is overwritten."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from dse.errors import Location, Problem, Problems, raise_if_any
from dse.formats import shown
from dse.loading import check_choice, is_identifier
from dse.scratch import make_folder, write_whole

if TYPE_CHECKING:
    from dse.loading import Workspace


def write_start(workspace: Workspace, name: str, files: Mapping[PurePosixPath, str]) -> list[Path]:
    """Write *files* of what is to be called *name*; returns their paths.

    Raises DseError, and writes nothing, if that can be no name, or is taken.
    """
    problems = Problems()
    check_choice(name, Location("NAME"), problems)
    if not problems and not is_identifier(name):
        problems.add(
            f"'{name}' is a keyword of C, so C code cannot use it as a name", Location("NAME"), "choose another name"
        )
    raise_if_any(problems)
    targets = {workspace.root.joinpath(path): text for path, text in files.items()}
    raise_if_any(_taken(workspace, targets))
    for path, text in targets.items():
        make_folder(path.parent)
        write_whole(path, text)
    return list(targets)


def _taken(workspace: Workspace, targets: Mapping[Path, str]) -> Iterator[Problem]:
    hint = "choose another name; nothing is overwritten"
    known = [path for folder in ("components", "designs", "roads", "testbenches") for path in workspace.files(folder)]
    for target in targets:
        same = [path for path in known if path != target and _called(target) and _called(path) == _called(target)]
        if target.exists():
            yield Problem("the file already exists", Location(shown(target)), hint)
        elif same:
            yield Problem(f"'{_called(target)}' already exists", Location(shown(same[0])), hint)


def _called(path: Path) -> str:
    """What others call a file by: a component by its folder."""
    if path.name == "component.yaml":
        return f"{path.parent.name}/{path.name}"
    return "" if path.name == "interfaces.yaml" else path.name


# The first line of a file, by which editors know what may stand in it.


def headed(text: str, depth: int, kind: str) -> str:
    """*text*, a file of the *kind* so many folders below the root of its workspace, with its schema named."""
    return f"# yaml-language-server: $schema={'../' * depth}schemas/{kind}.json\n{text}"
