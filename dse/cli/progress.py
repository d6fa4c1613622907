"""The progress bar of a study, and a line that says what is being waited for."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from dse.cli.app import console, plain

if TYPE_CHECKING:
    from rich.progress import TaskID

    from dse.exploration.progress import Progress


@contextmanager
def progress_bar() -> Iterator[Callable[[Progress], None]]:
    """Shows done of total, rate, time left and failures on standard error while the context lasts."""
    from rich import progress as columns

    bar = columns.Progress(
        columns.TextColumn("{task.description}"),
        columns.BarColumn(bar_width=20),
        columns.MofNCompleteColumn(),
        columns.TextColumn("{task.fields[rate]}"),
        columns.TimeElapsedColumn(),
        columns.TimeRemainingColumn(),
        columns.TextColumn("{task.fields[failed]}"),
        console=console(stderr=True),
        refresh_per_second=5,
    )
    tasks: dict[str, TaskID] = {}

    def show(progress: Progress) -> None:
        stage = str(progress.stage)
        if stage not in tasks:
            for earlier in tasks.values():
                bar.update(earlier, completed=bar.tasks[earlier].total)
            tasks[stage] = bar.add_task(stage, total=progress.total, rate="", failed="")
        rate = f"{progress.rate:,.0f} runs/s" if progress.rate else ""
        failed = f"{progress.failed} failed" if progress.failed else ""
        bar.update(tasks[stage], completed=progress.done, total=progress.total, rate=rate, failed=failed)

    with bar:
        yield show


_PATIENCE = 1.0
"""Seconds before a line says what is being waited for."""


@contextmanager
def status_line() -> Iterator[Callable[[str], None]]:
    """Shows the text it was last given on a terminal's standard error, once the context has lasted a second."""
    screen = console(stderr=True)
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
