"""``dse build``."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from dse.api import workspace_of
from dse.cli.app import app
from dse.cli.arguments import Configuration, FmiVersion, Platforms
from dse.cli.completion import benches, components
from dse.cli.terminal import console, print_line
from dse.errors import DseError, Location, Problem
from dse.scratch import make_folder


@app.command()
def build(
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="[COMPONENT]...", autocompletion=components, help="Components; all if none is named."),
    ] = None,
    folder: Annotated[Path | None, typer.Option("--output", "-o", metavar="DIR", help="Copy the FMUs here.")] = None,
    version: FmiVersion = 2,
    platform: Platforms = [],
    validate: Annotated[bool, typer.Option("--validate", help="Check each FMU with FMPy's validation.")] = False,
    bench: Annotated[
        str | None,
        typer.Option(
            "--fuse",
            metavar="BENCH",
            autocompletion=benches,
            help="Compile a bench's configurations into one library each.",
        ),
    ] = None,
    configuration: Configuration = None,
    workspace: Annotated[Path, typer.Option("--workspace", "-w", help="A folder or file in the workspace.")] = Path(),
) -> None:
    """Build components into FMUs.

    FMUs that were built before are taken from the cache (its folder is $DSE_CACHE, else the user's cache folder).

    With --fuse, builds what 'dse run --fuse' needs: one library for each configuration of a test bench.
    """
    if bench is None and configuration is not None:
        raise typer.BadParameter("this is for a test bench: --fuse BENCH", param_hint="--configuration")
    if bench is not None:
        if platform:
            raise typer.BadParameter("a fused library is for this machine only", param_hint="--platform")
        if names or validate:
            raise typer.BadParameter("name either components or a test bench", param_hint="--fuse")
        built = _fused(bench, configuration, version, workspace)
    else:
        built = _fmus(names, version, platform, workspace)
        if validate:
            _validate(built)
    for name, path in sorted(built.items()):
        target = path
        if folder is not None:
            make_folder(folder)
            target = folder / f"{name}{path.suffix if bench else '.fmu'}"
            shutil.copyfile(path, target)
        print_line(f"{name}: {target}")


def _fmus(names: list[str] | None, version: int, platforms: list[str], workspace: Path) -> dict[str, Path]:
    from dse.fmu import build_all, platforms_named
    from dse.loading import Workspace, kind_of

    space = Workspace.around(workspace)
    found = [space.component(name) for name in names or space.component_files]
    if not names:
        found = [component for component in found if kind_of(component) is not None]
    return build_all(found, version=version, platforms=platforms_named(platforms))


def _fused(bench: str, configuration: str | None, version: int, workspace: Path) -> dict[str, Path]:
    from dse.api import fused_libraries
    from dse.loading import Workspace

    space = Workspace.around(workspace) if workspace != Path() else workspace_of(bench)
    with console(stderr=True).status("") as status:
        return fused_libraries(space.bench(bench), configuration, version, tell=status.update)


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
