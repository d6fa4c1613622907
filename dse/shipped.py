"""The folders that come with the program: the example's and the pages about everything."""

from __future__ import annotations

import shutil
from collections.abc import Sequence
from pathlib import Path

from dse.errors import Location, fail

EXAMPLE = ("components", "designs", "roads", "testbenches", "schemas")


def content(*folders: str) -> Path:
    """Where *folders* lie: in the installed package, or in the clone it is run from. Raises DseError if nowhere."""
    package = Path(__file__).resolve().parent
    for candidate in (package / "content", package.parent):
        if all((candidate / name).is_dir() for name in folders):
            return candidate
    raise fail(f"{' and '.join(folders)} are missing from this installation", hint="install dse-workbench again")


def lay_out(folder: Path, names: Sequence[str] = EXAMPLE) -> None:
    """Copy these folders of the example into *folder*. Raises DseError unless it is new or empty."""
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise fail("the folder is not empty", Location(str(folder)), "name a new folder; nothing is overwritten")
    source = content(*names)
    for name in names:
        shutil.copytree(source / name, folder / name)
