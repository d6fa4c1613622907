"""The command line's frame: one typer application, problems shown the same way everywhere."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import typer

from dse.errors import DseError

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

DONE, WRONG_FILES, USAGE, RUNS_FAILED, INTERRUPTED = 0, 1, 2, 3, 130
"""Exit codes: done; the files are wrong; wrong usage; some runs failed, or a requirement under --gate; Ctrl-C."""

app = typer.Typer(
    name="dse",
    help="Design cyber-physical products when the architecture and the numbers are both open.",
    epilog="Start with 'dse init my-study', then 'dse check', 'dse explore', 'dse report'. "
    "Exit codes: 0 done, 1 the files are wrong, 2 usage, 3 some runs failed.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def main() -> None:
    """Run the command line; the console script ``dse``."""
    for stream in (sys.stdout, sys.stderr):
        # Windows and the C locale would refuse × and …; files and pipes are UTF-8 everywhere.
        if hasattr(stream, "reconfigure") and (stream.encoding or "").lower() != "utf-8":
            stream.reconfigure(encoding="utf-8")
    from dse.cli import commands

    commands.register()
    try:
        app()
    except DseError as error:
        show_problems(error)
        sys.exit(WRONG_FILES)
    except BrokenPipeError:
        # The reader of our output (head, less) has seen enough.
        sys.stderr.close()
        sys.exit(DONE)
    except KeyboardInterrupt as stop:
        # An interrupted exploration says what is stored and how to go on.
        console(stderr=True).print(str(stop) or "stopped", soft_wrap=True)
        sys.exit(INTERRUPTED)


def show_problems(error: DseError) -> None:
    """Print every problem to standard error, then how many there are."""
    from rich.text import Text

    screen = console(stderr=True)
    for problem in error.problems:
        line = Text()
        if problem.where:
            line.append(f"{problem.where}: ", style="bold")
        line.append(problem.what, style="red")
        screen.print(line, soft_wrap=True)
        if problem.hint:
            screen.print(Text(f"    hint: {problem.hint}"), soft_wrap=True)
    if len(error.problems) > 1:
        screen.print(Text(f"{len(error.problems)} problems"), soft_wrap=True)


def console(*, stderr: bool = False) -> Console:
    """A rich console that never guesses at highlights or markup in the user's words."""
    from rich.console import Console

    return Console(stderr=stderr, highlight=False, markup=False, emoji=False)


def print_table(table: Table) -> None:
    """A table in full: a narrow terminal wraps its lines, nothing is cut off."""
    screen = console()
    screen.width = max(screen.width, screen.measure(table, options=screen.options.update(max_width=10_000)).maximum)
    screen.print(table, soft_wrap=True)


def print_json(data: object) -> None:
    """One JSON document on standard output; NaN and infinities become null, as JSON has neither."""
    import json

    sys.stdout.write(json.dumps(_finite(data), ensure_ascii=False, indent=2, allow_nan=False) + "\n")


def _finite(data: object) -> object:
    if isinstance(data, float):
        return data if data - data == 0.0 else None
    if isinstance(data, dict):
        return {str(key): _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return data
