"""What a person names by its name or its file: workspaces, design spaces and study folders."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

from dse.errors import DseError, Location, closest, fail
from dse.places import OUT

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable

    from dse.domain.design import DesignSpace
    from dse.domain.expression import Expression
    from dse.loading import Workspace
    from dse.space import Aim, OpenedSpace

_NO_YAML = {
    ".fmu": ("an FMU", "'dse import fmu {0}' makes a component of it; 'dse probe {0}' finds out what it does"),
    ".ssp": ("an SSP package", "'dse simulate {0}' simulates it; 'dse import ssp {0} DIR' makes a workspace of it"),
}


def workspace_of(name: str) -> Workspace:
    """The workspace of the file called *name*, or the one around the current folder.

    Raises DseError, also for the name of a file that is no workspace's.
    """
    from dse.loading import Workspace

    path = Path(name)
    if path.suffix.lower() in _NO_YAML:
        what, hint = _NO_YAML[path.suffix.lower()]
        raise fail(f"'{name}' is {what}", hint=hint.format(name))
    return Workspace.around(path.parent if path.suffix and path.parent.is_dir() else Path())


def new_folder(workspace: Workspace, name: str) -> Path:
    """``out/NAME`` of *workspace*: where the results of the study or bench *name* go if nobody says where."""
    from dse.formats import shown

    return Path(shown(workspace.root / OUT / name))


def study_folder(path: Path) -> Path:
    """*path*; if nothing is there, it is a name, and the workspace around the current folder has ``out/NAME``: that.

    Raises DseError if there is nothing either, and it is the name of a study or bench: it was not simulated yet.
    """
    from dse.formats import shown
    from dse.loading import BENCH_FILE, STUDY_FILE, Workspace, find_root, is_file

    if is_file(path) or path.is_dir() or len(path.parts) > 2 or path.parts[:-1] not in ((), (OUT,)):
        return path
    root = find_root(Path())
    named = root / OUT / path.name if root else path
    if root and not named.is_dir() and (kind := Workspace(root).kind_of(path.name)) in (STUDY_FILE, BENCH_FILE):
        what = f"the {kind.name} '{path.name}' has no results in {shown(named)}"
        raise fail(what, hint=f"simulate it first: {kind.command} {path.name}")
    return Path(shown(named)) if named.is_dir() else path


def space_of(
    design: str, on: Collection[str] = (), off: Collection[str] = (), workspace: Workspace | None = None
) -> DesignSpace:
    """The design space called *design*, checked, with constraint sets switched; a ``.uvl`` file is a feature model.

    It is looked for in *workspace*, else in that of `workspace_of`. Raises DseError with all problems.
    """
    from dse.loading import read_uvl
    from dse.space import check_space, switched

    path = Path(design)
    space = read_uvl(path) if path.suffix.lower() == ".uvl" else (workspace or workspace_of(design)).design(design)
    problems = check_space(space)
    if problems:
        raise DseError(*problems)
    return switched(space, on, off)


def opened(
    design: str,
    choose: Iterable[str] = (),
    where: str | None = None,
    on: Collection[str] = (),
    off: Collection[str] = (),
) -> OpenedSpace:
    """The design space of `space_of`, opened for questions about a part of it. Raises DseError with all problems."""
    from dse.space import open_space

    space = space_of(design)
    return open_space(space, choose, condition_of(where, space), on, off)


def condition_of(text: str | None, space: DesignSpace) -> Expression | None:
    """The condition of ``--where`` on *space*; its problems are located in the text of the option. Raises DseError."""
    from dse.expression import parse_expression
    from dse.units import own_units

    with own_units(space.units):
        return None if text is None else parse_expression(unquoted(text, space, "--where"), Location("--where", 1, 1))


def aims_of(minimize: Iterable[str], maximize: Iterable[str], space: DesignSpace) -> tuple[Aim, ...]:
    """The objectives on *space* written in texts, those to be minimised first. Raises DseError."""
    from dse.space import read_aims

    return read_aims(
        [unquoted(text, space, "--minimize") for text in minimize],
        [unquoted(text, space, "--maximize") for text in maximize],
        space.units,
    )


def unquoted(text: str, space: DesignSpace, option: str) -> str:
    """*text* with names for the titles that it has in quotes: those of parts, of compounds and of features that a
    feature model calls so. Raises DseError for one that nothing in *space* has, or several parts, in *option*."""
    from dse.domain.design import Compound, Part, walk

    names: dict[str, set[str]] = {}
    for _, node in walk(space.root) if '"' in text else ():
        if isinstance(node, Part | Compound):
            names.setdefault(node.component.title if isinstance(node, Part) else node.title, set()).add(node.name)

    def name_of(match: re.Match[str]) -> str:
        found = names.get(match[1], set())
        if len(found) != 1:
            what = f"nothing is called '{match[1]}'" if not found else f"several parts are called '{match[1]}'"
            hint = closest(match[1], filter(None, names)) if not found else f"write one of {', '.join(sorted(found))}"
            raise fail(what, Location(option, 1, match.start() + 1), hint)
        return next(iter(found))

    return re.sub(r'"([^"]+)"', name_of, text)
