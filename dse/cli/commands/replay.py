"""``dse replay``."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import DONE, RUNS_FAILED, app, console
from dse.cli.arguments import FmiVersion, Folder, Format, Output, Plot
from dse.errors import Location, fail

if TYPE_CHECKING:
    from dse.domain.definition import StudyDefinition
    from dse.domain.run import Run
    from dse.domain.study import Study


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
) -> None:
    """Simulate a run of a study again and compare.

    Reads the workspace, simulates the run again and checks that it gives the same metrics, verdicts and waveforms.

    Shows its metrics; with --plot draws its waveforms even if the study did not keep them.
    """
    from dse.cli.exploring import run_alone
    from dse.cli.showing import present_run
    from dse.results.difference import changes, differences
    from dse.results.folder import StudyFolder

    with StudyFolder.open(folder) as store:
        studied = store.require_definition()
        stored = store.run(number)
    alone, definition = run_alone(_single(_study(studied, source), stored), version=version)
    # Alone it has number 0 and its point is the bench's own.
    run = replace(alone, request=stored.request)
    present_run(run, definition, output, plot)
    here = Location(str(folder))
    changed, different = changes(studied, definition, stored), differences(stored, run)
    if different:
        causes = f"changed since: {', '.join(changed)}" if changed else "dse or this machine have changed since"
        raise fail(
            f"run {number} did not give the same again: {', '.join(different)}", here, f"{causes}; explore again"
        )
    if changed:
        raise fail(
            f"run {number} gave the same, but not from the same: {', '.join(changed)} changed since",
            here,
            "explore again, or replay with the --fmi the study was explored with",
        )
    what = "metrics, verdicts and waveforms" if stored.waveforms else "metrics and verdicts; no waveforms were kept"
    console(stderr=True).print(f"run {number}: the same as in {folder}, bit for bit ({what})", soft_wrap=True)
    raise typer.Exit(RUNS_FAILED if run.problem else DONE)


def _study(definition: StudyDefinition, source: Path | None) -> Study:
    """The study the folder came from, found by its name in the workspace around the current folder, or in *source*."""
    from dse.cli.arguments import workspace_of
    from dse.testbench.plan import bench_study

    is_bench = not definition.variables
    name = str(source) if source else definition.bench.name if is_bench else definition.study
    workspace = workspace_of(name)
    return bench_study(workspace.bench(name)) if is_bench else workspace.study(name)


def _single(study: Study, stored: Run) -> Study:
    from dse.domain.study import Selection
    from dse.testbench.plan import bench_study, with_values

    selection = Selection((stored.request.configuration,))
    return bench_study(with_values(study.bench, stored.request.point), selection)
