"""``dse space``: questions about a design space; and what its commands share with ``dse enumerate``."""

from __future__ import annotations

from typing import Annotated

import typer

from dse.cli.app import app

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


def _condition(text: str | None) -> str | None:
    """Refuse an empty condition: a variable of a script may be unset."""
    if text is not None and not text.strip():
        raise typer.BadParameter("the condition is empty", param_hint="--where")
    return text


Where = Annotated[
    str | None,
    typer.Option(
        "--where",
        metavar="CONDITION",
        callback=_condition,
        help="Only those that meet it, as 'sensor is lidar_905nm'.",
    ),
]
Choose = Annotated[
    list[str],
    typer.Option("--choose", metavar="PLACE=CHOICE", help="What is chosen where, as 'sensor=lidar_905nm'."),
]
Seed = Annotated[int, typer.Option("--seed", min=0, help="Where random draws start; the same seed, the same draws.")]


@space_app.callback()
def _frame() -> None:
    pass
