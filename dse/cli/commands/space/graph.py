"""``dse space graph``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import opened
from dse.cli.arguments import Choose, Configuration, Design, Off, On
from dse.cli.commands.space import space_app
from dse.cli.terminal import print_line
from dse.scratch import write_whole

if TYPE_CHECKING:
    from dse.domain import design as nouns
    from dse.space import OpenedSpace


def _svg(path: Path) -> Path:
    if path.suffix.lower() != ".svg":
        raise typer.BadParameter(f"'{path.name}' must end in .svg")
    return path


@space_app.command("graph")
def graph_(
    design: Design,
    target: Annotated[
        Path, typer.Option("--output", "-o", metavar="FILE", callback=_svg, help="The SVG file to write.")
    ] = Path("graph.svg"),
    configuration: Configuration = None,
    choose: Choose = [],
    below: Annotated[
        str | None, typer.Option("--below", metavar="PLACE", help="Draw only a place and what is below it.")
    ] = None,
    on: On = [],
    off: Off = [],
) -> None:
    """Draw a design space, and one configuration in it.

    Dashed lines lead to alternatives; those that no valid configuration has are grey.
    """
    whole = opened(design, on=on, off=off)
    chosen = _chosen(whole, configuration, choose)
    write_whole(target, whole.picture(chosen, _note(whole, chosen), below))
    print_line(f"{target}: {whole.space.name}")


def _chosen(whole: OpenedSpace, configuration: str | None, choose: list[str]) -> nouns.Configuration | None:
    if configuration and choose:
        raise typer.BadParameter("one of --configuration and --choose", param_hint="--choose")
    if configuration:
        return whole.configuration(configuration)
    return whole.described(choose) if choose else None


def _note(whole: OpenedSpace, chosen: nouns.Configuration | None) -> str:
    from dse.cli.spaces import number_text

    if chosen is None:
        return f"{number_text(whole.total)} combinations before the static constraints"
    broken = ", ".join(entry.constraint.name for entry in whole.broken(chosen.choices))
    return f"configuration {chosen.id}, which {f'breaks {broken}' if broken else 'meets every static constraint'}"
