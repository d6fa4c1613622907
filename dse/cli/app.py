"""The command line's frame: one typer application."""

from __future__ import annotations

from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from dse.cli.endings import DONE, InterruptedCommandError

_GROUPS = ("space", "import", "export", "udp")


class _Commands(TyperGroup):
    """Lists the groups about design spaces beside ``dse enumerate``; they would come before all commands."""

    def list_commands(self, ctx: Any) -> list[str]:  # a context of the click inside typer
        """The names in the order of the help."""
        names = [name for name in super().list_commands(ctx) if name not in _GROUPS]
        place = names.index("enumerate") + 1 if "enumerate" in names else 0
        return [*names[:place], *(name for name in _GROUPS if name in self.commands), *names[place:]]

    def invoke(self, ctx: Any) -> Any:
        """Run the command. The frameworks below would forget what an interrupt says."""
        try:
            return super().invoke(ctx)
        except KeyboardInterrupt as stop:
            raise InterruptedCommandError(*stop.args) from None


_HELP = {"help_option_names": ["-h", "--help"]}

app = typer.Typer(
    name="dse",
    cls=_Commands,
    help="Design cyber-physical products when the architecture and the numbers are both open.",
    epilog="Start with 'dse init my-study', then 'dse check', 'dse explore', 'dse report'. "
    "Exit codes: 0 done, 1 the files are wrong, 2 usage, 3 some runs failed.",
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings=_HELP,
)


def _show_version(asked: bool) -> None:
    if asked:
        from dse import __version__

        print(f"dse {__version__}")
        raise typer.Exit(DONE)


@app.callback()
def _frame(
    version: Annotated[  # its callback has done the work
        bool, typer.Option("--version", is_eager=True, callback=_show_version, help="Show the version and exit.")
    ] = False,
) -> None:
    pass


def group(name: str, about: str) -> typer.Typer:
    """A group of commands in the application."""
    made = typer.Typer(name=name, help=about, no_args_is_help=True, rich_markup_mode=None, context_settings=_HELP)
    made.callback()(lambda: None)  # a group, also where only one of its commands was imported
    app.add_typer(made)
    return made
