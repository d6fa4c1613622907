"""``dse cache``: what is kept between two commands."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import group
from dse.cli.arguments import Format, Output
from dse.cli.terminal import plain, plain_table, print_json, print_line, print_table, read_size, size_text, status_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dse.cache import Entry

cache_app = group("cache", "Manage the cache that is kept between commands.")


@cache_app.command()
def show(output: Format = Output.TABLE) -> None:
    """Show what the cache holds, how large it is, and when it was used."""
    from dse.cache import cache_folder, left_overs, survey

    root = cache_folder()
    found = survey(root)
    everything = [entry for entries in found.values() for entry in entries]
    left = left_overs(root)
    if output is Output.JSON:
        kinds = [
            {"kind": section.name, "holds": section.holds, **_measures(entries)} for section, entries in found.items()
        ]
        print_json({"folder": str(root), **_measures(everything), "left_over": len(left), "kinds": kinds})
        return
    print_line(str(root), style="bold")
    if not everything:
        print_line("it is empty")
        return
    table = plain_table("kind", "entries", "size", "last used", "what", right=("entries", "size"))
    for section, entries in found.items():
        table.add_row(section.name, f"{len(entries):,}", _size(entries), _span(entries), section.holds)
    table.add_row("in all", f"{len(everything):,}", _size(everything), _span(everything), style="bold")
    print_table(table)
    if left:
        print_line(f"{_counted(len(left), 'folder')} left by processes that have ended: dse cache prune removes them")


@cache_app.command()
def verify() -> None:
    """Check everything in the cache against its digest, and remove damaged entries.

    They are made again when needed. Commands check the entries that they use themselves.
    """
    from dse.cache import cache_folder, damaged, survey, take_out

    root = cache_folder()
    with status_line() as tell:
        number = sum(map(len, survey(root).values()))
        found = damaged(root, lambda section: tell(f"comparing {section.holds}"))
        take_out(entry.path for entry in found)
    for entry in found:
        print_line(f"damaged, removed: {entry.section.name}/{entry.path.name}")
    whole = f"{_counted(number - len(found), 'entry', 'entries')} of {plain(str(root))} are whole"
    print_line(f"{whole}, {len(found):,} removed" if found else whole)


@cache_app.command()
def prune(
    days: Annotated[
        float | None, typer.Option("--days", min=0, help="Remove entries not used for this many days; 90 by default.")
    ] = None,
    size: Annotated[
        str | None,
        typer.Option("--size", metavar="SIZE", help="Remove the least recently used entries, down to '500 MB'."),
    ] = None,
) -> None:
    """Remove entries from the cache that were not used for long, or that ended processes left there.

    Removed entries are made again when needed. Studies that are being explored need the entries that they use.
    """
    import math

    from dse.cache import cache_folder, left_overs, take_out, unused

    root = cache_folder()
    most = math.inf if size is None else read_size(size)
    oldest = days if days is not None else (90.0 if size is None else math.inf)
    with status_line() as tell:
        tell("removing what is not used")
        found, left = unused(root, oldest, most), left_overs(root)
        take_out([*(entry.path for entry in found), *left])
    print_line(f"{_counted(len(found), 'entry', 'entries')} removed, {_size(found)}")
    if left:
        print_line(f"{_counted(len(left), 'folder')} removed that processes left which have ended")


def _measures(entries: Sequence[Entry]) -> dict[str, object]:
    used = [entry.used for entry in entries]
    size = sum(entry.size for entry in entries)
    return {
        "entries": len(entries),
        "size": size,
        "oldest_use": _time(min(used), "%Y-%m-%dT%H:%M:%SZ") if used else None,
        "newest_use": _time(max(used), "%Y-%m-%dT%H:%M:%SZ") if used else None,
    }


def _size(entries: Sequence[Entry]) -> str:
    return size_text(sum(entry.size for entry in entries))


def _span(entries: Sequence[Entry]) -> str:
    first, last = (_time(end(entry.used for entry in entries), "%Y-%m-%d") for end in (min, max))
    return first if first == last else f"{first} to {last}"


def _time(seconds: float, form: str) -> str:
    return time.strftime(form, time.gmtime(seconds))


def _counted(number: int, one: str, more: str = "") -> str:
    return f"{number:,} {one if number == 1 else more or f'{one}s'}"
