"""``dse report``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Folder
from dse.cli.status import status_line
from dse.cli.terminal import say, show_problems

ReportFile = Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE", help="Default: DIR/report.html.")]
PdfFile = Annotated[
    Path | None,
    typer.Option("--pdf", metavar="FILE", help="Print it into a PDF file instead, by a Chromium of this machine."),
]
ReplayedRun = Annotated[
    int | None,
    typer.Option("--replay", metavar="RUN", min=0, help="Drive this run again, in DIR/run_RUN.html."),
]
MostWaveforms = Annotated[int, typer.Option("--waveforms", min=0, help="Most runs whose waveforms go into the page.")]


@app.command()
def report(
    folder: Folder,
    target: ReportFile = None,
    pdf: PdfFile = None,
    waveforms: MostWaveforms = 4000,
    replay: ReplayedRun = None,
) -> None:
    """Write the HTML report of a study, print it (--pdf), or show one run in three dimensions (--replay).

    One page that works offline: constraint plot, thresholds, waveforms, run table.

    Reads only the study folder; nothing is simulated but the run of --replay, once more.
    """
    from dse.api import Results
    from dse.errors import DseError, Problem

    results = Results(folder)
    if replay is not None:
        if pdf:
            raise typer.BadParameter("a replay is not printed", param_hint="--pdf")
        with status_line() as tell:
            page = results.write_scene(replay, target or folder / f"run_{replay}.html", tell=tell)
        say(f"{page}: run {replay}, {page.stat().st_size / 1e6:.1f} MB")
        return
    problems: list[Problem] = []
    made: list[Path] = []
    with status_line() as tell:
        if target or not pdf:
            tell(f"reading {len(results)} runs, drawing the page")
            made.append(results.report(target, waveforms=waveforms, on_problems=problems.extend))
        if pdf:
            tell(f"reading {len(results)} runs, printing the page")
            made.append(results.print(pdf, waveforms=waveforms, on_problems=problems.extend))
    if problems:
        show_problems(DseError(*problems))
    for page in made:
        say(f"{page}: {len(results)} runs, {page.stat().st_size / 1e6:.1f} MB")
