"""What `run`, `explore`, `simulate` and `replay` share: telling the terminal how far it is, and what came of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from dse.cli.app import DONE, INTERRUPTED, RUNS_FAILED, console, plain

if TYPE_CHECKING:
    from dse.api.exploring import Explored
    from dse.api.results import Results, Summary
    from dse.domain.study import Study
    from dse.testbench.study import PreparedStudy

_MOST_PROBLEMS = 5


def explore_into(
    study: Study, folder: Path, *, workers: int, threads: int, version: int, fuse: bool, fresh: bool, gate: bool
) -> None:
    """Explore *study* into *folder* with a progress bar, say what came of it, and exit as it deserves."""
    from dse.api import exploring
    from dse.api.progress import progress_bar
    from dse.api.results import Results

    planned = ready(study, version, fuse=fuse)
    try:
        with progress_bar(console(stderr=True)) as show:
            explored = exploring.explore_into(
                planned, folder, workers=workers, threads=threads, fresh=fresh, on_progress=show
            )
    except exploring.ExplorationInterruptedError as stop:
        console(stderr=True).print(f"{folder}: {stop}", soft_wrap=True)
        raise typer.Exit(INTERRUPTED) from None
    results = Results(folder, explored)
    summary = results.summary
    _say(results, summary, explored)
    failed = summary.failed or (gate and not summary.is_passed)
    raise typer.Exit(RUNS_FAILED if failed else DONE)


def ready(study: Study, version: int, *, fuse: bool = False) -> PreparedStudy:
    """*study* with all that has to be built for it, the terminal told what is going on. Raises DseError."""
    from dse.api.exploring import ready as made_ready

    with console(stderr=True).status("building FMUs, assembling configurations") as status:
        return made_ready(study, version=version, fuse=fuse, tell=status.update)


def _say(results: Results, summary: Summary, explored: Explored) -> None:
    from rich.table import Table

    from dse.api.described import labels

    screen, folder = console(), results.folder
    what = f"{summary.finished} runs, {explored.new} of them new"
    if not explored.new:
        what = f"all {summary.finished} runs were there"
    if explored.again:
        what += f", {explored.again} made again for their waveforms"
    if explored.extended:
        what += f"; the study was extended, its {explored.before} runs are kept"
    screen.print(f"{folder}: {what}", soft_wrap=True)
    if summary.verdicts:
        named = labels(results.definition)
        shown = Table(box=None, pad_edge=False, header_style="bold")
        shown.add_column("requirement")
        for verdict in next(iter(summary.verdicts.values())):
            shown.add_column(verdict, justify="right")
        for name, count in summary.verdicts.items():
            shown.add_row(named[name], *(str(number) for number in count.values()))
        screen.print(shown)
    said: dict[str, str] = {}
    for number, problem in summary.problems.items():
        failed = "failed: " if number in summary.failures else ""
        said.setdefault(problem, f"  run {number} {failed}{plain(problem)}")
    for line in list(said.values())[:_MOST_PROBLEMS]:
        screen.print(line, soft_wrap=True)
    if len(said) > _MOST_PROBLEMS:
        screen.print(f"  and {len(said) - _MOST_PROBLEMS} other problems: dse results {folder}", soft_wrap=True)
    screen.print(f"next: dse report {folder}", soft_wrap=True)
