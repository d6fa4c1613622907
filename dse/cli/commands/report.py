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
MostWaveforms = Annotated[int, typer.Option("--waveforms", min=0, help="Most runs whose waveforms go into the page.")]


@app.command()
def report(
    folder: Folder,
    target: ReportFile = None,
    waveforms: MostWaveforms = 4000,
) -> None:
    """Write the HTML report of a study.

    One page that works offline: constraint plot, thresholds, waveforms, run table.

    Reads only the study folder; nothing is simulated.
    """
    from dse.api import Results
    from dse.errors import DseError, Problem

    results = Results(folder)
    problems: list[Problem] = []
    with status_line() as tell:
        tell(f"reading {len(results)} runs, drawing the page")
        page = results.report(target, waveforms=waveforms, on_problems=problems.extend)
    if problems:
        show_problems(DseError(*problems))
    say(f"{page}: {len(results)} runs, {page.stat().st_size / 1e6:.1f} MB")
