"""``dse replay``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from dse.cli.app import DONE, RUNS_FAILED, app, console, print_json
from dse.cli.arguments import FmiVersion, Folder, Format, Output, Plot
from dse.errors import Location, fail

if TYPE_CHECKING:
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

    Reads the workspace, simulates the run again and checks that it gives the same numbers.

    Shows its metrics; with --plot draws its waveforms even if the study did not keep them.
    """
    from dse.cli.exploring import run_alone
    from dse.cli.showing import draw_run, show_run
    from dse.cli.tables import run_data
    from dse.results.folder import StudyFolder

    with StudyFolder.open(folder) as store:
        stored = store.run(number)
        header = store.header
    study = _study(header.definition, source)
    run, definition = run_alone(_single(study, stored), version=version)
    if output is Output.JSON:
        print_json(run_data(run))
    else:
        show_run(run, definition)
    if plot is not None:
        draw_run(run, definition, plot)
    changed = _differences(stored, run)
    if changed:
        message = f"run {number} did not give the same again: {', '.join(changed)}"
        raise fail(message, Location(str(folder)), "the components, the bench or dse have changed since; explore again")
    console(stderr=True).print(f"run {number}: the same as in {folder}, bit for bit", soft_wrap=True)
    raise typer.Exit(RUNS_FAILED if run.problem else DONE)


def _study(definition: Any, source: Path | None) -> Study:
    """The study the folder came from, found by its name in the workspace around the current folder, or in *source*."""
    from dse.cli.arguments import workspace_of
    from dse.testbench.plan import bench_study

    is_bench = not definition["variables"]
    name = str(source) if source else definition["bench" if is_bench else "study"]
    if is_bench:
        name = str(source) if source else definition["bench"]["name"]
    workspace = workspace_of(name)
    return bench_study(workspace.bench(name)) if is_bench else workspace.study(name)


def _single(study: Study, stored: Run) -> Study:
    from dse.domain.study import Selection
    from dse.testbench.plan import bench_study, with_values

    selection = Selection((stored.request.configuration,))
    return bench_study(with_values(study.bench, stored.request.point), selection)


def _differences(stored: Run, again: Run) -> list[str]:
    if stored.outcome != again.outcome:
        return [f"{stored.outcome} became {again.outcome}"]
    names = sorted(stored.metrics.keys() | again.metrics.keys())
    return [name for name in names if not _same(stored.metrics.get(name), again.metrics.get(name))]


def _same(a: float | None, b: float | None) -> bool:
    return a == b or (a is not None and b is not None and a != a and b != b)  # noqa: PLR0124  # NaN is undefined in both
