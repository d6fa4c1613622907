"""``dse report``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import Folder
from dse.cli.terminal import print_line, show_page, show_problems, status_line

if TYPE_CHECKING:
    from dse.api import Results

ReportFile = Annotated[Path | None, typer.Option("--output", "-o", metavar="FILE", help="Default: DIR/report.html.")]
PdfFile = Annotated[
    Path | None,
    typer.Option("--pdf", metavar="FILE", help="Print it to a PDF file instead, with a Chromium on this machine."),
]
ReplayedRuns = Annotated[
    list[int] | None,
    typer.Option(
        "--replay", metavar="RUN", min=0, help="Write a replay of this run, replays/run_RUN.html beside the page."
    ),
]
ManyReplays = Annotated[
    str | None,
    typer.Option(
        "--replays",
        metavar="all|failed|N",
        help="Write replays of all runs, of those that fail a requirement, or of N runs.",
    ),
]
Opened = Annotated[bool, typer.Option("--open", help="Open what was written in the browser.")]
MostWaveforms = Annotated[
    int, typer.Option("--waveforms", min=0, help="Maximum number of runs whose waveforms are in the page.")
]

Live = Annotated[
    bool,
    typer.Option("--live", help="Let the page simulate: its configurations are compiled into it, with ziglang."),
]


@app.command()
def report(
    folder: Folder,
    target: ReportFile = None,
    pdf: PdfFile = None,
    waveforms: MostWaveforms = 4000,
    replay: ReplayedRuns = None,
    replays: ManyReplays = None,
    is_live: Live = False,
    is_opened: Opened = False,
) -> None:
    """Write the HTML report of a study, print it (--pdf), or write 3D replays of runs (--replay).

    One page that works offline: constraint plot, thresholds, waveforms, run table. It links to the replays beside it.
    A --live page also simulates: a slider for every parameter, and waveforms, verdicts and the plot follow. A --live
    replay can be driven on from any moment.

    Reads only the study folder; only the runs of --replay and --replays are simulated again, and --live reads the
    workspace.
    """
    from dse.api import Results
    from dse.errors import DseError, Problem, raise_if_any

    results = Results(folder)
    if pdf and (replay or replays or is_live or is_opened):
        raise typer.BadParameter(
            "what is printed has no replays, does not simulate, and is not opened", param_hint="--pdf"
        )
    problems: list[Problem] = []
    refused: list[Problem] = []
    made: list[Path] = []
    seen: list[Path] = []
    with status_line() as tell:
        for run in dict.fromkeys([*(replay or ()), *_chosen(results, replays)]):
            try:
                seen.append(
                    results.replay_page(run, (target or folder / "report.html").parent, live=is_live, tell=tell)
                )
            except DseError as error:  # the others can be driven all the same
                refused += error.problems
        if target or not pdf:
            tell(f"reading {len(results)} runs, drawing the page")
            made.append(
                results.report(target, waveforms=waveforms, live=is_live, on_problems=problems.extend, tell=tell)
            )
        if pdf:
            tell(f"reading {len(results)} runs, printing the page")
            made.append(results.print(pdf, waveforms=waveforms, on_problems=problems.extend))
    for page in seen:
        print_line(f"{page}: a replay, {page.stat().st_size / 1e6:.1f} MB")
    for page in made:
        print_line(f"{page}: {len(results)} runs, {page.stat().st_size / 1e6:.1f} MB")
    if problems:
        show_problems(DseError(*problems))
    if is_opened:
        show_page((seen[0] if len(seen) == 1 else made[0]).absolute().as_uri())
    raise_if_any(refused)


def _chosen(results: Results, which: str | None) -> tuple[int, ...]:
    if which is None:
        return ()
    if which not in ("all", "failed") and not (which.isascii() and which.isdecimal() and 0 < len(which) < 10):
        raise typer.BadParameter(f"'{which}' is neither 'all' nor 'failed' nor a number", param_hint="--replays")
    return results.runs_to_replay(int(which) if which.isdecimal() else which)
