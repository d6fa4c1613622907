"""``dse trust``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.terminal import print_line

Place = Annotated[Path, typer.Argument(metavar="DIR", help="A workspace, or a folder in it.")]


@app.command()
def trust(folder: Place = Path()) -> None:
    """Trust the current state of a workspace that came with a study folder.

    'dse serve' and replays compile and run the C code of the study's workspace. They use the workspace in which they
    were started, or a trusted one. When a file in it changes, it has to be trusted again.
    """
    from dse.api import trust as trust_workspace

    print_line(f"trusted as it is now: {trust_workspace(folder).root}")
