"""``dse check``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.status import status_line
from dse.cli.terminal import say
from dse.errors import DseError


@app.command()
def check(
    workspace: Annotated[Path, typer.Argument(help="A folder or file in the workspace.")] = Path(),
) -> None:
    """Read a workspace and show all that is wrong with it.

    Checks every component, design space, test bench and study: keys, units, types, wiring, metrics,
    and that each design space has a valid configuration.
    """
    from dse.loading import Workspace
    from dse.testbench import check_workspace

    with status_line() as show:
        problems, counts = check_workspace(
            Workspace.around(workspace),
            lambda what, number, of, name: show(f"checking {what}: {number} of {of} ({name})"),
        )
    if problems:
        raise DseError(*problems)
    plural = {"study": "studies", "test bench": "test benches"}
    say("ok: " + ", ".join(f"{n} {what if n == 1 else plural.get(what, what + 's')}" for what, n in counts.items()))
