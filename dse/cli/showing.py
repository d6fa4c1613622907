"""One run on the terminal, and its figures as a file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from dse.cli.app import console, plain, print_json, print_table
from dse.cli.arguments import Output
from dse.cli.tables import metric_table, run_data

if TYPE_CHECKING:
    from dse.api.studies.run import Run


def present_run(run: Run, output: Output, plot: Path | None) -> None:
    """Print the run for a person or for a program, and draw its figures if a file for them is given."""
    if output is Output.JSON:
        print_json(run_data(run.noun))
    else:
        show_run(run)
    if plot is not None:
        draw_run(run, plot)


def show_run(run: Run) -> None:
    """The configuration, the point, and every metric with its verdicts."""
    screen = console()
    chosen = ", ".join(f"{place} {choice}" for place, choice in run.choices.items())
    screen.print(plain(run.definition.title), style="bold")
    screen.print(f"configuration {run.configuration}{f': {chosen}' if chosen else ''}", soft_wrap=True)
    if run.problem and not run.is_done:
        screen.print(plain(f"failed to run: {run.problem}"), style="bold red", soft_wrap=True)
    elif run.problem:
        screen.print(plain(run.problem), style="yellow", soft_wrap=True)
    print_table(metric_table(run.noun, run.definition))


def draw_run(run: Run, target: Path) -> None:
    """Draw the bench's figures for *run* into *target*; nothing is drawn for a run that failed."""
    from dse.report.figures import waveforms

    if not run.has_waveforms:
        console(stderr=True).print(f"{target}: not drawn, the run has no waveforms")
        return
    waveforms.draw_run(run.noun, run.definition, target)
    console().print(f"figures: {target}", soft_wrap=True)
