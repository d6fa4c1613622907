"""What commands print with: problems, lines, tables and JSON, shown the same way everywhere."""

from __future__ import annotations

import math
import re
import sys
import unicodedata
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import contextmanager
from itertools import groupby
from typing import TYPE_CHECKING

from dse.cli import streams

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table

    from dse.analysis import Finding
    from dse.errors import DseError

_MOST_NOTES = 5


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

    streams.record.has_notes |= stderr
    return Console(stderr=stderr, highlight=False, markup=False, emoji=False)


def print_line(text: str, *, style: str | None = None, stderr: bool = False) -> None:
    """A line as it is, however narrow the terminal; control characters in it are shown as such."""
    console(stderr=stderr).print(plain(text), style=style, soft_wrap=True)


def show_page(address: str) -> None:
    """Open *address* in the browser of this machine, if it has one."""
    import webbrowser

    if not webbrowser.open(address):
        print_line(f"no browser could be started here; open {address} in one", stderr=True)


def print_some(kind: str, told: Sequence[object]) -> None:
    """The first of *told*, each as a line that begins with *kind*, and how many there are besides."""
    for one in told[:_MOST_NOTES]:
        print_line(f"{kind}: {one}", stderr=True)
    if len(told) > _MOST_NOTES:
        print_line(f"{kind}: and {len(told) - _MOST_NOTES} more", stderr=True)


def plain_table(*headings: str, right: Collection[str] = (), header: bool = True) -> Table:
    """A table without lines; the columns of the headings *right* are aligned to that side."""
    from rich.table import Table

    table = Table(box=None, pad_edge=False, show_header=header, header_style="bold")
    for heading in headings:
        table.add_column(heading, justify="right" if heading in right else "left")
    return table


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
    sys.stdout.write(json.dumps(plain_data(data), ensure_ascii=False, indent=2, allow_nan=False) + "\n")


def plain_data(data: object) -> object:
    """*data* for a JSON document: NaN becomes None, infinities texts, tuples lists, and all keys texts."""
    if isinstance(data, float) and not math.isfinite(data):
        return None if math.isnan(data) else str(data)
    if isinstance(data, dict):
        return {str(key): plain_data(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [plain_data(value) for value in data]
    return data


# A line that says what is being waited for.


_PATIENCE = 1.0
"""Seconds before a line says what is being waited for."""


@contextmanager
def status_line() -> Iterator[Callable[[str], None]]:
    """Shows the text it was last given on a terminal's standard error, once the context has lasted a second."""
    has_notes = streams.record.has_notes
    screen = console(stderr=True)
    streams.record.has_notes = has_notes  # progress is not one
    if not screen.is_terminal:
        yield lambda _: None
        return
    from threading import Timer

    from rich.text import Text

    status = screen.status("")
    late = Timer(_PATIENCE, status.start)
    late.start()
    try:
        yield lambda text: status.update(Text(plain(text)))
    finally:
        late.cancel()
        late.join()
        status.stop()


# Amounts of memory, as people read and write them.


_SIZES = {"TB": 1e12, "GB": 1e9, "MB": 1e6, "kB": 1e3, "B": 1.0}


def size_text(number: float) -> str:
    """So many bytes, to three digits."""
    for unit, size in _SIZES.items():
        if number >= size:
            return f"{number / size:.3g} {unit}"
    return f"{number:.0f} B"


def read_size(text: str) -> float:
    """The bytes that *text* means (``500 MB``). Raises BadParameter."""
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([kMGT]?B)\s*", text)
    if found is None:
        import typer

        raise typer.BadParameter(f"'{text}' is not an amount of memory; write it as '500 MB'")
    return float(found[1]) * _SIZES[found[2]]


def print_findings(found: Sequence[Finding]) -> None:
    """What was found, line by line, under what it is about."""
    for plane, those in groupby(found, lambda each: each.plane):
        if plane:
            print_line(f"varied: {', '.join(plane)}; all else held", style="bold")
        for topic, some in groupby(those, lambda each: each.topic):
            print_line(f"{topic}:", style="bold")
            for each in some:
                print_line(f"  {each.text}")
