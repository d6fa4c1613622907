"""``dse results``."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import Annotated

import typer

from dse.cli.app import app
from dse.cli.arguments import SI, Folder, units_word
from dse.cli.terminal import status_line


class Table(StrEnum):
    """Formats of a results table."""

    CSV = "csv"
    JSON = "json"
    PARQUET = "parquet"
    JUNIT = "junit"
    REQUIREMENTS = "requirements"
    REQIF = "reqif"


TableFile = Annotated[
    Path | None, typer.Option("--output", "-o", metavar="FILE", help="Write here, not to standard output.")
]


@app.command()
def results(
    folder: Folder,
    output: Annotated[
        Table,
        typer.Option("--format", help="Table format; junit is for CI servers, requirements and reqif for reviews."),
    ] = Table.CSV,
    target: TableFile = None,
    si: SI = False,
) -> None:
    """Print a study's runs as a table.

    The choices and sums of each run's configuration, its point, metrics, verdicts and margins, in the units of the
    report; in CSV, the headings contain the units.
    """
    from dse.api import Results
    from dse.scratch import make_folder, write_whole

    with status_line() as tell:
        tell("reading the runs")
        data = Results(folder).export(str(output), units_word(si))
    if target is not None:
        make_folder(target.parent)
        write_whole(target, data)
    elif output is Table.PARQUET and sys.stdout.isatty():
        raise typer.BadParameter("parquet is not text: name a file with -o", param_hint="--format")
    else:
        sys.stdout.buffer.write(data)
