"""``dse mcp``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app


@app.command()
def mcp(
    workspace: Annotated[Path, typer.Argument(help="A folder or file in the workspace.")] = Path(),
    runs: Annotated[
        int, typer.Option("--runs", min=0, metavar="N", help="Let the assistant simulate up to N runs, all together.")
    ] = 0,
) -> None:
    """Serve tools for assistants over standard input and output (Model Context Protocol).

    An assistant can list, check, count and explain designs, and read the results of studies: verdicts with margins and
    error bars, rankings, findings, runs with waveforms, and pictures. It reads only this workspace, and changes and
    simulates nothing unless --runs is given. Needs the extra 'mcp'.
    """
    from dse.cli.mcp.server import server_of

    server_of(workspace, runs).run("stdio")
