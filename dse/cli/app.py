"""The command line's frame: one typer application."""

from __future__ import annotations

import os
import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from dse.cli.terminal import console

DONE, WRONG_FILES, USAGE, RUNS_FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes: done; the files are wrong; wrong usage; some runs failed, or a requirement under --gate; Ctrl-C."""


_GROUPS = ("space", "import", "export")


class _Commands(TyperGroup):
    """Lists the groups about design spaces beside ``dse enumerate``; they would come before all commands.

    A reader that goes away, as ``head`` does, is no failure. The frameworks below would make it one.
    """

    def list_commands(self, ctx: Any) -> list[str]:  # a context of the click inside typer
        """The names in the order of the help."""
        names = [name for name in super().list_commands(ctx) if name not in _GROUPS]
        place = names.index("enumerate") + 1 if "enumerate" in names else 0
        return [*names[:place], *(name for name in _GROUPS if name in self.commands), *names[place:]]

    def make_context(self, *arguments: Any, **options: Any) -> Any:
        """A context; shows the help and the version on the way."""
        try:
            return super().make_context(*arguments, **options)
        except BrokenPipeError:
            _silence()
            raise typer.Exit(DONE) from None

    def invoke(self, ctx: Any) -> Any:
        """Run the command; what it wrote is handed over before it counts as done."""
        try:
            result = super().invoke(ctx)
            sys.stdout.flush()
        except BrokenPipeError:
            _silence()
            raise typer.Exit(DONE) from None
        except KeyboardInterrupt:
            console(stderr=True).print("stopped")
            raise typer.Exit(INTERRUPTED) from None
        return result


def _silence() -> None:
    """Let nothing be written any more: what is still held back would fail again at the end of the process."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


_HELP = {"help_option_names": ["-h", "--help"]}

app = typer.Typer(
    name="dse",
    cls=_Commands,
    help="Design cyber-physical products when the architecture and the numbers are both open.",
    epilog="Start with 'dse init my-study', then 'dse check', 'dse explore', 'dse report'. "
    "Exit codes: 0 done, 1 the files are wrong, 2 usage, 3 some runs failed.",
    no_args_is_help=True,
    add_completion=False,
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
