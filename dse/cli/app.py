"""The command line's frame: one typer application, problems shown the same way everywhere."""

from __future__ import annotations

import math
import os
import sys
import unicodedata
from typing import TYPE_CHECKING, Annotated, Any

import typer
from typer.core import TyperGroup

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from dse.errors import DseError

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
    context_settings={"help_option_names": ["-h", "--help"]},
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


def show_problems(error: DseError) -> None:
    """Print every problem to standard error, then how many there are."""
    from rich.text import Text

    screen = console(stderr=True)
    for problem in error.problems:
        line = Text()
        if problem.where:
            line.append(plain(f"{problem.where}: "), style="bold")
        line.append(plain(problem.what), style="red")
        screen.print(line, soft_wrap=True)
        if problem.hint:
            screen.print(Text(plain(f"    hint: {problem.hint}")), soft_wrap=True)
    if len(error.problems) > 1:
        screen.print(Text(f"{len(error.problems)} problems"), soft_wrap=True)


def plain(text: str) -> str:
    """*text* without control characters: what an FMU logs or calls itself must not steer the terminal."""
    return "".join("\N{REPLACEMENT CHARACTER}" if _steers(character) else character for character in text)


def _steers(character: str) -> bool:
    return character != "\n" and unicodedata.category(character) in ("Cc", "Cf", "Cs")


def console(*, stderr: bool = False) -> Console:
    """A rich console that never guesses at highlights or markup in the user's words."""
    from rich.console import Console

    class Screen(Console):
        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    return Screen(stderr=stderr, highlight=False, markup=False, emoji=False)


def print_table(table: Table) -> None:
    """A table in full: a narrow terminal wraps its lines, nothing is cut off."""
    screen = console()
    screen.width = max(screen.width, screen.measure(table, options=screen.options.update(max_width=10_000)).maximum)
    screen.print(table, soft_wrap=True)


def print_json(data: object) -> None:
    """One JSON document on standard output; NaN becomes null, infinities the strings "inf" and "-inf"."""
    import json

    # Large spaces have counts of more digits than the interpreter writes by itself.
    sys.set_int_max_str_digits(0)
    sys.stdout.write(json.dumps(_plain(data), ensure_ascii=False, indent=2, allow_nan=False) + "\n")


def _plain(data: object) -> object:
    if isinstance(data, float) and not math.isfinite(data):
        return None if math.isnan(data) else str(data)
    if isinstance(data, dict):
        return {str(key): _plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_plain(value) for value in data]
    return data
