"""``dse refine``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Folder
from dse.cli.terminal import print_line, status_line
from dse.scratch import make_folder, write_whole


@app.command()
def refine(
    folder: Folder,
    around: Annotated[int | None, typer.Option("--around", metavar="RUN", help="Explore around this run.")] = None,
    front: Annotated[bool, typer.Option("--front", help="Explore around the best designs, or the front.")] = False,
    box: Annotated[bool, typer.Option("--box", help="Explore where all requirements are met most often.")] = False,
    band: Annotated[bool, typer.Option("--band", help="Explore where a verdict is doubtful.")] = False,
    share: Annotated[
        float, typer.Option("--share", min=0.001, max=1.0, help="Share of each range for --around.")
    ] = 0.25,
    number: Annotated[int, typer.Option("--number", "-n", min=1, help="Number of best designs.")] = 5,
    target: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="The study, as testbenches/next.pet.yaml.")
    ] = None,
) -> None:
    """Write the next study: the part of a study's ranges and configurations that its results point to.

    Everything else in the study's file stays as it is. Without -o it is printed.
    """
    from dse.api import Towards, refine as refined

    ways = {Towards.AROUND: around is not None, Towards.FRONT: front, Towards.BOX: box, Towards.BAND: band}
    asked = [way for way, is_asked in ways.items() if is_asked]
    if len(asked) != 1:
        raise typer.BadParameter("choose where to look: one of these", param_hint="--around, --front, --box, --band")
    if target is not None and not target.name.endswith(".pet.yaml"):
        raise typer.BadParameter(f"'{target}': a study's file ends in .pet.yaml", param_hint="--output")
    name = target.name.removesuffix(".pet.yaml") if target else f"{folder.name}_next"
    with status_line() as tell:
        tell("looking at the runs")
        text = refined(folder, name, asked[0], run=around or 0, share=share, number=number)
    if target is None:
        typer.echo(text, nl=False)
        return
    if target.exists():
        raise typer.BadParameter(f"'{target}' already exists", param_hint="--output")
    make_folder(target.parent)
    write_whole(target, text)
    print_line(f"{target}: dse explore {name}")
