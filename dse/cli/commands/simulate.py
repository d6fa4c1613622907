"""``dse simulate``."""

from __future__ import annotations

import typer

from dse.cli.app import DONE, RUNS_FAILED, app
from dse.cli.arguments import Bench, Configuration, FmiVersion, Format, Gate, Output, Plot, Settings, workspace_of


@app.command()
def simulate(
    bench: Bench,
    configuration: Configuration = None,
    settings: Settings = [],
    plot: Plot = None,
    output: Format = Output.TABLE,
    version: FmiVersion = 2,
    gate: Gate = False,
) -> None:
    """Simulate one configuration once.

    Shows its metrics, and the verdicts with their margins.

    Takes the first valid configuration unless --configuration names another.
    """
    from dse.cli.exploring import run_alone
    from dse.cli.showing import present_run
    from dse.domain.study import Selection
    from dse.testbench.plan import bench_study, with_settings
    from dse.testbench.select import one

    loaded = workspace_of(bench).bench(bench)
    chosen = one(loaded.design, configuration)
    changed = with_settings(loaded, read_settings(settings), chosen)
    run, definition = run_alone(bench_study(changed, Selection((chosen.id,))), version=version)
    present_run(run, definition, output, plot)
    failed = run.problem or (gate and any(str(j.verdict) == "fail" for j in run.judgements))
    raise typer.Exit(RUNS_FAILED if failed else DONE)


def read_settings(settings: list[str]) -> dict[str, str]:
    """``NAME=VALUE`` as a mapping; a usage error for anything else."""
    values: dict[str, str] = {}
    for entry in settings:
        name, equals, value = entry.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise typer.BadParameter(f"'{entry}' is not NAME=VALUE, as 'controller.kp_speed=1.2'", param_hint="--set")
        values[name.strip()] = value.strip()
    return values
