"""``dse check``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Strict
from dse.cli.packages import check_package, is_package
from dse.cli.scenarios import check_scenario, is_scenario
from dse.cli.terminal import print_line, print_some, status_line
from dse.errors import Problem, raise_if_any


@app.command()
def check(
    workspace: Annotated[
        Path, typer.Argument(help="A folder or file in the workspace; an SSP package; or an OpenSCENARIO file.")
    ] = Path(),
    strict: Strict = False,
) -> None:
    """Check a workspace, an SSP package or an OpenSCENARIO file, and list all errors.

    Checks every component, design space, test bench and study: keys, units, types, wiring, metrics,
    and that each design space has a valid configuration.
    """
    from dse.loading import Workspace
    from dse.testbench import check_workspace

    if is_scenario(workspace.name):
        check_scenario(workspace, strict=strict)
        return
    if is_package(workspace.name):
        check_package(workspace, strict=strict)
        return
    ignored: list[Problem] = []
    with status_line() as show:
        problems, counts = check_workspace(
            Workspace.around(workspace),
            lambda what, number, of, name: show(f"checking {what}: {number} of {of} ({name})"),
            ignored,
        )
    if strict:
        problems += ignored
    raise_if_any(problems)
    print_some("ignored", sorted(ignored, key=str))
    plural = {"study": "studies", "test bench": "test benches"}
    print_line(
        "ok: " + ", ".join(f"{n} {what if n == 1 else plural.get(what, what + 's')}" for what, n in counts.items())
    )
