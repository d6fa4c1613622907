"""``dse space graph``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api.naming import space_of
from dse.cli.arguments import Choose, Configuration, Design, Off, On
from dse.cli.commands.space import space_app
from dse.cli.terminal import say

if TYPE_CHECKING:
    from dse.domain import design as nouns


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
        str | None, typer.Option("--below", metavar="PLACE", help="Draw only what stands at and below a place.")
    ] = None,
    on: On = [],
    off: Off = [],
) -> None:
    """Draw a design space, and one configuration in it.

    Dashed lines lead to alternatives; what no valid configuration can have is grey.
    """
    from dse.space.engine import Engine
    from dse.space.output.drawing import draw
    from dse.space.output.graph import below as part_below
    from dse.space.output.graph import dead_branches, graph

    space = space_of(design, on, off)
    chosen = _chosen(space, configuration, choose)
    tree = graph(space, chosen.choices if chosen else None, dead_branches(Engine.of(space)))
    picture = draw(part_below(tree, below) if below else tree, space.title or space.name, _note(space, chosen))
    target.write_text(picture, encoding="utf-8", newline="\n")
    say(f"{target}: {space.name}")


def _chosen(space: nouns.DesignSpace, configuration: str | None, choose: list[str]) -> nouns.Configuration | None:
    from dse.space.choosing import ABSENT_NAME, read_choices
    from dse.space.enumerate import find
    from dse.space.resolve import resolve

    if configuration and choose:
        raise typer.BadParameter("one of --configuration and --choose", param_hint="--choose")
    if configuration:
        return find(space, configuration)
    choices = read_choices(space, choose)
    there = {path: name for path, name in choices.items() if name != ABSENT_NAME}
    return resolve(space, there) if choices else None


def _note(space: nouns.DesignSpace, chosen: nouns.Configuration | None) -> str:
    from dse.cli.spaces import number_text
    from dse.space.enumerate import total, violated

    if chosen is None:
        return f"{number_text(total(space))} combinations before the static constraints"
    broken = violated(space, chosen.choices)
    state = f"breaks {', '.join(broken)}" if broken else "meets every static constraint"
    return f"configuration {chosen.id}, which {state}"
