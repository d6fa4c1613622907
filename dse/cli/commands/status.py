"""``dse status``."""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from datetime import timedelta
from pathlib import Path
from typing import TYPE_CHECKING

from dse.cli.app import app
from dse.cli.arguments import Folder, Format, Output
from dse.cli.terminal import plain, plain_table, print_json, print_line, print_table, size_text

if TYPE_CHECKING:
    from dse.api import Status

_MOST_CAUSES = 8
_TIME = re.compile(r" at t = [\d.e+-]+ s")


@app.command()
def status(folder: Folder, form: Format = Output.TABLE) -> None:
    """Show the progress of a study.

    Runs, rate, time left, processes at work, failures and their causes, and disk space; also while another process
    explores it.
    """
    from dse.api import status_as_data, statuses

    found = statuses(folder)
    if form is Output.JSON:
        data = [status_as_data(each) for each in found]
        print_json(data[0] if len(data) == 1 else {"shards": data})
    elif len(found) == 1:
        _show(found[0])
    else:
        _show_shards(folder, found)


def _show(status: Status) -> None:
    tally, todo = status.tally, status.runs - status.tally.finished
    print_line(f"{status.folder}: {status.name}, {status.state}", style="bold")
    table = plain_table("what", "is", header=False)
    share = f" ({math.floor(100 * tally.finished / status.runs)} %)" if todo and status.runs else ""
    kept = f", {tally.kept:,} with waveforms" if tally.kept else ""
    failed = f", {tally.failed:,} failed" if tally.failed else ""
    table.add_row("runs", f"{tally.finished:,} of {status.runs:,}{share}{failed}{kept}")
    if status.writer:
        table.add_row("writer", plain(str(status.writer)))
        left = "" if status.is_shard else _left(status.left)
        table.add_row("rate", f"{status.rate:.3g} runs/s{left}" if status.rate else "no run has ended yet")
    elif status.state == "interrupted":
        logged = f"; {status.logged:,} more are made and will be stored then" if status.logged else ""
        table.add_row("resume", f"with the command that started it{logged}")
    if tally.repeated:
        table.add_row("tried again", f"{_counted(tally.repeated, 'run')}, as a try gave no result")
    if tally.again:
        table.add_row("made again", f"{_counted(tally.again, 'run')}, for waveforms or a comparison")
    table.add_row("disk", f"{size_text(status.size)} in this folder, {size_text(status.free)} free")
    print_table(table)
    _show_hosts(status)
    _show_causes("failed:", tally.failures)
    _show_causes("tries without a result:", tally.tries)


def _show_shards(folder: Path, shards: Sequence[Status]) -> None:
    from dse.api import seconds_left

    finished, runs = sum(each.tally.finished for each in shards), shards[0].runs
    print_line(f"{folder}: {shards[0].name}, {finished:,} of {runs:,} runs in {len(shards)} shards", style="bold")
    table = plain_table("shard", "is", "runs", "failed", "without result", "runs/s", right=_NUMBERS)
    for each in shards:
        counts = (each.tally.finished, each.tally.failed, sum(each.tally.tries.values()))
        speed = f"{each.rate:.3g}" if each.rate else ""
        table.add_row(each.folder.name, each.state, *(f"{count:,}" for count in counts), speed)
    print_table(table)
    rate = sum(each.rate for each in shards)
    if rate:
        print_line(f"{rate:.3g} runs/s{_left(seconds_left(shards))}")
    for title, causes in ("failed:", "failures"), ("tries without a result:", "tries"):
        together: Counter[str] = Counter()
        for each in shards:
            together.update(getattr(each.tally, causes))
        _show_causes(title, together)


def _left(seconds: float) -> str:
    return f", about {timedelta(seconds=math.ceil(seconds))} left" if 0 < seconds < math.inf else ""


def _show_hosts(status: Status) -> None:
    makers = [maker for maker in status.tally.makers if maker.host]
    if not makers:
        return
    table = plain_table("host", "at work", "processes", "runs", "without result", "s per run", right=_NUMBERS)
    for host in sorted({maker.host for maker in makers}):
        here = [maker for maker in makers if maker.host == host]
        seconds = [maker.seconds for maker in here if math.isfinite(maker.seconds)]
        counts = (
            sum(m in status.working for m in here),
            len(here),
            sum(m.runs for m in here),
            sum(m.tries for m in here),
        )
        typical = f"{sum(seconds) / len(seconds):.3g}" if seconds else ""
        table.add_row(plain(host), *(f"{count:,}" for count in counts), typical)
    print_table(table)


_NUMBERS = ("at work", "processes", "runs", "failed", "without result", "s per run", "runs/s")


def _show_causes(title: str, causes: Mapping[str, int]) -> None:
    """The most frequent ones; when in a run it happened makes no other cause."""
    counts: Counter[str] = Counter()
    for cause, count in causes.items():
        counts[_TIME.sub("", cause).partition("\n")[0]] += count
    if counts:
        print_line(title)
    for cause, count in counts.most_common(_MOST_CAUSES):
        print_line(f"  {count:,} × {cause}")
    if len(counts) > _MOST_CAUSES:
        print_line(f"  and {len(counts) - _MOST_CAUSES} other causes")


def _counted(number: int, what: str) -> str:
    return f"{number:,} {what}{'' if number == 1 else 's'}"
