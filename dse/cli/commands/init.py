"""``dse init``."""

from __future__ import annotations

import shlex
import shutil
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.content import content
from dse.cli.terminal import console, print_line
from dse.errors import Location, fail

_FOLDERS = ("components", "designs", "roads", "testbenches", "schemas")


@app.command()
def init(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A new or empty folder.")],
) -> None:
    """Create a working example to start from.

    Components in C, design spaces, roads, test benches and studies go into DIR, a new or empty folder.
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise fail("the folder is not empty", Location(str(folder)), "name a new folder; nothing is overwritten")
    source = content(*_FOLDERS)
    for name in _FOLDERS:
        shutil.copytree(source / name, folder / name)
    screen = console()
    screen.print(f"{folder}: {sum(path.is_file() for path in folder.rglob('*'))} files")
    print_line(f"next: cd {shlex.quote(str(folder))}; dse check; dse explore acc_gains; dse report acc_gains")
