"""``dse import``: design spaces from other programs' files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app, console

if TYPE_CHECKING:
    from dse.domain.design import DesignSpace

import_app = typer.Typer(
    name="import",
    help="Read a design space from another program's file.",
    no_args_is_help=True,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(import_app)


@import_app.callback()
def _frame() -> None:
    pass


@import_app.command("uvl")
def import_uvl(
    model: Annotated[Path, typer.Argument(metavar="FILE", help="A feature model in UVL.")],
    folder: Annotated[
        Path, typer.Option("--output", "-o", metavar="DIR", help="The workspace to write to; made if it is new.")
    ] = Path(),
) -> None:
    """Make a design space of a UVL feature model.

    Its tree goes to DIR/designs, its features' attributes to DIR/components, each as a file called after the model.
    """
    from dse.loading.uvl import read_uvl

    space = read_uvl(model)
    files = _files(space, folder)
    for path, text in files.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
        console().print(str(path), soft_wrap=True)
    console().print(f"next: dse space count {space.name}", soft_wrap=True)


def _files(space: DesignSpace, folder: Path) -> dict[Path, str]:
    """What to write, by path. Raises DseError if one of the files is there already."""
    from dse.errors import Location, Problem, raise_if_any
    from dse.loading.design_writer import write_components, write_design
    from dse.space.decisions import sites

    components = {site.name: site.component for site in sites(space) if site.component}
    files = {
        folder / "components" / f"{space.name}.yaml": write_components(components.values()),
        folder / "designs" / f"{space.name}.yaml": write_design(space),
    }
    raise_if_any(
        Problem("the file is there already", Location(str(path)), "move it away; nothing is overwritten")
        for path in files
        if path.exists()
    )
    return files
