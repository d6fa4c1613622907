"""``dse report``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app, console, show_problems
from dse.cli.arguments import Folder

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
    from dse.errors import DseError
    from dse.report.page import write_report
    from dse.report.study import read_content
    from dse.results.folder import StudyFolder

    page = target or folder / "report.html"
    with StudyFolder.open(folder) as store:
        content = read_content(store, shown_as=folder.as_posix(), most=waveforms)
    if problems := write_report(content, page):
        show_problems(DseError(*problems))
    console().print(f"{page}: {len(content.runs)} runs, {page.stat().st_size / 1e6:.1f} MB", soft_wrap=True)
