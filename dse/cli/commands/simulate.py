"""``dse simulate``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from dse.api import workspace_of
from dse.cli.app import app
from dse.cli.arguments import (
    SI,
    CheckStep,
    Configuration,
    FmiVersion,
    Format,
    Fuse,
    Gate,
    Output,
    Parts,
    Plot,
    Sandbox,
    Settings,
    Strict,
    World,
    units_word,
    world_of_bench,
)
from dse.cli.completion import benches
from dse.cli.packages import Wishes, is_package, seconds, simulate_package, waveform_file
from dse.cli.prepared import keep_prepared
from dse.cli.scenarios import is_scenario, simulate_scenario
from dse.cli.terminal import status_line

Subject = Annotated[
    str,
    typer.Argument(
        metavar="BENCH",
        autocompletion=benches,
        help="A test bench: its name, or its YAML file; an SSP package (.ssp), an FMU, or an "
        "OpenSCENARIO file (.xosc).",
    ),
]
Waveforms = Annotated[
    Path | None,
    typer.Option(
        "--output", "-o", metavar="FILE", callback=waveform_file, help="Write the waveforms (.csv, .json or .parquet)."
    ),
]
Variant = Annotated[
    str | None, typer.Option("--variant", metavar="NAME", help="The .ssd file of a package to simulate.")
]
Stop = Annotated[
    str | None, typer.Option("--stop", metavar="TIME", help="How long to simulate a package or a scenario.")
]
Step = Annotated[
    str | None, typer.Option("--step", metavar="TIME", help="The communication step for a package or a scenario.")
]
Timeout = Annotated[
    str | None, typer.Option("--timeout", metavar="TIME", help="How long a package's run may take.  [default: 600 s]")
]
Record = Annotated[
    list[str],
    typer.Option("--record", metavar="NAME", help="Variables of a package to record, instead of its outputs."),
]
Tolerance = Annotated[
    float | None, typer.Option("--tolerance", metavar="NUMBER", help="Tolerance for the FMUs of a package.")
]
Word = Annotated[str | None, typer.Option(metavar="WORD", help="For a package, as under 'simulation' in a bench.")]


@app.command()
def simulate(
    bench: Subject,
    configuration: Configuration = None,
    settings: Settings = [],
    plot: Plot = None,
    output: Format = Output.TABLE,
    version: FmiVersion = 2,
    fuse: Fuse = False,
    gate: Gate = False,
    check_step: CheckStep = False,
    waveforms: Waveforms = None,
    variant: Variant = None,
    stop: Stop = None,
    step: Step = None,
    record: Record = [],
    algorithm: Word = None,
    coupling: Word = None,
    extrapolation: Word = None,
    tolerance: Tolerance = None,
    timeout: Timeout = None,
    sandbox: Sandbox = False,
    strict: Strict = False,
    world: World = None,
    parts: Parts = None,
    si: SI = False,
) -> None:
    """Simulate one configuration once, an SSP package, an FMU, or an OpenSCENARIO file.

    Shows a configuration's metrics, and the verdicts with their margins.

    Takes the first valid configuration unless --configuration names another.

    --output writes the waveforms. For a package or an FMU, shows the first and the last value of each output. In a
    scenario file, the scenario drives every entity; shows where they were, and when events began.
    """
    wishes = Wishes(
        variant,
        stop,
        step,
        read_settings(settings),
        tuple(record),
        algorithm,
        coupling,
        extrapolation,
        tolerance,
        timeout,
    )
    if is_scenario(bench):
        meant = {"--configuration": configuration, "--plot": plot, "--fuse": fuse, "--gate": gate, "--world": world}
        meant |= {"--check-step": check_step, "--fmi": version != 2, "--variant": variant, "--record": bool(record)}
        _refuse(meant, "bench or a package")
        times = seconds("--stop", stop), seconds("--step", step)
        simulate_scenario(
            Path(bench),
            wishes.settings,
            waveforms,
            output,
            stop=times[0],
            step=times[1],
            sandbox=sandbox,
            strict=strict,
        )
    if is_package(bench):
        meant = {"--configuration": configuration, "--plot": plot, "--fuse": fuse, "--gate": gate}
        _refuse({**meant, "--check-step": check_step, "--world": world, "--fmi": version != 2}, "bench")  # the default
        simulate_package(Path(bench), wishes, waveforms, output, sandbox=sandbox, strict=strict)
    asked = {"--variant": variant, "--stop": stop, "--step": step, "--record": record}
    words = {"--algorithm": algorithm, "--coupling": coupling, "--extrapolation": extrapolation, "--timeout": timeout}
    _refuse({**asked, **words, "--tolerance": tolerance is not None, "--strict": strict}, "package")
    there = world_of_bench(world, parts)
    from dse.api import prepare_once
    from dse.cli.runs import exit_code, present_run, write_run
    from dse.processes import mark_command

    mark_command()

    tested = workspace_of(bench).bench(bench)
    with status_line() as say:
        prepared = prepare_once(
            tested,
            configuration,
            wishes.settings,
            check_step=check_step,
            fuse=fuse,
            sandbox=sandbox,
            fmi=version,
            tell=say,
            world=there,
        )
        say("simulating")
        run = prepared.simulate(sandbox=sandbox)
    present_run(run, output, plot, units_word(si))
    if waveforms is not None:
        write_run(run, waveforms)
    elif plot is None and there is None and not sandbox:
        keep_prepared(prepared, output, units_word(si), gate=gate)
    raise typer.Exit(exit_code(run, gate=gate))


def _refuse(options: Mapping[str, object], meant: str) -> None:
    for option, value in options.items():
        if value:
            raise typer.BadParameter(f"this is for a {meant}", param_hint=option)


def read_settings(settings: list[str]) -> dict[str, str]:
    """``NAME=VALUE`` as a mapping; a usage error for anything else."""
    values: dict[str, str] = {}
    for entry in settings:
        name, equals, value = entry.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise typer.BadParameter(f"'{entry}' is not NAME=VALUE, as 'controller.kp_speed=1.2'", param_hint="--set")
        values[name.strip()] = value.strip()
    return values
