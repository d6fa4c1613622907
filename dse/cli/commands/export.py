"""``dse export``: design spaces for other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app, console
from dse.cli.arguments import Design
from dse.cli.asking import ask
from dse.cli.space import Choose, Off, On, Where, space_of

export_app = typer.Typer(
    name="export",
    help="Write a design space for another program.",
    no_args_is_help=True,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(export_app)

Target = Annotated[Path, typer.Option("--output", "-o", metavar="FILE", help="The file to write.")]


@export_app.callback()
def _frame() -> None:
    pass


@export_app.command("uvl")
def export_uvl(design: Design, target: Target, on: On = [], off: Off = []) -> None:
    """Write a design space as a feature model in UVL.

    With the constraints that are on; one that UVL cannot say is refused by name.
    """
    from dse.errors import fail
    from dse.loading.uvl_writer import to_uvl

    space = space_of(design, on, off)
    text = to_uvl(space)
    try:
        target.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise fail(f"cannot write '{target}': {error.strerror}") from error
    console().print(f"{target}: {space.name}", soft_wrap=True)


@export_app.command("csv")
def export_csv(
    design: Design, target: Target, choose: Choose = [], where: Where = None, on: On = [], off: Off = []
) -> None:
    """Write what is chosen in each valid configuration as CSV.

    A line for each configuration: its id, the choice at each place, the sums the constraints speak of.
    """
    from dse.space.output.export import save
    from dse.space.output.sheet import Sheet

    if target.suffix.lower() != ".csv":
        raise typer.BadParameter(f"'{target.name}' must end in .csv", param_hint="--output")
    question = ask(design, choose, where, on, off)
    written = save(Sheet(question.space), question.engine.blocks(), target)
    console().print(f"{target}: {written:,} configuration{'' if written == 1 else 's'}", soft_wrap=True)
