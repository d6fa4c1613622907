"""``dse build``."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app, console
from dse.cli.arguments import FmiVersion


@app.command()
def build(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[COMPONENT]...", help="Components; all if none is named.")
    ] = None,
    folder: Annotated[Path | None, typer.Option("--output", "-o", metavar="DIR", help="Copy the FMUs here.")] = None,
    version: FmiVersion = 2,
    workspace: Annotated[Path, typer.Option("--workspace", "-w", help="A folder or file in the workspace.")] = Path(),
) -> None:
    """Build components into FMUs.

    What was built before is taken from the cache (its folder is $DSE_CACHE, else the user's cache folder).
    """
    from dse.domain.component import CSource, FmuSource
    from dse.fmu.build import build_all
    from dse.loading.workspace import Workspace

    space = Workspace.around(workspace)
    found = [space.component(name) for name in names or space.component_files]
    if not names:
        found = [component for component in found if isinstance(component.source, CSource | FmuSource)]
    archives = build_all(found, version=version)
    screen = console()
    for name, archive in sorted(archives.items()):
        target = archive
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            target = folder / f"{name}.fmu"
            shutil.copyfile(archive, target)
        screen.print(f"{name}: {target}", soft_wrap=True)
