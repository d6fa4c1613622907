"""``dse space``: questions about a design space; and what its commands share with ``dse enumerate``."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import workspace_of

if TYPE_CHECKING:
    from dse.domain.design import DesignSpace
    from dse.domain.expression import Expression

space_app = typer.Typer(
    name="space",
    help="Ask about a design space.",
    no_args_is_help=True,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)
app.add_typer(space_app)

On = Annotated[list[str], typer.Option("--on", metavar="SET", help="Switch a constraint set on.")]
Off = Annotated[list[str], typer.Option("--off", metavar="SET", help="Switch a constraint set off.")]
Where = Annotated[
    str | None,
    typer.Option("--where", metavar="CONDITION", help="Only those that meet it, as 'sensor is lidar_905nm'."),
]
Choose = Annotated[
    list[str],
    typer.Option("--choose", metavar="PLACE=CHOICE", help="What is chosen where, as 'sensor=lidar_905nm'."),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Where random draws start; the same seed, the same draws.")]


@space_app.callback()
def _frame() -> None:
    pass


def space_of(design: str, on: list[str], off: list[str]) -> DesignSpace:
    """The design space called *design*, checked, with constraint sets switched; a ``.uvl`` file is a feature model.

    Raises DseError with all problems.
    """
    from pathlib import Path

    from dse.errors import DseError
    from dse.space.check import check
    from dse.space.switch import switched

    path = Path(design)
    if path.suffix.lower() == ".uvl":
        from dse.loading.uvl import read_uvl

        space = read_uvl(path)
    else:
        space = workspace_of(design).design(design)
    problems = check(space)
    if problems:
        raise DseError(*problems)
    return switched(space, on, off)


def condition_of(text: str | None) -> Expression | None:
    """The condition of --where; its problems are located in the text of the option. Raises DseError.

    An empty one is wrong usage: a variable of a script may be unset.
    """
    from dse.errors import Location
    from dse.loading.expression import parse_expression

    if text is None:
        return None
    if not text.strip():
        raise typer.BadParameter("the condition is empty", param_hint="--where")
    return parse_expression(text, Location("--where", 1, 1))
