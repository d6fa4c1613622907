"""What `run` and `explore` share: telling the terminal how far it is, and what came of it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import typer

from dse.cli.app import DONE, RUNS_FAILED
from dse.cli.terminal import console, plain, plain_table, print_table

if TYPE_CHECKING:
    from dse.api import Explored, ExploreOptions, Progress, Results, Summary
    from dse.domain.study import Study

_MOST_PROBLEMS = 5


def explore_and_show(study: Study, folder: Path, options: ExploreOptions, *, gate: bool) -> None:
    """Explore *study* into *folder* with a progress bar, say what came of it, and exit as it deserves."""
    from dse.api import ExplorationInterruptedError, Results, explore_into, progress_bar

    screen = console(stderr=True)
    try:
        with screen.status("") as status, progress_bar(screen) as show:

            def advance(progress: Progress) -> None:
                status.stop()
                show(progress)

            explored = explore_into(study, folder, options, on_progress=advance, tell=status.update)
    except ExplorationInterruptedError as stop:
        raise KeyboardInterrupt(f"{folder}: {stop}") from None
    results = Results(folder, explored)
    summary = results.summary
    _say(results, summary, explored)
    failed = summary.failed or (gate and not summary.is_passed)
    raise typer.Exit(RUNS_FAILED if failed else DONE)


def _say(results: Results, summary: Summary, explored: Explored) -> None:

    from dse.api import requirement_labels

    screen, folder = console(), results.folder
    what = f"{summary.finished} runs, {explored.new} of them new"
    if not explored.new:
        what = f"all {summary.finished} runs were there"
    if explored.again:
        what += f", {explored.again} made again for their waveforms"
    if explored.extended:
        what += f"; the study was extended, its {explored.before} runs are kept"
    screen.print(f"{folder}: {what}", soft_wrap=True)
    for remark in explored.remarks:
        screen.print(f"  {plain(remark)}", soft_wrap=True)
    if summary.verdicts:
        named = requirement_labels(results.definition)
        verdicts = tuple(next(iter(summary.verdicts.values())))
        shown = plain_table("requirement", *verdicts, right=verdicts)
        for name, count in summary.verdicts.items():
            shown.add_row(named[name], *(str(number) for number in count.values()))
        print_table(shown)
    said: dict[str, str] = {}
    for number, problem in summary.problems.items():
        failed = "failed: " if number in summary.failures else ""
        said.setdefault(problem, f"  run {number} {failed}{plain(problem)}")
    for line in list(said.values())[:_MOST_PROBLEMS]:
        screen.print(line, soft_wrap=True)
    if len(said) > _MOST_PROBLEMS:
        screen.print(f"  and {len(said) - _MOST_PROBLEMS} other problems: dse results {folder}", soft_wrap=True)
    screen.print(f"next: dse report {folder}", soft_wrap=True)
