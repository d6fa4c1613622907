"""Where a workspace ends: what its files name must lie inside."""

from __future__ import annotations

import errno
from collections.abc import Collection
from pathlib import Path

from dse.errors import Location, fail
from dse.places import workspace_around

FOLLOWED: set[Path] = set()
"""Every path that files of a workspace have named in this process."""


def find_root(path: Path) -> Path | None:
    """The nearest folder at or above *path* that holds ``components/``, or None."""
    found = workspace_around(str(path))
    return Path(found) if found else None


def named_file(folder: Path, name: str, inside: Path, suffixes: Collection[str], where: Location) -> Path:
    """The file called *name* by a file in *folder*; it need not exist.

    Raises DseError, at *where*, if its name does not end in one of *suffixes* or it lies outside of *inside*,
    also by way of a link: what a workspace says must not depend on other places of the machine, or show them.
    """
    path = followed(folder, name, where)
    if not path.is_relative_to(inside.resolve()):
        raise fail(f"'{name}' is outside the workspace", where, "copy the file into the workspace")
    if path.suffix not in suffixes:
        raise fail(f"'{name}' must be a {' or '.join(suffixes)} file", where, "name another file")
    return path


def followed(folder: Path, name: str, where: Location) -> Path:
    """The path *name*, relative to *folder*, with its links followed. Raises DseError, at *where*."""
    try:
        path = (folder / name).resolve()
    except (OSError, RuntimeError) as error:  # RuntimeError is how Python 3.11 tells of links in a circle
        raise fail(f"'{name}' cannot be followed to a file", where, "paths are relative to this file") from error
    FOLLOWED.add(path)
    return path


def is_file(path: Path) -> bool:
    """Whether *path* is a file; no name that is too long is one's. Raises OSError if the system cannot tell."""
    try:
        return path.is_file()
    except OSError as error:
        if error.errno == errno.ENAMETOOLONG:
            return False
        raise
