"""``dse build``."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app, console
from dse.cli.arguments import FmiVersion
from dse.errors import DseError, Location, Problem


@app.command()
def build(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[COMPONENT]...", help="Components; all if none is named.")
    ] = None,
    folder: Annotated[Path | None, typer.Option("--output", "-o", metavar="DIR", help="Copy the FMUs here.")] = None,
    version: FmiVersion = 2,
    validate: Annotated[bool, typer.Option("--validate", help="Check each FMU with FMPy's validation.")] = False,
    workspace: Annotated[Path, typer.Option("--workspace", "-w", help="A folder or file in the workspace.")] = Path(),
) -> None:
    """Build components into FMUs.

    What was built before is taken from the cache (its folder is $DSE_CACHE, else the user's cache folder).
    """
    from dse.domain.component import CSource, FmuSource, ModelicaSource
    from dse.fmu.build import build_all
    from dse.loading.workspace import Workspace

    space = Workspace.around(workspace)
    found = [space.component(name) for name in names or space.component_files]
    if not names:
        found = [component for component in found if isinstance(component.source, CSource | FmuSource | ModelicaSource)]
    archives = build_all(found, version=version)
    if validate:
        _validate(archives)
    screen = console()
    for name, archive in sorted(archives.items()):
        target = archive
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            target = folder / f"{name}.fmu"
            shutil.copyfile(archive, target)
        screen.print(f"{name}: {target}", soft_wrap=True)


def _validate(archives: Mapping[str, Path]) -> None:
    """Raise DseError with what FMPy finds wrong with the FMUs."""
    from fmpy.validation import validate_fmu

    problems = [
        Problem(f"the FMU of {name}: {finding}", Location(str(archive)))
        for name, archive in archives.items()
        for finding in validate_fmu(str(archive))
    ]
    if problems:
        raise DseError(*problems)
