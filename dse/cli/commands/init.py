"""``dse init``."""

from __future__ import annotations

import shlex
import shutil
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.terminal import console, print_line
from dse.shipped import content, lay_out

_FMUS = "examples/fmus"


class Example(StrEnum):
    """What can be laid out."""

    WORKSPACE = "workspace"
    FMUS = "fmus"


@app.command()
def init(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="A new or empty folder.")],
    example: Annotated[
        Example,
        typer.Option(
            help="workspace: components in C and Modelica, design spaces, roads, test benches and studies. "
            "fmus: three FMUs and their sources, to import into a workspace ('dse docs bring-your-fmu')."
        ),
    ] = Example.WORKSPACE,
) -> None:
    """Create a working example to start from, in DIR, a new or empty folder."""
    if example is Example.FMUS:
        _lay_out_fmus(folder)
        steps = "dse probe truck.fmu; dse import fmu *.fmu -o trucks"
    else:
        lay_out(folder)
        steps = "dse check; dse explore acc_gains; dse report acc_gains"
    screen = console()
    screen.print(f"{folder}: {sum(path.is_file() for path in folder.rglob('*'))} files")
    print_line(f"next: cd {shlex.quote(str(folder))}; {steps}")


def _lay_out_fmus(folder: Path) -> None:
    from dse.fmu import build_all
    from dse.loading import Workspace

    lay_out(folder, ())
    source = content(_FMUS) / _FMUS
    space = Workspace.around(source)
    built = build_all([space.component(name) for name in space.component_files])
    shutil.copytree(source, folder / "sources")
    for name, path in built.items():
        shutil.copyfile(path, folder / f"{name}.fmu")
