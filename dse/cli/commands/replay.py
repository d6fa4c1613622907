"""``dse replay``."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import SI, FmiVersion, Folder, Format, Output, Plot, units_word
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import console, print_line


@app.command()
def replay(
    folder: Folder,
    number: Annotated[int, typer.Argument(metavar="RUN", help="A run's number.", min=0)],
    plot: Plot = None,
    output: Format = Output.TABLE,
    version: FmiVersion = 2,
    source: Annotated[
        Path | None, typer.Option("--source", help="The study's or bench's YAML file, if it is not in this workspace.")
    ] = None,
    si: SI = False,
) -> None:
    """Simulate a run of a study again and compare.

    Reads the workspace, simulates the run again and checks that it gives the same metrics, verdicts and waveforms.

    Shows its metrics; with --plot draws its waveforms even if the study did not keep them.
    """
    from dse.api import Results, replay as replayed
    from dse.cli.runs import present_run

    stored = Results(folder).run(number)
    with console(stderr=True).status("") as status:
        found = replayed(stored, source=source, fmi=version, tell=status.update, on_changed=_show_changed)
    present_run(found.run, output, plot, units_word(si))
    problem = found.problem(str(folder))
    if problem:
        raise problem
    kept = found.stored.has_waveforms
    what = "metrics, verdicts and waveforms" if kept else "metrics and verdicts; no waveforms were kept"
    print_line(f"run {number}: the same as in {folder}, bit for bit ({what})", stderr=True)
    raise typer.Exit(DONE if found.run.is_done else RUNS_FAILED)


def _show_changed(changed: tuple[str, ...]) -> None:
    print_line(f"changed since the study was made: {', '.join(changed)}", stderr=True)
