"""``dse space choices``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dse.api import opened
from dse.cli.arguments import Choose, Design, Format, Off, On, Output, Seed, Where
from dse.cli.commands.space import space_app
from dse.cli.terminal import plain_table, print_json, print_line, print_table
from dse.errors import DseError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table
    from rich.text import Text

    from dse.space import Occurrence

_BAR = 20
_LONGEST = 32
_LEAST = 0.0005
"""A share below is shown as 0.0 %, which it is not."""


@space_app.command("choices")
def space_choices(
    design: Design,
    choose: Choose = [],
    where: Where = None,
    on: On = [],
    off: Off = [],
    seed: Seed = 0,
    output: Format = Output.TABLE,
) -> None:
    """Show how often each alternative occurs in the valid configurations.

    Lists dead alternatives, which no valid configuration has, and forced ones, which all have.
    """
    part = opened(design, choose, where, on, off)
    try:
        found = part.occurrences(seed)
    except DseError:
        if part.options and part.is_empty():
            raise part.nothing() from None
        raise
    if output is Output.JSON:
        print_json({**part.data(), "choices": [_data(entry) for entry in found]})
        return
    if not found:
        print_line(f"{part.title()}: there is nothing to choose")
        return
    print_table(_table(found))
    if any(entry.half_width for entry in found):
        print_line("≈ is an estimate from uniform draws, ± its 95 % interval")


def _table(found: Sequence[Occurrence]) -> Table:
    """Places as the first column, or as lines of their own where some are long."""

    aside = max(len(entry.path) for entry in found) <= _LONGEST
    table = plain_table(*(("place",) if aside else ()), "choice", "share", "", right=("share",))
    last = ""
    for entry in found:
        cells = (entry.choice or "absent", _share(entry), _mark(entry))
        if aside:
            table.add_row(entry.path if entry.path != last else "", *cells)
        else:
            if entry.path != last:
                table.add_row(entry.path)
            table.add_row(f"    {cells[0]}", *cells[1:])
        last = entry.path
    return table


def _share(entry: Occurrence) -> str:
    if entry.dead or entry.forced:
        return f"{100 * entry.share:.1f} %"
    if entry.half_width:
        return f"≈ {100 * entry.share:.1f} ± {100 * entry.half_width:.1f} %"
    if entry.share < _LEAST:
        return "< 0.1 %"
    if entry.share > 1 - _LEAST:
        return "> 99.9 %"
    return f"{100 * entry.share:.1f} %"


def _mark(entry: Occurrence) -> Text:
    from rich.text import Text

    if entry.dead:
        return Text("dead", style="red")
    if entry.forced:
        return Text("forced", style="yellow")
    return Text("█" * max(round(_BAR * entry.share), 1), style="cyan")


def _data(entry: Occurrence) -> dict[str, object]:
    return {
        "place": entry.path,
        "choice": entry.choice,
        "share": entry.share,
        "half_width": entry.half_width,
        "exact": not entry.half_width,
        "dead": entry.dead,
        "forced": entry.forced,
    }
