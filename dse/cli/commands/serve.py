"""``dse serve``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Listen, ServerPort
from dse.cli.terminal import print_line

Place = Annotated[
    Path, typer.Argument(metavar="DIR", help="A study folder, a folder that contains some, or a workspace.")
]


@app.command()
def serve(
    folder: Place = Path(),
    listen: Listen = "",
    port: ServerPort = 8470,
    workspace: Annotated[
        Path | None, typer.Option("--workspace", metavar="DIR", help="Simulate with the files of this workspace.")
    ] = None,
) -> None:
    """Show studies in the browser, also while they are explored.

    The same report as 'dse report', with new runs as they finish, progress, a button that stops the exploration, points
    simulated at a click, and studies side by side. Only this machine can reach it, unless --listen is given; then the
    printed address contains a token, without which nothing is shown. Ctrl-C ends it.

    Points are simulated with the study's workspace if it is the one of the current folder, or was trusted with 'dse
    trust': its code is compiled and run.
    """
    from dse.serving import Announced, StudyIndex, serve as serve_studies

    def announce(announced: Announced) -> None:
        print_line(f"{announced.address}", style="bold")
        if announced.has_token:
            print_line(
                "whoever has this address may look, stop and simulate; nothing on the way is encrypted", stderr=True
            )
        print_line("Ctrl-C ends it", stderr=True)

    serve_studies(StudyIndex(folder, workspace), listen=listen, port=port, tell=announce)
