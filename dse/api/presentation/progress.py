"""The progress bar of a study, and a line that says what is being waited for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from math import ceil
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console
    from rich.progress import TaskID

    from dse.exploration import Progress


_MOST_LEFT = 1e8
"""Seconds: a longer time left is not shown."""


@contextmanager
def progress_shown(progress: Callable[[Progress], None] | bool | None) -> Iterator[Callable[[Progress], None] | None]:
    """What is to be told of progress: *progress* itself, or a bar if it is True."""
    if progress is True:
        with progress_bar() as show:
            yield show
    else:
        yield progress or None


@contextmanager
def progress_bar(console: Console | None = None) -> Iterator[Callable[[Progress], None]]:
    """Shows done of total, rate, time left and failures on *console*, or standard error, while the context lasts."""
    from rich import progress as columns
    from rich.console import Console

    screen = console or Console(stderr=True)
    bar = columns.Progress(
        columns.TextColumn("{task.description}"),
        columns.BarColumn(bar_width=20),
        columns.MofNCompleteColumn(),
        columns.TextColumn("{task.fields[rate]}"),
        columns.TimeElapsedColumn(),
        columns.TextColumn("{task.fields[left]}"),
        columns.TextColumn("{task.fields[failed]}"),
        console=screen,
        refresh_per_second=5,
        # By a thread, of no use where nobody looks on: starting one that finds no memory would not come to an end.
        auto_refresh=screen.is_terminal or screen.is_jupyter,
    )
    tasks: dict[str, TaskID] = {}

    def show(progress: Progress) -> None:
        stage = str(progress.stage)
        if not tasks:
            bar.start()  # not before: what goes wrong until then is not said below an empty bar
        if stage not in tasks:
            for earlier in tasks.values():
                bar.update(earlier, completed=bar.tasks[earlier].total)
            tasks[stage] = bar.add_task(stage, total=progress.total, rate="", left="", failed="")
        rate = f"{progress.rate:,.0f} runs/s" if progress.rate else ""
        left = f"about {timedelta(seconds=ceil(progress.left))} left" if 0 < progress.left < _MOST_LEFT else ""
        failed = f"{progress.failed} failed" if progress.failed else ""
        bar.update(tasks[stage], completed=progress.done, total=progress.total, rate=rate, left=left, failed=failed)

    try:
        yield show
    finally:
        if tasks:
            bar.stop()
