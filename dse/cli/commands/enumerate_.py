"""``dse enumerate``."""

from __future__ import annotations

import sys
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from dse.api import opened
from dse.cli.app import app
from dse.cli.arguments import Design, Off, On, Seed, Where
from dse.cli.terminal import console, plain_table, print_json, print_line, print_table

if TYPE_CHECKING:
    from dse.space import OpenedSpace, Rows, Sheet, Tally


class ListingFormat(StrEnum):
    """How configurations are listed."""

    TABLE = "table"
    CSV = "csv"
    JSON = "json"
    JSON_LINES = "jsonl"
    PARQUET = "parquet"


SHOWN = 100
"""Rows of a table where no limit is given; files and streams are complete."""


@app.command("enumerate")
def enumerate_(
    design: Design,
    count: Annotated[bool, typer.Option("--count", help="Show only their number.")] = False,
    exact: Annotated[bool, typer.Option("--exact", help="With --count: no estimate, however long it takes.")] = False,
    output: Annotated[
        ListingFormat, typer.Option("--format", help="For a person, a spreadsheet or a program.")
    ] = ListingFormat.TABLE,
    target: Annotated[
        Path | None,
        typer.Option("--output", "-o", metavar="FILE", help="Write a .csv, .json, .jsonl or .parquet file."),
    ] = None,
    limit: Annotated[int | None, typer.Option("--limit", "-n", min=1, help="List only the first N.")] = None,
    sample: Annotated[int | None, typer.Option("--sample", min=1, help="Draw N at random, all equally likely.")] = None,
    seed: Seed = 0,
    where: Where = None,
    on: On = [],
    off: Off = [],
    interactive: Annotated[bool, typer.Option("--interactive", "-i", help="Choose step by step, with counts.")] = False,
) -> None:
    """List, count or draw the valid configurations.

    A configuration is valid if it meets every static constraint of the design space.

    A table shows the first 100, or --limit; CSV, JSON and files contain all.
    """
    if exact and not count:
        raise typer.BadParameter("goes with --count", param_hint="--exact")
    if sample is not None and limit is not None:
        raise typer.BadParameter("one of --sample and --limit", param_hint="--sample")
    if count and interactive:
        raise typer.BadParameter("one of --count and --interactive", param_hint="--count")
    listing = {"--output": target, "--sample": sample, "--limit": limit}
    for option, given in listing.items():
        if count and given is not None:
            raise typer.BadParameter("lists configurations; --count only counts them", param_hint=option)
    if target is not None and output is not ListingFormat.TABLE and target.suffix.lower() != f".{output.value}":
        raise typer.BadParameter(f"'{target.name}' is not the name of a .{output.value} file", param_hint="--format")
    part = opened(design, (), where, on, off)
    if interactive:
        from dse.cli.interactive.interactive import choose

        choose(part, target)
    elif count:
        _count(part, part.count(seed, exact=exact), output)
    elif target is None and output is ListingFormat.TABLE and sample is None:
        _first(part, limit or SHOWN, limit is None)
    else:
        blocks = part.blocks(limit) if sample is None else iter([part.draw(sample, seed)])
        if target is not None:
            written = part.save(blocks, target)
            print_line(f"{target}: {written:,} configuration{'' if written == 1 else 's'}")
        elif output is not ListingFormat.TABLE:
            if output is ListingFormat.PARQUET and sys.stdout.isatty():
                raise typer.BadParameter("parquet is not text: name a file with -o", param_hint="--format")
            part.write(output.value, blocks, sys.stdout.buffer)
        else:
            _table(part.sheet(), next(blocks))
            nearly = "" if part.draws_uniformly else "nearly "
            console().print(f"{sample} drawn, each valid configuration {nearly}as likely as any other")


def _count(part: OpenedSpace, tally: Tally, output: ListingFormat) -> None:
    from dse.cli.spaces import tally_data, tally_text

    numbers = {"design": part.space.name, "total": part.total, **tally_data(tally)}
    if part.where:
        numbers["where"] = part.where.text
    if output in (ListingFormat.JSON, ListingFormat.JSON_LINES):
        print_json(numbers)
    elif output is ListingFormat.CSV:
        import csv

        csv.writer(sys.stdout, lineterminator="\n").writerows(
            # As in JSON: true, and nothing for null.
            [numbers.keys(), [str(value).lower() if isinstance(value, bool) else value for value in numbers.values()]]
        )
    elif output is ListingFormat.PARQUET:
        raise typer.BadParameter("a count is one number: table, csv or json", param_hint="--format")
    else:
        print_line(f"{part.space.name}: {_are_valid(part, tally_text(tally))}")


def _are_valid(part: OpenedSpace, valid: str) -> str:
    """``2 of 135 configurations are valid``; under a condition that says too little."""
    from dse.cli.spaces import number_text

    verb, also = ("is", "meets") if valid == "1" else ("are", "meet")
    if part.where:
        return f"{valid} of {number_text(part.total)} combinations {verb} valid and {also} the condition"
    return f"{valid} of {number_text(part.total)} configuration{'' if part.total == 1 else 's'} {verb} valid"


def _first(part: OpenedSpace, most: int, cut: bool) -> None:
    from dse.cli.spaces import number_text

    rows = part.rows(most + 1)
    _table(part.sheet(), rows[:most])
    if len(rows) <= most:
        print_line(_are_valid(part, f"{len(rows):,}"))
        return
    before = "the static constraints and the condition" if part.where else "the static constraints"
    print_line(f"the first {most}; {number_text(part.total)} in total before {before}")
    if cut:
        print_line("more: --limit N shows N, -o FILE writes all, --count counts them")


def _table(sheet: Sheet, rows: Rows) -> None:
    import math

    table = plain_table("id", *(place.path for place in sheet.places))
    for total in sheet.totals:
        table.add_column(total.name, justify="right")
    columns = [sheet.ids(rows)]
    columns += [[name or "–" for name in place.chosen(rows)] for place in sheet.places]
    for total in sheet.totals:
        unit = str(total.unit)
        columns.append(["–" if math.isnan(v) else f"{v:g} {unit}".rstrip() for v in total.values(rows).tolist()])
    for cells in zip(*columns, strict=True):
        table.add_row(*cells)
    print_table(table)
