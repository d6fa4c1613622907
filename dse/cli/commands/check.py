"""``dse check``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Strict
from dse.cli.diagnostics import Checked, CheckFormat, as_data, as_github, as_sarif
from dse.cli.endings import DONE, WRONG_FILES
from dse.cli.packages import check_package, is_package
from dse.cli.scenarios import check_scenario, is_scenario
from dse.cli.terminal import print_json, print_line, print_some, status_line
from dse.errors import DseError, Problem, raise_if_any


@app.command()
def check(
    workspace: Annotated[
        Path, typer.Argument(help="A folder or file in the workspace; an SSP package or FMU; or an OpenSCENARIO file.")
    ] = Path(),
    strict: Strict = False,
    form: Annotated[
        CheckFormat,
        typer.Option("--format", help="For a person, a program, code scanning, or the log of a GitHub workflow."),
    ] = CheckFormat.TEXT,
) -> None:
    """Check a workspace, an SSP package, an FMU or an OpenSCENARIO file, and list all errors.

    Checks every component, design space, test bench and study: keys, units, types, wiring, metrics,
    and that each design space has a valid configuration.
    """
    try:
        found = _checked(workspace)
    except DseError as error:
        found = Checked(problems=error.problems)
    if strict:
        found = replace(found, problems=[*found.problems, *found.ignored], ignored=())
    if form is CheckFormat.TEXT:
        raise_if_any(found.problems)
        _show(found)
        return
    if form is CheckFormat.GITHUB:
        for line in as_github(found):
            print_line(line)
    else:
        print_json(as_data(found) if form is CheckFormat.JSON else as_sarif(found))
    raise typer.Exit(WRONG_FILES if found.problems else DONE)


def _checked(path: Path) -> Checked:
    from dse.loading import Workspace
    from dse.testbench import check_workspace

    if is_scenario(path.name):
        return check_scenario(path)
    if is_package(path.name):
        return check_package(path)
    ignored: list[Problem] = []
    with status_line() as show:
        problems, counts = check_workspace(
            Workspace.around(path),
            lambda what, number, of, name: show(f"checking {what}: {number} of {of} ({name})"),
            ignored,
        )
    return Checked(problems, sorted(ignored, key=str), counts)


def _show(found: Checked) -> None:
    print_some("note", found.notes)
    print_some("ignored", found.ignored)
    for line in found.details:
        print_line(line)
    counted = (f"{n} {what if n == 1 else _PLURALS.get(what, what + 's')}" for what, n in found.counts.items())
    print_line(f"ok: {', '.join(counted)}{found.more}")


_PLURALS = {
    "study": "studies",
    "test bench": "test benches",
    "entity": "entities",
    "element of the storyboard": "elements of the storyboard",
}
