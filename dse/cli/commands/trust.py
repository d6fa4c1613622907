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
    """Trust a workspace that came with a study folder, as it is now.

    'dse serve' and replays compile and run the C code of the workspace a study lies in. They use the one they were
    started in, or one that was trusted. When a file in it changes, it has to be trusted again.
    """
    from dse.api import trust as trust_workspace

    print_line(f"trusted as it is now: {trust_workspace(folder).root}")
