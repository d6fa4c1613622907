"""``dse compare-components``."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import FmiVersion, Format, Output
from dse.cli.completion import components
from dse.cli.endings import DONE, RUNS_FAILED
from dse.cli.terminal import plain, plain_table, print_json, print_line, print_table

if TYPE_CHECKING:
    from dse.api import Column, Pair

Name = Annotated[str, typer.Argument(metavar="COMPONENT", autocompletion=components, show_default=False)]
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"


@app.command()
def compare_components(
    first: Name,
    second: Name,
    inputs: Annotated[
        list[str],
        typer.Option(
            "--input",
            metavar="NAME=…",
            help="Values of an input: NAME=LOW:HIGH, a number (both SI), or FILE, with its column if it is not NAME: "
            "NAME=FILE:COLUMN.",
        ),
    ] = [],
    steps: Annotated[int, typer.Option("--steps", min=1, help="Number of steps.")] = 1000,
    step: Annotated[
        float | None, typer.Option("--step", min=1e-9, help="Length of a step in s; default: from both sample times.")
    ] = None,
    tolerance: Annotated[
        float,
        typer.Option("--tolerance", min=0.0, help="Allowed difference of outputs, relative to their largest value."),
    ] = 1e-12,
    version: FmiVersion = 2,
    workspace: Annotated[Path, typer.Option("--workspace", "-w", help="A folder or file in the workspace.")] = Path(),
    form: Format = Output.TABLE,
) -> None:
    """Run two components on the same inputs, and show how much their outputs differ.

    Both implement one interface: generated code and the FMU of its model, or a controller before and after a change.
    Inputs move in steps, then as sines, by default between -10 and 10; enumeration items and Boolean values change now
    and then.

    Exit code 3 if an output differs by more than the tolerance.
    """
    from dse.api import compare_components as compare, pair_as_data

    given = dict(_input(text) for text in inputs)
    found = compare(
        first, second, inputs=given, steps=steps, step=step, tolerance=tolerance, fmi=version, near=workspace
    )
    if form is Output.JSON:
        print_json(pair_as_data(found))
    else:
        _show(found)
    raise typer.Exit(DONE if found.is_within else RUNS_FAILED)


def _input(text: str) -> tuple[str, float | tuple[float, float] | Column]:
    from dse.api import Column

    name, equals, value = text.partition("=")
    if not (name and equals and value):
        raise typer.BadParameter(f"'{text}' is not NAME=LOW:HIGH, NAME=NUMBER or NAME=FILE", param_hint="--input")
    if numbers := re.fullmatch(rf"({_NUMBER})(?::({_NUMBER}))?", value):
        low = float(numbers[1])
        return name, (low, float(numbers[2])) if numbers[2] else low
    file, colon, column = ("", "", name) if Path(value).is_file() else value.rpartition(":")
    return name, Column(Path(file if colon else value), int(column) if column.isdecimal() else column)


def _show(pair: Pair) -> None:
    first, second = pair.names
    table = plain_table("output", "apart by", "relative", "at", first, second, right=("apart by", "relative", "at"))
    for each in pair.outputs:
        unit = f" {each.unit}" if each.unit else ""
        relative = "" if each.absolute == 0 else f"{each.relative:.2g}"
        where = "" if each.absolute == 0 else f"{each.time:g} s"
        values = ("", "") if each.absolute == 0 else tuple(f"{value:.15g}" for value in each.values)
        table.add_row(plain(each.output), f"{each.absolute:.3g}{unit}", relative, where, *values)
    print_table(table)
    for name, (one, other) in pair.parameters.items():
        print_line(f"parameter {name}: {_start(one)} in {first}, {_start(other)} in {second}")
    still = [each.output for each in pair.outputs if not each.moves]
    if still:
        print_line(f"never moved, so little is shown of it: {', '.join(still)}")
    verdict = "equal" if pair.is_within else "not equal"
    print_line(f"{verdict} to {pair.tolerance:g} in {pair.steps:,} steps of {pair.step:g} s")


def _start(value: object) -> str:
    return "missing" if value is None else f"{value}"
