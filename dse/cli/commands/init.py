"""``dse init``."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.terminal import console, print_line
from dse.shipped import lay_out


@app.command()
def init(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A new or empty folder.")],
) -> None:
    """Create a working example to start from.

    Components in C, design spaces, roads, test benches and studies go into DIR, a new or empty folder.
    """
    lay_out(folder)
    screen = console()
    screen.print(f"{folder}: {sum(path.is_file() for path in folder.rglob('*'))} files")
    print_line(f"next: cd {shlex.quote(str(folder))}; dse check; dse explore acc_gains; dse report acc_gains")
