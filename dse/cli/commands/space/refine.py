"""``dse space refine``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from dse.api import opened
from dse.cli.arguments import Choose, Design
from dse.cli.commands.space import space_app
from dse.cli.spaces import number_text
from dse.cli.terminal import print_line
from dse.scratch import write_whole

Keep = Annotated[
    list[str],
    typer.Option("--keep", metavar="PLACE=A,B", help="Keep only these alternatives; 'absent' means without the part."),
]
Drop = Annotated[list[str], typer.Option("--drop", metavar="PLACE=C", help="Remove these alternatives.")]


@space_app.command("refine")
def space_refine(
    design: Design,
    keep: Keep = [],
    drop: Drop = [],
    choose: Choose = [],
    ids: Annotated[
        str | None, typer.Option("--ids", metavar="ID,ID", help="Keep the alternatives of these configurations.")
    ] = None,
    target: Annotated[
        Path | None, typer.Option("--output", "-o", metavar="FILE", help="The design to write, as designs/new.yaml.")
    ] = None,
) -> None:
    """Write a design space with fewer alternatives.

    Its configurations are those of the design with only these alternatives; their ids stay the same. Without -o it is
    printed.
    """
    from dse.loading import write_design
    from dse.space import combinations

    _check(design, target, asked=bool(keep or drop or choose or ids))
    whole = opened(design)
    names = None if ids is None else [name.strip() for name in ids.split(",") if name.strip()]
    refined = whole.refined([*keep, *choose], drop, names)
    refined = replace(refined, name=target.stem if target else f"{refined.name}_refined")
    text = write_design(refined)
    if target is None:
        typer.echo(text, nl=False)
        return
    target.parent.mkdir(parents=True, exist_ok=True)
    write_whole(target, text)
    left = number_text(combinations(refined))
    print_line(f"{target}: {left} of {number_text(whole.total)} combinations are left")


def _check(design: str, target: Path | None, *, asked: bool) -> None:
    if not asked:
        raise typer.BadParameter("name what to keep, drop or choose", param_hint="--keep")
    if target is not None and target.suffix != ".yaml":
        raise typer.BadParameter(f"'{target.name}' must end in .yaml", param_hint="--output")
    if Path(design).suffix.lower() == ".uvl":
        raise typer.BadParameter("import it first: dse import uvl", param_hint="DESIGN")
