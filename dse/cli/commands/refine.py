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
    around: Annotated[int | None, typer.Option("--around", metavar="RUN", help="Look around this run.")] = None,
    front: Annotated[bool, typer.Option("--front", help="Look around the best designs, or the front.")] = False,
    box: Annotated[bool, typer.Option("--box", help="Look where all requirements are met most often.")] = False,
    band: Annotated[bool, typer.Option("--band", help="Look where a verdict is in doubt.")] = False,
    share: Annotated[
        float, typer.Option("--share", min=0.001, max=1.0, help="How much of each range --around a run.")
    ] = 0.25,
    number: Annotated[int, typer.Option("--number", "-n", min=1, help="How many of the best.")] = 5,
    target: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="The study, as testbenches/next.pet.yaml.")
    ] = None,
) -> None:
    """Write the next study: a part of a study's ranges and configurations that something found in it points to.

    What else the study's file says stays as it is. Without -o it is printed.
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
        raise typer.BadParameter(f"'{target}' is there already", param_hint="--output")
    make_folder(target.parent)
    write_whole(target, text)
    print_line(f"{target}: dse explore {name}")
