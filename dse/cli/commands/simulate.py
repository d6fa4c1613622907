"""``dse simulate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import DONE, RUNS_FAILED, app, console, print_json
from dse.cli.arguments import Bench, Configuration, FmiVersion, Format, Gate, Output, Settings

if TYPE_CHECKING:
    from dse.domain.bench import TestBench
    from dse.domain.component import Value
    from dse.domain.run import Run


@app.command()
def simulate(
    bench: Bench,
    configuration: Configuration = None,
    settings: Settings = [],  # noqa: B006  # typer reads the default and never changes it
    plot: Annotated[Path | None, typer.Option("--plot", metavar="FILE", help="Draw the bench's figures (png, svg, pdf).")] = None,
    output: Format = Output.TABLE,
    version: FmiVersion = 2,
    gate: Gate = False,
) -> None:
    """Simulate one configuration once and show its metrics and verdicts.

    Takes the first valid configuration unless --configuration names another.
    """
    from dse.domain.study import FullFactorial, Study
    from dse.loading.workspace import Workspace
    from dse.testbench.definition import define
    from dse.testbench.prepare import prepare
    from dse.testbench.select import one

    space = Workspace.around(Path(bench) if Path(bench).exists() else Path())
    loaded = space.bench(bench)
    point = read_settings(settings, loaded)
    chosen = one(loaded.design, configuration)
    prepared = prepare(loaded, [chosen], version=version)
    definition = define(Study(loaded.name, loaded, (), FullFactorial()), prepared)
    check_settings(point, prepared[chosen.id].settings, chosen.id)
    run = run_once(prepared[chosen.id], chosen.id, point)
    if output is Output.JSON:
        print_json(run_data_of(run))
    else:
        show(run, definition, chosen.choices)
    if plot is not None and run.waveforms is not None:
        draw(run, definition, plot)
    raise typer.Exit(exit_code([run], gate=gate))
